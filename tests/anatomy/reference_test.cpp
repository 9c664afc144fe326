// The generic head and skull against what they were measured on, where that is at hand.

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <string>

#include "anatomy/anatomy.h"
#include "builder/spatial/surface_query.h"
#include "formats/scene.h"
#include "tests/paths/paths.h"
#include "tools/anatomy/skull/figures.h"

namespace fascia {
namespace {

namespace fs = std::filesystem;

const fs::path measured = test::measured_data() / "data";

const anatomy::GenericAnatomy& generic() {
  static const anatomy::GenericAnatomy anatomy = anatomy::load_generic();
  return anatomy;
}

TriangleMesh joined(const formats::Scene& scene, const std::string& only = {}) {
  TriangleMesh mesh;
  for (const formats::SceneMesh& part : scene.meshes) {
    if (!only.empty() && part.name != only) continue;
    const int first = mesh.vertex_count();
    for (const Vec3& position : part.positions)
      mesh.vertices.push_back(position + scene.offset);
    for (const Triangle& t : part.triangles)
      mesh.triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
  }
  return mesh;
}

/// Vertices and middles of the triangles, millimetres.
std::vector<Vec3> samples(const TriangleMesh& mesh) {
  std::vector<Vec3> points;
  for (const Vec3& v : mesh.vertices)
    points.push_back(1e3 * v);
  for (const Triangle& t : mesh.triangles) {
    Vec3 middle = Vec3::Zero();
    for (const int v : t)
      middle += 1e3 / 3 * mesh.vertices[static_cast<std::size_t>(v)];
    points.push_back(middle);
  }
  return points;
}

struct Distance {
  double sum = 0, worst = 0;
  int count = 0;
  void add(double distance) {
    sum += distance;
    worst = std::max(worst, distance);
    ++count;
  }
  double mean() const { return count ? sum / count : 1e9; }
};

struct ByRegion {
  Distance face, elsewhere;
};

/// Distances of ours to `reference`; on the cranium apart for the facial skeleton.
ByRegion distances(const std::string& part, const TriangleMesh& reference) {
  const spatial::SurfaceQuery surface(reference);
  ByRegion out;
  for (const Vec3& point : samples(generic().skull_object(part)->mesh)) {
    const bool face = part != "cranium" || (point.z() > 50 && point.y() < 65);
    (face ? out.face : out.elsewhere).add(surface.closest(point).distance);
  }
  return out;
}

class ReferenceSkull : public testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(All, ReferenceSkull,
                         testing::Values("cranium", "mandible", "teeth_upper", "teeth_lower"));

TEST_P(ReferenceSkull, IsMetAfterAWarpThroughTheLandmarks) {
  const std::string part = GetParam();
  const fs::path file = measured / "bodyparts3d" / (part + ".obj");
  if (!fs::exists(file)) GTEST_SKIP() << "the measured skull is not at " << file;
  TriangleMesh reference = joined(formats::read(file));
  for (Vec3& v : reference.vertices)
    v = Vec3(v.x() + 0.65, v.z() - 1500.0, -v.y());
  const auto warp = skull_maker::read_figures(FASCIA_ANATOMY_FIGURES).to_generic;
  TriangleMesh warped = reference;
  for (Vec3& v : warped.vertices)
    v = warp(v);
  const ByRegion by_warp = distances(part, warped);
  EXPECT_LE(by_warp.face.mean(), 1.5);
  if (by_warp.elsewhere.count > 0) {
    EXPECT_LE(by_warp.elsewhere.mean(), 2.5);
  }

  // By a similarity alone it is only reported.
  Eigen::Matrix3Xd from(3, reference.vertex_count());
  Eigen::Matrix3Xd to(3, reference.vertex_count());
  for (int v = 0; v < reference.vertex_count(); ++v) {
    from.col(v) = reference.vertices[static_cast<std::size_t>(v)];
    to.col(v) = warped.vertices[static_cast<std::size_t>(v)];
  }
  const Eigen::Matrix4d similarity = Eigen::umeyama(from, to, true);
  for (Vec3& v : reference.vertices)
    v = (similarity * v.homogeneous()).head<3>();
  const ByRegion alone = distances(part, reference);
  std::printf("%s: face %.2f mm (worst %.1f), elsewhere %.2f (worst %.1f); by similarity alone %.2f, %.2f\n",
              part.c_str(), by_warp.face.mean(), by_warp.face.worst,
              by_warp.elsewhere.count ? by_warp.elsewhere.mean() : 0.0, by_warp.elsewhere.worst,
              alone.face.mean(), alone.elsewhere.count ? alone.elsewhere.mean() : 0.0);
}

TEST(ReferenceFace, IsMetWithoutAnyWarp) {
  const fs::path file = measured / "ict" / "neutral.glb";
  if (!fs::exists(file)) GTEST_SKIP() << "the mean face is not at " << file;
  const TriangleMesh reference = joined(formats::read(file), "head");
  ASSERT_GT(reference.triangle_count(), 10000);
  const spatial::SurfaceQuery surface(reference);
  const double ears = generic().landmark("tragion_left")->skin->z() + 0.01;
  const double chin = generic().landmark("menton")->skin->y();
  Distance face;
  for (const Vec3& point : samples(generic().head_object("skin")->mesh)) {
    // In front of the ears, above the chin; the lining of the mouth lies behind.
    if (point.z() < 1e3 * ears || point.y() < 1e3 * chin) continue;
    face.add(1e3 * surface.closest(1e-3 * point).distance);
  }
  EXPECT_LE(face.mean(), 1.5);
  std::printf("face: %.2f mm (worst %.1f)\n", face.mean(), face.worst);
}

}  // namespace
}  // namespace fascia
