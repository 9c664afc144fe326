// Heads as people have them, made from the embedded one: each must come out as a rig that moves.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <array>
#include <cmath>
#include <cstdio>
#include <functional>
#include <map>
#include <sstream>
#include <utility>

#include "anatomy/anatomy.h"
#include "builder/rigging/embedded_head.h"
#include "builder/spatial/surface_query.h"
#include "formats/landmark_file.h"
#include "formats/scene.h"
#include "tests/builder/posed_face.h"

namespace fascia::testing {
namespace {

namespace fs = std::filesystem;

/// The embedded head's skin in metres, changed by `change` and written as OBJ in millimetres beside its
/// landmarks, which `place` carries along. Motions are compared in the rig's axes, which stand upright.
class Variant {
 public:
  using Change = std::function<void(TriangleMesh&)>;
  using Place = std::function<Vec3(const Vec3&)>;
  Variant(
      const std::string& name, const Change& change, const Place& place = [](const Vec3& p) { return p; }) {
    const fs::path folder = fs::temp_directory_path() / ("fascia_any_head_" + name);
    fs::create_directories(folder);
    rigging::write_embedded_head(folder / "head.obj", folder / "landmarks.json");
    const formats::Scene scene = formats::read(folder / "head.obj");
    TriangleMesh skin;
    for (const formats::SceneMesh& mesh : scene.meshes) {
      if (mesh.name.find("teeth") != std::string::npos) continue;
      const int base = skin.vertex_count();
      for (const Vec3& p : mesh.positions)
        skin.vertices.push_back(1e-3 * p);
      for (const Triangle& t : mesh.triangles)
        skin.triangles.push_back({t[0] + base, t[1] + base, t[2] + base});
    }
    for (Vec3& p : skin.vertices)
      p = place(p);
    change(skin);
    std::ostringstream obj, points;
    obj.precision(9);
    points.precision(9);
    for (const Vec3& p : skin.vertices)
      obj << "v " << 1e3 * p.x() << " " << 1e3 * p.y() << " " << 1e3 * p.z() << "\n";
    for (const Triangle& t : skin.triangles)
      obj << "f " << t[0] + 1 << " " << t[1] + 1 << " " << t[2] + 1 << "\n";
    formats::write_text(folder / "head.obj", obj.str());
    points << "{\"units\":\"mm\",\"landmarks\":{";
    bool first = true;
    const spatial::SurfaceQuery surface(skin);
    for (const anatomy::Landmark& landmark : anatomy::load_generic().landmarks) {
      // What a head has not got, as a mask its crown, is not given.
      if (!landmark.skin || surface.closest(place(*landmark.skin)).distance > 0.004) continue;
      const Vec3 p = 1e3 * place(*landmark.skin);
      points << (first ? "" : ",") << "\"" << landmark.name << "\":[" << p.x() << "," << p.y() << "," << p.z()
             << "]";
      first = false;
    }
    points << "}}";
    formats::write_text(folder / "landmarks.json", points.str());
    face_.emplace(folder / "head.obj", folder / "landmarks.json", "test_any_" + name, "low");
    fs::remove_all(folder);
  }
  PosedFace& face() { return *face_; }

 private:
  std::optional<PosedFace> face_;
};

void no_change(TriangleMesh&) {}

Vec3 landmark(const std::string& name) {
  for (const anatomy::Landmark& landmark : anatomy::load_generic().landmarks)
    if (landmark.name == name && landmark.skin) return *landmark.skin;
  ADD_FAILURE() << "no landmark " << name;
  return Vec3::Zero();
}

/// What any head with lips and lids does, however it was made.
void expect_opens_and_closes(PosedFace& face) {
  face.pose({});
  EXPECT_EQ(face.largest_motion(), 0.0);
  face.pose({{"jaw_open", 1.0}});
  EXPECT_LT(face.moved("labiale_inferius").y() - face.moved("labiale_superius").y(), -12.0);
  EXPECT_LT(face.moved("pogonion").y(), -10.0) << "the chin goes with the jaw";
  face.pose({{"lid_upper_left", 1.0}, {"lid_upper_right", 1.0}});
  for (const std::string side : {"left", "right"})
    EXPECT_LT(face.moved("palpebrale_superius_" + side).y(), -3.0) << side;
  EXPECT_LT(face.moved("menton").norm(), 0.5);
}

TEST(AnyHead, WithoutEyeballsAndTeeth) {
  Variant head("bare", no_change);
  expect_opens_and_closes(head.face());
}

TEST(AnyHead, WithTrianglesOfNoArea) {
  Variant plain("plain", no_change), head("slivers", [](TriangleMesh&skin) {
    const auto count = static_cast<size_t>(skin.triangle_count());
    for (size_t t = 0; t < count; t += 97) {  // a cap on a side, and a needle at a corner
      const Triangle corners = skin.triangles[t];
      const int middle = skin.vertex_count(), twin = middle + 1;
      const Vec3 a = skin.vertices[static_cast<size_t>(corners[0])],
                 b = skin.vertices[static_cast<size_t>(corners[1])];
      skin.vertices.push_back(0.5 * (a + b));
      skin.vertices.push_back(a);
      skin.triangles[t] = {middle, corners[1], corners[2]};
      skin.triangles.push_back({twin, middle, corners[2]});
      skin.triangles.push_back({corners[0], corners[1], middle});
      skin.triangles.push_back({corners[0], twin, corners[2]});
    }
  });
  expect_opens_and_closes(head.face());
  for (const char* name : {"cheilion_left", "pogonion", "labiale_superius"}) {
    plain.face().pose({{"jaw_open", 0.7}, {"zygomaticus_major_left", 0.5}});
    head.face().pose({{"jaw_open", 0.7}, {"zygomaticus_major_left", 0.5}});
    EXPECT_LT((plain.face().moved(name) - head.face().moved(name)).norm(), 1.5) << name;  // 0.5 is asked for
  }
}

TEST(AnyHead, OpensItsMouthSymmetrically) {
  Variant head("even", no_change);
  for (const double open : {0.4, 0.6, 0.7, 0.8, 1.0}) {
    head.face().pose({{"jaw_open", open}});
    const Vec3 left = head.face().moved("cheilion_left"), right = head.face().moved("cheilion_right");
    EXPECT_LT((left - Vec3(-right.x(), right.y(), right.z())).norm(), 1.5) << open;
    EXPECT_LT(left.x(), 0.0) << open;  // the corners come together, as in measured faces
  }
}

TEST(AnyHead, AsAMaskWithHolesForMouthAndEyes) {
  Variant head("mask", [](TriangleMesh& skin) {
    const double back = landmark("tragion_left").z() + 0.02, bottom = landmark("menton").y() - 0.006;
    const Vec3 lips = landmark("stomion");
    const Vec3 eyes[] = {0.5 * (landmark("endocanthion_left") + landmark("exocanthion_left")),
                         0.5 * (landmark("endocanthion_right") + landmark("exocanthion_right"))};
    std::vector<Triangle> kept;
    const std::vector<Vec3> normals = vertex_normals(skin);
    for (const Triangle& t : skin.triangles) {
      Vec3 p = Vec3::Zero(), normal = Vec3::Zero();
      for (const int v : t) {
        p += skin.vertices[static_cast<size_t>(v)] / 3.0;
        normal += normals[static_cast<size_t>(v)];
      }
      bool lining = (p - lips).norm() < 0.035 && p.z() < lips.z() - 0.004 && std::abs(p.x()) < 0.018;
      for (const Vec3& eye : eyes)
        lining = lining || ((p - eye).norm() < 0.022 && normal.z() < 0.0);
      if (p.z() > back && p.y() > bottom && !lining) kept.push_back(t);
    }
    skin.triangles = kept;
  });
  PosedFace& face = head.face();
  face.pose({{"jaw_open", 1.0}});
  EXPECT_LT(face.moved("labiale_inferius").y() - face.moved("labiale_superius").y(), -8.0);
  EXPECT_LT(face.moved("pogonion").y(), -8.0) << "a mask's edge at the chin goes with the jaw";
}

TEST(AnyHead, PosesDoNotDependOnRotationAndPosition) {
  const Mat3 turn =
      (Eigen::AngleAxisd(0.15, Vec3::UnitY()) * Eigen::AngleAxisd(-0.12, Vec3::UnitX())).matrix();
  Variant plain("straight", no_change),
      turned("turned", no_change, [&](const Vec3&p) { return Vec3(turn * p + Vec3(0.3, -0.2, 0.1)); });
  const PosedFace::Values poses[] = {{{"jaw_open", 0.8}},
                                     {{"zygomaticus_major_left", 1}, {"zygomaticus_major_right", 1}},
                                     {{"lid_upper_left", 1.0}, {"lid_upper_right", 1.0}}};
  for (const PosedFace::Values& pose : poses) {
    plain.face().pose(pose);
    turned.face().pose(pose);
    for (const char* name : {"cheilion_left", "cheilion_right", "pogonion", "labiale_inferius",
                             "palpebrale_superius_left", "palpebrale_superius_right"})
      EXPECT_LT((turned.face().moved(name) - plain.face().moved(name)).norm(), 1.0)  // 0.5 is asked for
          << name << " in " << pose.begin()->first;
  }
}

TEST(AnyHead, PosesDoNotDependOnTheDistanceFromTheOrigin) {
  const Vec3 standing(0.25, 1.5, -0.125);  // a character that stands on its origin
  Variant plain("origin", no_change),
      high("standing", no_change, [&](const Vec3&p) { return Vec3(p + standing); });
  for (const rig::Landmark& landmark : high.face().rig().skull.landmarks)
    EXPECT_LT(landmark.skin.norm(), 0.35F) << landmark.name << ": the rig's origin is near the face";
  const Mat4 map = high.face().rig().input_to_metres.cast<double>();
  EXPECT_LT((transform_point(map, 1e3 * standing) - map.topRightCorner<3, 1>() - standing).norm(), 1e-6);
  for (const char* shape : {"jaw_open", "zygomaticus_major_superior_left"}) {
    plain.face().pose({{shape, 1.0}});
    high.face().pose({{shape, 1.0}});
    for (const char* name : {"cheilion_left", "cheilion_right", "labiale_superius", "labiale_inferius"})
      EXPECT_LT((high.face().moved(name) - plain.face().moved(name)).norm(), 0.1) << name << " in " << shape;
  }
}

/// Each triangle in four, on the same surface; the vertices that were there come first.
void halve_every_edge(TriangleMesh& skin) {
  std::map<std::pair<int, int>, int> middles;
  const auto middle = [&](int a, int b) {
    const auto [entry, is_new] = middles.try_emplace(std::minmax(a, b), skin.vertex_count());
    if (is_new)
      skin.vertices.push_back(
          0.5 * (skin.vertices[static_cast<size_t>(a)] + skin.vertices[static_cast<size_t>(b)]));
    return entry->second;
  };
  std::vector<Triangle> finer;
  for (const Triangle& t : skin.triangles) {
    const int ab = middle(t[0], t[1]), bc = middle(t[1], t[2]), ca = middle(t[2], t[0]);
    finer.insert(finer.end(), {{t[0], ab, ca}, {t[1], bc, ab}, {t[2], ca, bc}, {ab, bc, ca}});
  }
  skin.triangles = std::move(finer);
}

/// Each vertex's motion by where it is at rest, to a hundredth of a millimetre: files may order vertices
/// anew.
std::map<std::array<long, 3>, Vec3> motion_by_place(cli::Face& face) {
  std::map<std::array<long, 3>, Vec3> motion;
  for (size_t m = 0; m < face.meshes().size(); ++m) {
    const auto now = face.positions(m), rest = face.rest(m);
    for (size_t i = 0; i + 2 < now.size(); i += 3)
      motion[{std::lround(1e5F * rest[i]), std::lround(1e5F * rest[i + 1]),
              std::lround(1e5F * rest[i + 2])}] =
          Vec3(now[i] - rest[i], now[i + 1] - rest[i + 1], now[i + 2] - rest[i + 2]);
  }
  return motion;
}

/// How far the vertices that both heads have move otherwise in a pose.
struct Difference {
  double share = 0.0;    ///< root mean square, over how far they move
  double largest = 0.0;  ///< millimetres
};
Difference difference_in(const PosedFace::Values& pose, PosedFace& plain, PosedFace& finer) {
  plain.pose(pose);
  finer.pose(pose);
  const auto coarse = motion_by_place(plain.face()), fine = motion_by_place(finer.face());
  double difference = 0.0, motion = 0.0, largest = 0.0;
  size_t found = 0;
  for (const auto& [place, moved] : coarse) {
    const auto other = fine.find(place);
    if (other == fine.end()) continue;
    ++found;
    difference += (moved - other->second).squaredNorm();
    largest = std::max(largest, 1e3 * (moved - other->second).norm());
    motion += moved.squaredNorm();
  }
  EXPECT_GT(found, coarse.size() * 9 / 10);
  return {std::sqrt(difference / motion), largest};
}

/// Stiffness is the tissue's, not the mesh's: with four triangles in place of each the same vertices move
/// alike.
TEST(AnyHead, ATessellationTwiceAsFineMovesAlike) {
  Variant plain("coarse", no_change), finer("fine", halve_every_edge);
  ASSERT_GT(finer.face().face().rest(0).size(), 3 * plain.face().face().rest(0).size());
  // Lids are the thinnest folds, which a lattice of this detail has in a few columns: they differ most.
  const std::pair<PosedFace::Values, double> poses[] = {
      {{{"jaw_open", 0.6}}, 0.1},
      {{{"zygomaticus_major_left", 1}, {"zygomaticus_major_right", 1}}, 0.2},
      {{{"frontalis_left", 1}, {"frontalis_right", 1}}, 0.25},
      {{{"lid_upper_left", 1.0}, {"lid_upper_right", 1.0}}, 0.35},
  };
  for (const auto& [pose, bound] : poses) {
    const Difference apart = difference_in(pose, plain.face(), finer.face());
    std::printf("%s: %.3f of the motion apart, at most %.2f mm\n", pose.begin()->first.c_str(), apart.share,
                apart.largest);
    EXPECT_LT(apart.share, bound) << pose.begin()->first;
  }
}

}  // namespace
}  // namespace fascia::testing
