// The generic skull: anatomy/data/skull.obj.

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <fstream>
#include <iterator>
#include <map>
#include <numeric>
#include <set>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "builder/smas/surface_quality.h"
#include "builder/spatial/surface_query.h"
#include "geometry/connectivity.h"
#include "geometry/mesh.h"
#include "tools/anatomy/skull/skull.h"

namespace fascia {
namespace {

/// The objects of an OBJ file, vertices renumbered for each.
std::map<std::string, TriangleMesh> read_objects(const std::string& path) {
  std::map<std::string, TriangleMesh> parts;
  std::ifstream file(path);
  std::string line;
  TriangleMesh* part = nullptr;
  int first = 1;
  int total = 0;
  while (std::getline(file, line)) {
    std::istringstream words(line);
    std::string kind;
    words >> kind;
    if (kind == "o") {
      std::string name;
      words >> name;
      part = &parts[name];
      first = total + 1;
    } else if (kind == "v") {
      Vec3 v;
      words >> v.x() >> v.y() >> v.z();
      part->vertices.push_back(v);
      ++total;
    } else if (kind == "f") {
      Triangle t;
      words >> t[0] >> t[1] >> t[2];
      part->triangles.push_back({t[0] - first, t[1] - first, t[2] - first});
    }
  }
  return parts;
}

const std::map<std::string, TriangleMesh>& skull() {
  static const auto parts = read_objects(FASCIA_ANATOMY_DATA "/skull.obj");
  return parts;
}

double volume(const TriangleMesh& mesh) {
  double sum = 0;
  for (const Triangle& t : mesh.triangles) {
    const auto at = [&](std::size_t k) { return mesh.vertices[static_cast<std::size_t>(t[k])]; };
    sum += at(0).dot(at(1).cross(at(2))) / 6;
  }
  return sum;
}

int euler_number(const TriangleMesh& mesh) {
  // In a closed manifold three half edges a triangle make 3/2 edges.
  return mesh.vertex_count() - mesh.triangle_count() / 2;
}

class SkullPart : public testing::TestWithParam<const char*> {
 protected:
  const TriangleMesh& mesh() const { return skull().at(GetParam()); }
};
INSTANTIATE_TEST_SUITE_P(All, SkullPart,
                         testing::Values("cranium", "mandible", "teeth_upper", "teeth_lower"));

TEST(Skull, HasItsFourPartsAndNoOther) {
  ASSERT_EQ(skull().size(), 4U);
  int triangles = 0;
  for (const auto& [name, mesh] : skull())
    triangles += mesh.triangle_count();
  EXPECT_GE(triangles, 8000);
  EXPECT_LE(triangles, 15000);
}

TEST_P(SkullPart, IsAClosedManifold) {
  const Connectivity links = connectivity(mesh());
  EXPECT_EQ(links.irregular_edges, 0);
  EXPECT_TRUE(boundary_loops(mesh(), links).empty());
  // One fan around each vertex: walking across edges from any of its triangles reaches all of them.
  for (int v = 0; v < mesh().vertex_count(); ++v) {
    const auto at = static_cast<std::size_t>(v);
    std::set<int> fan(links.vertex_triangles.begin() + links.vertex_offsets[at],
                      links.vertex_triangles.begin() + links.vertex_offsets[at + 1]);
    ASSERT_GE(fan.size(), 3U) << v;
    std::vector<int> open{*fan.begin()};
    fan.erase(fan.begin());
    while (!open.empty()) {
      const int t = open.back();
      open.pop_back();
      for (const int next : links.neighbours[static_cast<std::size_t>(t)]) {
        if (fan.erase(next) > 0) open.push_back(next);
      }
    }
    ASSERT_TRUE(fan.empty()) << "vertex " << v << " joins two sheets";
  }
}

TEST_P(SkullPart, IsItsOwnMirrorImageExactly) {
  const auto less = [](const Vec3& a, const Vec3& b) {
    return std::lexicographical_compare(a.data(), a.data() + 3, b.data(), b.data() + 3);
  };
  std::map<Vec3, int, decltype(less)> index(less);
  for (int v = 0; v < mesh().vertex_count(); ++v)
    index[mesh().vertices[static_cast<std::size_t>(v)]] = v;
  ASSERT_EQ(static_cast<int>(index.size()), mesh().vertex_count()) << "two vertices in one place";
  std::vector<int> twin;
  for (const Vec3& v : mesh().vertices) {
    const auto found = index.find({-v.x() + 0.0, v.y(), v.z()});
    ASSERT_NE(found, index.end()) << v.transpose();
    twin.push_back(found->second);
  }
  const auto turned = [](Triangle t) {
    std::rotate(t.begin(), std::min_element(t.begin(), t.end()), t.end());
    return t;
  };
  std::set<Triangle> triangles;
  for (const Triangle& t : mesh().triangles)
    triangles.insert(turned(t));
  for (const Triangle& t : mesh().triangles) {
    const auto image = [&](std::size_t k) { return twin[static_cast<std::size_t>(t[k])]; };
    EXPECT_TRUE(triangles.count(turned({image(0), image(2), image(1)})));
  }
}

TEST(Skull, TopologyIsThatOfAnatomy) {
  // Two arches, each a handle; nothing else.
  EXPECT_EQ(euler_number(skull().at("cranium")), -2);
  EXPECT_EQ(euler_number(skull().at("mandible")), 2);
  for (const char* teeth : {"teeth_upper", "teeth_lower"}) {
    int count = 0;
    components(skull().at(teeth), &count);
    EXPECT_EQ(count, 14) << teeth;
    EXPECT_EQ(euler_number(skull().at(teeth)), 28) << teeth;
  }
  for (const char* bone : {"cranium", "mandible"}) {
    int count = 0;
    components(skull().at(bone), &count);
    EXPECT_EQ(count, 1) << bone;
  }
}

TEST(Skull, FacesOutwardsWithHumanVolumes) {
  // The solid cranium: a braincase of about 1.3 to 1.7 litres and its bone.
  EXPECT_GT(volume(skull().at("cranium")), 1.3e6);
  EXPECT_LT(volume(skull().at("cranium")), 2.6e6);
  EXPECT_GT(volume(skull().at("mandible")), 3.0e4);
  EXPECT_LT(volume(skull().at("mandible")), 1.2e5);
  EXPECT_GT(volume(skull().at("teeth_upper")), 3e3);
  EXPECT_GT(volume(skull().at("teeth_lower")), 3e3);
}

TEST(Skull, TrianglesAreWellShaped) {
  for (const char* bone : {"cranium", "mandible"}) {
    const smas::TriangleQuality quality = smas::triangle_quality(skull().at(bone));
    EXPECT_GT(quality.mean_radius_ratio, 0.85) << bone;
    EXPECT_GT(quality.min_angle, 2.0) << bone;
  }
}

TEST(Skull, MandibleAndCraniumDoNotMeet) {
  const spatial::SurfaceQuery cranium(skull().at("cranium"));
  const spatial::SurfaceQuery mandible(skull().at("mandible"));
  for (const Vec3& v : skull().at("mandible").vertices)
    EXPECT_GT(cranium.signed_distance(v), 0.0) << v.transpose();
  for (const Vec3& v : skull().at("cranium").vertices)
    EXPECT_GT(mandible.signed_distance(v), 0.0) << v.transpose();
}

TEST(Skull, TemporalFossaIsOpenUnderTheArch) {
  // From above, straight down between the arch and the braincase, behind the orbit, in front of the joint.
  const spatial::SurfaceQuery cranium(skull().at("cranium"));
  bool open = false;
  for (double x = 40; x < 68; x += 1) {
    const auto down = cranium.first_hit({x, 60, 48}, {0, -1, 0}, 120);
    const auto inwards = cranium.first_hit({120, 12, 48}, {-1, 0, 0}, 200);
    open = open || (!down && inwards && inwards->position.x() > x);
  }
  EXPECT_TRUE(open);
}

TEST(Skull, TeethStandInTheirJaws) {
  for (const auto& [teeth, bone] :
       {std::pair{"teeth_upper", "cranium"}, std::pair{"teeth_lower", "mandible"}}) {
    const spatial::SurfaceQuery jaw(skull().at(bone));
    const TriangleMesh& mesh = skull().at(teeth);
    int count = 0;
    const std::vector<int> part = components(mesh, &count);
    std::vector<double> deepest(static_cast<std::size_t>(count), 1e9);
    std::vector<double> farthest(static_cast<std::size_t>(count), -1e9);
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
      for (const int v : mesh.triangles[t]) {
        const double distance = jaw.signed_distance(mesh.vertices[static_cast<std::size_t>(v)]);
        auto& deep = deepest[static_cast<std::size_t>(part[t])];
        auto& far = farthest[static_cast<std::size_t>(part[t])];
        deep = std::min(deep, distance);
        far = std::max(far, distance);
      }
    }
    for (int i = 0; i < count; ++i) {
      EXPECT_LT(deepest[static_cast<std::size_t>(i)], -0.5) << teeth << ' ' << i << " hangs free";
      EXPECT_GT(farthest[static_cast<std::size_t>(i)], 3.0) << teeth << ' ' << i << " is buried";
    }
  }
}

TEST(Skull, OrbitsAndNasalCavityAreDeep) {
  const spatial::SurfaceQuery cranium(skull().at("cranium"));
  const auto orbit = cranium.first_hit({45, 37, 150}, {-0.2, -0.03, -1}, 300);
  ASSERT_TRUE(orbit);
  // The orbital rims lie at about z = 90.
  EXPECT_LT(orbit->position.z(), 62);
  const auto nose = cranium.first_hit({4, 2, 150}, {0, 0, -1}, 300);
  ASSERT_TRUE(nose);
  EXPECT_LT(nose->position.z(), 70);
}

/// How far the vertices of `from` lie off the surface of `to`, millimetres: mean, and what one in a hundred
/// exceeds.
std::pair<double, double> deviation(const TriangleMesh& from, const TriangleMesh& to) {
  const spatial::SurfaceQuery surface(to);
  std::vector<double> distances;
  for (const Vec3& place : from.vertices)
    distances.push_back(surface.closest(place).distance);
  std::sort(distances.begin(), distances.end());
  const double mean = std::accumulate(distances.begin(), distances.end(), 0.0) / double(distances.size());
  return {mean, distances[distances.size() * 99 / 100]};
}

// Where two ways to cut a sharp edge are as good, the mesher's choice is the processor's: surfaces are
// compared.
TEST(Skull, IsMadeFromItsFigures) {
  const auto made = skull_maker::make_skull(skull_maker::read_figures(FASCIA_ANATOMY_FIGURES));
  ASSERT_EQ(made.size(), skull().size());
  for (const auto& part : made) {
    SCOPED_TRACE(part.name);
    const TriangleMesh& shipped = skull().at(part.name);
    EXPECT_NEAR(part.mesh.vertex_count(), shipped.vertex_count(), 0.01 * shipped.vertex_count());
    for (const auto& [mean, hundredth] : {deviation(part.mesh, shipped), deviation(shipped, part.mesh)}) {
      EXPECT_LT(mean, 0.04);
      EXPECT_LT(hundredth, 0.6);
    }
  }
}

}  // namespace
}  // namespace fascia
