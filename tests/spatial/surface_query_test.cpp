#include "builder/spatial/surface_query.h"

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <tbb/global_control.h>
#include <unistd.h>

#include <Eigen/Geometry>
#include <cmath>
#include <fstream>
#include <new>
#include <numbers>
#include <random>

#include "builder/spatial/triangle.h"
#include "geometry/error.h"

namespace fascia::spatial {
namespace {

// Axis-aligned cube [0, 1]^3 whose faces do not share vertices, as a mesh with texture seams.
TriangleMesh seamed_cube() {
  TriangleMesh mesh;
  for (int axis = 0; axis < 3; ++axis)
    for (int side = 0; side < 2; ++side) {
      const int base = mesh.vertex_count();
      for (int k = 0; k < 4; ++k) {
        Vec3 p = Vec3::Zero();
        p[axis] = side;
        p[(axis + 1) % 3] = k == 1 || k == 2;
        p[(axis + 2) % 3] = k >= 2;
        mesh.vertices.push_back(p);
      }
      if (side == 1) {
        mesh.triangles.push_back({base, base + 1, base + 2});
        mesh.triangles.push_back({base, base + 2, base + 3});
      } else {
        mesh.triangles.push_back({base, base + 2, base + 1});
        mesh.triangles.push_back({base, base + 3, base + 2});
      }
    }
  return mesh;
}

double box_distance(const Vec3& p) {
  const Vec3 q = (p - Vec3::Constant(0.5)).cwiseAbs() - Vec3::Constant(0.5);
  return q.cwiseMax(0).norm() + std::min(q.maxCoeff(), 0.0);
}

/// A square of `side` by `side` vertices.
TriangleMesh grid(int side) {
  TriangleMesh mesh;
  for (int y = 0; y < side; ++y)
    for (int x = 0; x < side; ++x)
      mesh.vertices.push_back(Vec3(x, y, std::sin(0.1 * x) * std::cos(0.1 * y)));
  for (int y = 0; y + 1 < side; ++y)
    for (int x = 0; x + 1 < side; ++x) {
      const int v = y * side + x;
      mesh.triangles.push_back({v, v + 1, v + side});
      mesh.triangles.push_back({v + 1, v + side + 1, v + side});
    }
  return mesh;
}

#if defined(__linux__) && !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
/// Bytes of address space in use.
rlim_t address_space() {
  std::ifstream file("/proc/self/statm");
  rlim_t pages = 0;
  file >> pages;
  return pages * static_cast<rlim_t>(getpagesize());
}

/// Exit code of a process that makes a query with `more` bytes of address space left: 0 when it did, 1 when
/// it was told that memory is out.
int made_within(const TriangleMesh& mesh, rlim_t more) {
  const pid_t child = fork();
  if (child == 0) {
    TriangleMesh own = mesh;
    const struct rlimit limit = {address_space() + more, RLIM_INFINITY};
    setrlimit(RLIMIT_AS, &limit);
    try {
      const SurfaceQuery query(std::move(own));
      _exit(query.closest(Vec3(1, 1, 1)).found() ? 0 : 2);
    } catch (const std::bad_alloc&) {
      _exit(1);
    }
  }
  int status = 0;
  waitpid(child, &status, 0);
  return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

TEST(SurfaceQuery, MemoryThatIsNotThereIsSaid) {
  const TriangleMesh mesh = grid(300);
  int refused = 0;
  for (rlim_t megabytes = 0; megabytes < 48; megabytes += 4) {
    const int code = made_within(mesh, megabytes << 20);
    EXPECT_TRUE(code == 0 || code == 1) << megabytes << " MB: " << code;
    refused += code == 1;
  }
  EXPECT_GT(refused, 2);
}
#endif

TEST(SurfaceQuery, SignedDistanceOfACubeIsExactAtFacesEdgesAndCorners) {
  const SurfaceQuery cube(seamed_cube());
  std::mt19937 random(1);
  std::uniform_real_distribution<double> uniform(-1, 2);
  for (int i = 0; i < 2000; ++i) {
    const Vec3 p(uniform(random), uniform(random), uniform(random));
    const ClosestPoint closest = cube.closest(p);
    EXPECT_NEAR(closest.signed_distance, box_distance(p), 1e-14);
    EXPECT_NEAR((closest.position - p).norm(), closest.distance, 1e-14);
    EXPECT_NEAR(closest.surface.barycentric.sum(), 1, 1e-14);
    EXPECT_EQ(cube.inside(p), box_distance(p) < 0);
  }
}

TEST(SurfaceQuery, FarFromTheOriginNothingIsLostToSinglePrecision) {
  TriangleMesh mesh = seamed_cube();
  const Vec3 offset(1e5, -2e5, 3e5);
  for (Vec3& v : mesh.vertices)
    v += offset;
  const SurfaceQuery cube(mesh);
  const Vec3 p(0.3, 0.4, 1.25);
  EXPECT_NEAR(cube.closest(p + offset).distance, 0.25, 1e-10);
  const auto hit = cube.first_hit(p + offset, Vec3(0, 0, -3));
  ASSERT_TRUE(hit.has_value());
  EXPECT_NEAR(hit->distance, 0.25, 1e-10);
}

TEST(SurfaceQuery, RangeLimitsTheSearch) {
  const SurfaceQuery cube(seamed_cube());
  EXPECT_FALSE(cube.closest(Vec3(0.5, 0.5, 3), 1.9).found());
  EXPECT_TRUE(cube.closest(Vec3(0.5, 0.5, 3), 2.1).found());
  EXPECT_FALSE(cube.first_hit(Vec3(0.5, 0.5, 3), Vec3(0, 0, -1), 1.9).has_value());
  EXPECT_TRUE(cube.first_hit(Vec3(0.5, 0.5, 3), Vec3(0, 0, -1), 2.1).has_value());
  EXPECT_NEAR(cube.first_hit(Vec3(0.4, 0.5, 3), Vec3(0, 0, -1), 10, 2.5)->distance, 3, 1e-14);
}

TEST(SurfaceQuery, RaysPassThroughFrontThenBack) {
  const SurfaceQuery cube(seamed_cube());
  const auto hits = cube.all_hits(Vec3(0.3, 0.6, -2), Vec3(0, 0.01, 1));
  ASSERT_EQ(hits.size(), 2u);
  EXPECT_TRUE(hits[0].from_outside);
  EXPECT_FALSE(hits[1].from_outside);
  EXPECT_NEAR(hits[0].position.z(), 0, 1e-14);
  EXPECT_NEAR(hits[1].position.z(), 1, 1e-14);
  EXPECT_FALSE(cube.first_hit(Vec3(0.3, 0.6, -2), Vec3(0, 0, -1)).has_value());
}

TEST(SurfaceQuery, WindingNumberFallsBesideAnOpening) {
  TriangleMesh open = seamed_cube();
  open.triangles.resize(10);  // no face at z = 1
  const SurfaceQuery box(open);
  EXPECT_NEAR(box.winding_number(Vec3(0.5, 0.5, 0.5)), 5.0 / 6, 1e-12);
  EXPECT_TRUE(box.inside(Vec3(0.5, 0.5, 0.5)));
  EXPECT_FALSE(box.inside(Vec3(0.5, 0.5, 1.5)));
}

TEST(SurfaceQuery, RejectsInvalidMeshes) {
  EXPECT_THROW(SurfaceQuery(TriangleMesh{}), Error);
  TriangleMesh mesh = seamed_cube();
  mesh.triangles[0][1] = 99;
  EXPECT_THROW(SurfaceQuery{mesh}, Error);
  mesh = seamed_cube();
  mesh.vertices[3].x() = std::nan("");
  EXPECT_THROW(SurfaceQuery{mesh}, Error);
  EXPECT_THROW(SurfaceQuery(seamed_cube()).first_hit(Vec3(0, 0, 0), Vec3(0, 0, 0)), Error);
  EXPECT_THROW(SurfaceQuery(seamed_cube()).closest(Vec3(std::nan(""), 0, 0)), Error);
}

TEST(Triangle, DegenerateTrianglesAreTheirLongestEdge) {
  const Vec3 a(0, 0, 0), b(1, 0, 0), c(3, 0, 0);
  const Vec3 weights = closest_barycentric(Vec3(2, 1, 0), a, b, c);
  EXPECT_NEAR((weights[0] * a + weights[1] * b + weights[2] * c - Vec3(2, 0, 0)).norm(), 0, 1e-14);
  EXPECT_EQ(closest_barycentric(Vec3(2, 1, 0), a, a, a), Vec3(1, 0, 0));
}

TEST(Triangle, WeightsOfTheClosestPlaceAreNeverNegative) {
  // Points on an edge, where rounding goes either way.
  std::mt19937 random(5);
  std::uniform_real_distribution<double> any(-1.0, 1.0);
  for (int i = 0; i < 20000; ++i) {
    const auto point = [&] { return Vec3(any(random), any(random), any(random)); };
    const Vec3 a = point(), b = point(), c = point();
    const double share = 0.5 * (any(random) + 1.0);
    const Vec3 weights = closest_barycentric(share * b + (1.0 - share) * c, a, b, c);
    ASSERT_GE(weights.minCoeff(), 0.0) << i;
    ASSERT_NEAR(weights.sum(), 1.0, 1e-12) << i;
  }
}

TEST(Triangle, OctantHasAnEighthOfTheSphere) {
  EXPECT_NEAR(solid_angle(Vec3::Zero(), Vec3::UnitX(), Vec3::UnitY(), Vec3::UnitZ()), std::numbers::pi / 2,
              1e-14);
}

TEST(SurfaceQuery, LeavesTheNumberOfThreadsOfTheProcessAsItIs) {
  const auto threads = [] {
    return tbb::global_control::active_value(tbb::global_control::max_allowed_parallelism);
  };
  const size_t before = threads();
  if (before < 2) GTEST_SKIP() << "one thread is all there is";
  {
    const SurfaceQuery query(seamed_cube());
    EXPECT_EQ(threads(), before);
  }
  EXPECT_EQ(threads(), before);
}

}  // namespace
}  // namespace fascia::spatial
