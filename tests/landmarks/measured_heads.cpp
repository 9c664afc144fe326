#include "tests/landmarks/measured_heads.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <random>

#include "builder/landmarks/samples.h"
#include "builder/spatial/surface_query.h"
#include "formats/landmark_file.h"
#include "tests/landmarks/retriangulated.h"
#include "tests/paths/paths.h"

namespace fascia::testing {

namespace fs = std::filesystem;

namespace {

/// Multi-PIE numbers of the landmarks that shape defines.
const std::map<std::string, int>& multi_pie_numbers() {
  static const std::map<std::string, int> numbers = {
      {"gnathion", 8},           {"pronasale", 30},          {"subnasale", 33},
      {"exocanthion_right", 36}, {"endocanthion_right", 39}, {"endocanthion_left", 42},
      {"exocanthion_left", 45},  {"cheilion_right", 48},     {"labiale_superius", 51},
      {"cheilion_left", 54},     {"labiale_inferius", 57},   {"stomion", 62}};
  return numbers;
}

size_t head_mesh(const formats::Scene& scene) {
  for (size_t m = 0; m < scene.meshes.size(); ++m)
    if (scene.meshes[m].name == "head") return m;
  return 0;
}

template <class Change>
MeasuredHead changed(MeasuredHead head, const std::string& how, Change change) {
  for (formats::SceneMesh& mesh : head.scene.meshes)
    for (Vec3& p : mesh.positions)
      p = change(p);
  for (auto& [name, p] : head.truth)
    p = change(p);
  head.name += " " + how;
  return head;
}

}  // namespace

fs::path measured_data() {
  const fs::path data = test::measured_data() / "data";
  return fs::exists(data / "ict/landmarks68.json") ? data : fs::path();
}

std::map<std::string, int> ict_landmark_vertices() {
  static const std::map<std::string, int> vertices = [] {
    std::ifstream file(measured_data() / "ict/landmarks68.json");
    const auto positions = nlohmann::json::parse(file).at("positions_m");
    const formats::Scene scene = formats::read(measured_data() / "ict/neutral.glb");
    const std::vector<Vec3>& all = scene.meshes[head_mesh(scene)].positions;
    std::map<std::string, int> found;
    for (const auto& [name, number] : multi_pie_numbers()) {
      const auto& p = positions.at(static_cast<size_t>(number));
      const Vec3 at(p[0], p[1], p[2]);
      const auto nearest = std::min_element(all.begin(), all.end(), [&](const Vec3& a, const Vec3& b) {
        return (a - at).norm() < (b - at).norm();
      });
      found[name] = static_cast<int>(nearest - all.begin());
    }
    return found;
  }();
  return vertices;
}

std::map<std::string, int> ict_model_vertices() {
  std::ifstream file(measured_data() / "ict/landmarks68.json");
  const auto all = nlohmann::json::parse(file).at("multi_pie_68_vertex_indices");
  std::map<std::string, int> found;
  for (const auto& [name, number] : multi_pie_numbers())
    found[name] = all.at(static_cast<size_t>(number)).get<int>();
  return found;
}

Vec3 offset_of_definition(const std::string& landmark, const Vec3& generic) {
  static const formats::Scene scene = formats::read(measured_data() / "ict/neutral.glb");
  const auto vertex = static_cast<size_t>(ict_landmark_vertices().at(landmark));
  return scene.meshes[head_mesh(scene)].positions[vertex] - generic;
}

MeasuredHead ict_head(const std::string& name) {
  MeasuredHead head;
  head.name = name;
  head.scene = formats::read(measured_data() / "ict" / (name + ".glb"));
  for (const auto& [landmark, vertex] : ict_landmark_vertices())
    head.truth[landmark] = head.scene.meshes[head_mesh(head.scene)].positions[static_cast<size_t>(vertex)];
  return head;
}

MeasuredHead makehuman() {
  MeasuredHead head;
  head.name = "makehuman";
  head.millimetres = 100;
  head.scene = formats::read(measured_data() / "heads/makehuman_body.obj");
  const auto all = formats::read_landmarks(test::data() / "makehuman_landmarks.json").points;
  for (const auto& [name, number] : multi_pie_numbers())
    if (const auto at = all.find(name); at != all.end()) head.truth[name] = at->second;
  return head;
}

MeasuredHead moved(MeasuredHead head, const Mat3& rotation, const Vec3& shift) {
  return changed(std::move(head), "turned", [&](const Vec3& p) { return Vec3(rotation * p + shift); });
}

MeasuredHead in_units(MeasuredHead head, double units_per_metre) {
  head.millimetres /= units_per_metre;
  return changed(std::move(head),
                 "in " + std::to_string(static_cast<int>(units_per_metre)) + "ths of a metre",
                 [&](const Vec3& p) { return Vec3(units_per_metre * p); });
}

MeasuredHead noisy(MeasuredHead head, double millimetres, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal(0.0, millimetres / head.millimetres);
  for (formats::SceneMesh& mesh : head.scene.meshes) {
    // Vertices that are doubled along texture seams are one point of a scan.
    std::map<std::array<double, 3>, Vec3> once;
    for (Vec3& p : mesh.positions) {
      const auto [at, is_new] = once.try_emplace({p[0], p[1], p[2]}, Vec3::Zero());
      if (is_new) at->second = Vec3(normal(random), normal(random), normal(random));
      p += at->second;
    }
  }
  head.name += " noisy";
  return head;
}

MeasuredHead decimated(MeasuredHead head, int triangles) {
  size_t total = 0;
  for (const formats::SceneMesh& mesh : head.scene.meshes)
    total += mesh.triangles.size();
  const double ratio = static_cast<double>(triangles) / static_cast<double>(total);
  for (formats::SceneMesh& mesh : head.scene.meshes)
    if (mesh.triangles.size() > 12)
      simplify(mesh,
               std::max<size_t>(12, static_cast<size_t>(ratio * static_cast<double>(mesh.triangles.size()))));
  head.name += " decimated";
  return head;
}

MeasuredHead subdivided(MeasuredHead head, int rounds) {
  formats::SceneMesh& mesh = head.scene.meshes[head_mesh(head.scene)];
  for (int round = 0; round < rounds; ++round)
    subdivide(mesh);
  mesh.uvs.clear();
  head.name += " subdivided";
  return head;
}

MeasuredHead skin_only(MeasuredHead head) {
  const size_t at = head_mesh(head.scene);
  head.scene.meshes = {head.scene.meshes[at]};
  head.name += " skin only";
  return head;
}

MeasuredHead without_lining(MeasuredHead head) {
  // On the mean head, with eyes and teeth in place, the lining is what no ray out of 26 leaves.
  static const std::vector<bool> is_lining = [] {
    const formats::Scene scene = formats::read(measured_data() / "ict/neutral.glb");
    TriangleMesh all;
    std::vector<size_t> first;
    for (const auto& mesh : scene.meshes) {
      const int base = all.vertex_count();
      first.push_back(all.triangles.size());
      all.vertices.insert(all.vertices.end(), mesh.positions.begin(), mesh.positions.end());
      for (const Triangle& t : mesh.triangles)
        all.triangles.push_back({t[0] + base, t[1] + base, t[2] + base});
    }
    const spatial::SurfaceQuery surface(all);
    const formats::SceneMesh& skin = scene.meshes[head_mesh(scene)];
    std::vector<bool> lining(skin.triangles.size(), true);
    for (size_t t = 0; t < lining.size(); ++t) {
      const int index = static_cast<int>(first[head_mesh(scene)] + t);
      const Vec3 centre = position(all, {index, Vec3::Constant(1.0 / 3.0)}),
                 normal = triangle_normal(all, index);
      for (int d = 0; d < 27 && lining[t]; ++d) {
        const Vec3 direction(d % 3 - 1, d / 3 % 3 - 1, d / 9 - 1);
        if (direction.norm() > 0 && direction.normalized().dot(normal) > 0.2 &&
            !surface.blocked(centre + 2e-5 * normal, direction))
          lining[t] = false;
      }
    }
    return lining;
  }();
  head = skin_only(std::move(head));
  std::vector<Triangle> kept;
  for (size_t t = 0; t < is_lining.size(); ++t)
    if (!is_lining[t]) kept.push_back(head.scene.meshes[0].triangles[t]);
  head.scene.meshes[0].triangles = std::move(kept);
  head.name += " without lining";
  return head;
}

namespace {

/// Middle of eyes and mouth, and the directions of a face as its landmarks tell them.
struct FaceAxes {
  Vec3 middle, left, up, forward;
};

FaceAxes face_axes(const MeasuredHead& head) {
  const auto at = [&](const char* name) { return head.truth.at(name); };
  const Vec3 eyes = 0.5 * (at("exocanthion_left") + at("exocanthion_right")),
             mouth = 0.5 * (at("cheilion_left") + at("cheilion_right"));
  FaceAxes axes;
  axes.middle = 0.5 * (eyes + mouth);
  axes.left = (at("exocanthion_left") - at("exocanthion_right")).normalized();
  axes.forward = axes.left.cross(eyes - mouth).normalized();
  axes.up = axes.forward.cross(axes.left);
  return axes;
}

template <class Keeps>
MeasuredHead kept(MeasuredHead head, const std::string& how, Keeps keeps) {
  formats::SceneMesh& mesh = head.scene.meshes[0];
  std::erase_if(mesh.triangles,
                [&](const Triangle& t) { return !keeps(mesh.positions[static_cast<size_t>(t[0])]); });
  // Points that no triangle uses are not part of what was scanned.
  std::vector<int> place(mesh.positions.size(), -1);
  std::vector<Vec3> used;
  for (Triangle& t : mesh.triangles)
    for (int& v : t) {
      int& at = place[static_cast<size_t>(v)];
      if (at < 0) {
        at = static_cast<int>(used.size());
        used.push_back(mesh.positions[static_cast<size_t>(v)]);
      }
      v = at;
    }
  mesh.positions = std::move(used);
  mesh.uvs.clear();
  head.name += how;
  return head;
}

}  // namespace

MeasuredHead face_alone(MeasuredHead head, double radius_mm) {
  const FaceAxes axes = face_axes(head);
  const double unit = 1.0 / head.millimetres;
  const Vec3 centre = axes.middle - 25 * unit * axes.forward;
  return kept(without_lining(std::move(head)), " face alone", [&](const Vec3& p) {
    return (p - centre).norm() < radius_mm * unit && (p - centre).dot(axes.forward) > -25 * unit;
  });
}

MeasuredHead cut_above_brows(MeasuredHead head) {
  const FaceAxes axes = face_axes(head);
  const double unit = 1.0 / head.millimetres;
  return kept(without_lining(std::move(head)), " cut above the brows",
              [&](const Vec3& p) { return (p - axes.middle).dot(axes.up) < 62 * unit; });
}

MeasuredHead with_holes(MeasuredHead head, double radius_mm, int count, unsigned seed) {
  formats::SceneMesh& mesh = head.scene.meshes[head_mesh(head.scene)];
  std::mt19937 random(seed);
  for (int hole = 0; hole < count; ++hole) {
    const Vec3 centre = mesh.positions[random() % mesh.positions.size()];
    std::erase_if(mesh.triangles, [&](const Triangle& t) {
      return (mesh.positions[static_cast<size_t>(t[0])] - centre).norm() < radius_mm / head.millimetres;
    });
  }
  head.name += " with holes";
  return head;
}

}  // namespace fascia::testing
