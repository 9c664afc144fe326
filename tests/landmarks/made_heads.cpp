#include "tests/landmarks/made_heads.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>

#include "tests/landmarks/retriangulated.h"

namespace fascia::testing {

namespace {

double bump(const Vec3& p, const Vec3& centre, double width) {
  return std::exp(-(p - centre).squaredNorm() / (width * width));
}

const Vec3 nose(0, 0.005, 0.125), mouth(0, -0.033, 0.105);

Vec3 eye(double side) {
  return {side * 0.0315, 0.035, 0.075};
}

/// A tube about the y axis through rings of (radius x, height, radius z).
formats::SceneMesh tube(const std::string& name, const std::vector<Vec3>& rings) {
  formats::SceneMesh mesh;
  mesh.name = name;
  const int sectors = 48;
  for (const Vec3& ring : rings)
    for (int s = 0; s < sectors; ++s) {
      const double angle = 2 * EIGEN_PI * s / sectors;
      mesh.positions.push_back({ring[0] * std::sin(angle), ring[1], ring[2] * std::cos(angle)});
    }
  for (int r = 0; r + 1 < static_cast<int>(rings.size()); ++r)
    for (int s = 0; s < sectors; ++s) {
      const int a = r * sectors + s, b = r * sectors + (s + 1) % sectors;
      mesh.triangles.push_back({a, a + sectors, b});
      mesh.triangles.push_back({b, a + sectors, b + sectors});
    }
  return mesh;
}

/// What `keeps` says of each triangle's middle, the rest taken away.
template <class Keeps>
formats::SceneMesh clipped(formats::SceneMesh mesh, Keeps keeps) {
  std::erase_if(mesh.triangles, [&](const Triangle& t) {
    Vec3 middle = Vec3::Zero();
    for (int v : t)
      middle += mesh.positions[static_cast<size_t>(v)] / 3.0;
    return !keeps(middle);
  });
  return mesh;
}

}  // namespace

Vec3 as_child(const Vec3& p) {
  const double low = std::clamp((0.06 - p[1]) / 0.14, 0.0, 1.0);
  return 0.86 * Vec3(p[0] * (1 - 0.16 * low),
                     p[1] < 0.04 ? 0.04 + 0.84 * (p[1] - 0.04) : 0.04 + 1.02 * (p[1] - 0.04),
                     p[2] * (1 - 0.1 * low));
}

Vec3 with_large_eyes(const Vec3& p) {
  Vec3 to = p;
  for (double side : {-1.0, 1.0})
    to += 0.45 * bump(p, eye(side), 0.032) * (p - eye(side));
  return to;
}

Vec3 as_elder(const Vec3& p) {
  Vec3 to = p + 0.35 * bump(p, nose, 0.02) * (p - Vec3(0, 0.035, 0.1));
  const double low = std::clamp((0.03 - p[1]) / 0.1, 0.0, 1.0) * std::clamp(p[2] / 0.1, 0.0, 1.0);
  to[1] -= 0.006 * low;
  to[0] *= 1 + 0.05 * low;
  // Folds of a millimetre, a centimetre apart.
  to[2] += 0.0008 * std::sin(600 * p[1]) * std::clamp(p[2] / 0.08, 0.0, 1.0);
  return to;
}

Vec3 as_anime(const Vec3& p) {
  Vec3 to = p;
  for (double side : {-1.0, 1.0})
    to += 0.6 * bump(p, eye(side), 0.036) * (p - eye(side));
  to[2] -= 0.55 * bump(p, nose, 0.022) * std::max(0.0, p[2] - 0.1);
  const double low = std::clamp((0.02 - p[1]) / 0.1, 0.0, 1.0);
  to[0] *= 1 - 0.28 * low;
  to[1] = to[1] > 0.05 ? 0.05 + 1.12 * (to[1] - 0.05) : to[1];
  return to;
}

Vec3 as_toon(const Vec3& p) {
  Vec3 to = p + 0.5 * bump(p, nose, 0.022) * (p - Vec3(0, 0.01, 0.1));
  to[0] *= 1.12;
  to[1] = to[1] > 0.06 ? 0.06 + 0.85 * (to[1] - 0.06) : to[1];
  return to;
}

Vec3 as_creature(const Vec3& p) {
  Vec3 to = p;
  to[2] += 0.018 * bump(p, mouth, 0.045) + 0.007 * bump(p, Vec3(0, 0.055, 0.1), 0.035);
  const double low = std::clamp((0.02 - p[1]) / 0.1, 0.0, 1.0);
  to[0] *= 1 + 0.1 * low;
  return to;
}

MadeHead made_head(const anatomy::GenericAnatomy& anatomy, const std::string& name, const Bend& bend) {
  MadeHead head;
  head.name = name;
  head.scene.kind = formats::FileKind::obj;
  head.scene.path = name + ".obj";
  for (const anatomy::MeshObject& object : anatomy.head) {
    formats::SceneMesh mesh;
    mesh.name = "part_" + std::to_string(head.scene.meshes.size());  // no help from names
    for (const Vec3& p : object.mesh.vertices)
      mesh.positions.push_back(bend(p));
    mesh.triangles = object.mesh.triangles;
    const auto first = object.name == "skin" ? head.scene.meshes.begin() : head.scene.meshes.end();
    head.scene.meshes.insert(first, std::move(mesh));
  }
  for (const char* landmark :
       {"pronasale", "subnasale", "stomion", "cheilion_left", "cheilion_right", "exocanthion_left",
        "exocanthion_right", "endocanthion_left", "endocanthion_right", "labiale_superius", "menton",
        "glabella", "alare_left", "alare_right"})
    head.truth[landmark] = bend(*anatomy.landmark(landmark)->skin);
  return head;
}

MadeHead moved(MadeHead head, const Mat3& rotation, double scale, const Vec3& shift) {
  const auto place = [&](const Vec3& p) { return Vec3(scale * (rotation * p + shift)); };
  for (formats::SceneMesh& mesh : head.scene.meshes)
    for (Vec3& p : mesh.positions)
      p = place(p);
  for (auto& [name, p] : head.truth)
    p = place(p);
  head.millimetres /= scale;
  head.name += " moved";
  return head;
}

MadeHead mirrored(MadeHead head) {
  for (formats::SceneMesh& mesh : head.scene.meshes) {
    for (Vec3& p : mesh.positions)
      p[0] = -p[0];
    for (Triangle& t : mesh.triangles)
      std::swap(t[1], t[2]);
  }
  Landmarks truth;
  for (const auto& [name, p] : head.truth) {
    std::string other = name;
    if (const size_t at = name.rfind("_left"); at != std::string::npos)
      other.replace(at, 5, "_right");
    else if (const size_t right = name.rfind("_right"); right != std::string::npos)
      other.replace(right, 6, "_left");
    truth[other] = Vec3(-p[0], p[1], p[2]);
  }
  head.truth = std::move(truth);
  head.name += " mirrored";
  return head;
}

MadeHead reordered(MadeHead head, unsigned seed) {
  std::mt19937 random(seed);
  for (formats::SceneMesh& mesh : head.scene.meshes) {
    std::vector<int> place(mesh.positions.size());
    std::iota(place.begin(), place.end(), 0);
    std::shuffle(place.begin(), place.end(), random);
    std::vector<Vec3> positions(mesh.positions.size());
    for (size_t v = 0; v < place.size(); ++v)
      positions[static_cast<size_t>(place[v])] = mesh.positions[v];
    mesh.positions = std::move(positions);
    for (Triangle& t : mesh.triangles)
      t = {place[static_cast<size_t>(t[1])], place[static_cast<size_t>(t[2])],
           place[static_cast<size_t>(t[0])]};
    std::shuffle(mesh.triangles.begin(), mesh.triangles.end(), random);
  }
  head.name += " reordered";
  return head;
}

MadeHead subdivided(MadeHead head) {
  for (formats::SceneMesh& mesh : head.scene.meshes)
    subdivide(mesh);
  head.name += " subdivided";
  return head;
}

MadeHead coarse(MadeHead head, int triangles) {
  simplify(head.scene.meshes.front(), static_cast<size_t>(triangles));
  head.scene.meshes.resize(1);
  head.name += " in " + std::to_string(triangles) + " triangles";
  return head;
}

MadeHead mask(MadeHead head) {
  head.scene.meshes.resize(1);
  // Lining lies behind the face; sockets and mouth stay holes.
  head.scene.meshes.front() = clipped(head.scene.meshes.front(), [](const Vec3& p) {
    const bool is_before_ears = p[2] > 0.03 && p[1] > -0.085 && p[1] < 0.1;
    const bool is_inside = std::hypot(p[0] / 0.06, (p[2] - 0.0) / 0.085) < 1.0;
    return is_before_ears && !is_inside;
  });
  head.name += ", a mask";
  return head;
}

MadeHead dressed(MadeHead head, const std::array<std::string, 3>& names) {
  std::vector<Vec3> body, coat, hair;
  for (int r = 0; r <= 40; ++r) {
    const double y = -0.12 - 0.035 * r, wide = 0.06 + 0.15 * std::min(1.0, std::max(0, r - 1) / 4.0);
    body.push_back({wide, y, 0.6 * wide});
    if (r > 3) coat.push_back({wide + 0.02, y, 0.6 * wide + 0.02});
  }
  for (int r = 0; r <= 14; ++r) {
    const double angle = 0.06 + 1.75 * r / 14;  // from the crown down to the ears
    hair.push_back({0.095 * std::sin(angle), 0.045 + 0.115 * std::cos(angle), 0.115 * std::sin(angle)});
  }
  head.scene.meshes.push_back(tube(names[0], body));
  head.scene.meshes.push_back(tube(names[1], coat));
  formats::SceneMesh locks = tube(names[2], hair);
  for (Vec3& p : locks.positions)
    p[2] += 0.004;
  // Open before the face, down to just above the eyes.
  locks = clipped(locks, [](const Vec3& p) { return p[2] < 0.06 || p[1] > 0.06; });
  head.scene.meshes.push_back(std::move(locks));
  head.name += ", dressed";
  return head;
}

}  // namespace fascia::testing
