#include "builder/openings/openings.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <numeric>
#include <random>
#include <set>
#include <sstream>

#include "builder/openings/fused.h"
#include "builder/spatial/surface_query.h"
#include "geometry/connectivity.h"
#include "geometry/error.h"
#include "tests/openings/closed_head.h"
#include "tests/shapes/grid.h"

namespace fascia::testing {
namespace {

const anatomy::GenericAnatomy& generic() {
  static const anatomy::GenericAnatomy anatomy = anatomy::load_generic();
  return anatomy;
}

/// A head of a file, before and after its openings were parted.
struct Case {
  formats::Scene scene;
  prepare::PreparedHead before, head;
  openings::OpenedHead opened;
};

Case open(const TriangleMesh& skin, const Landmarks& landmarks,
          const openings::OpeningOptions& options = {}) {
  Case result;
  const std::string text = obj_text(skin);
  result.scene = formats::read("head.obj", {text.begin(), text.end()});
  formats::LandmarkFile file;
  file.units = "mm";
  Landmarks reference;
  for (const auto& [name, p] : landmarks)
    file.points[name] = 1e3 * p;
  for (const anatomy::Landmark& landmark : generic().landmarks)
    if (landmark.skin) reference[landmark.name] = *landmark.skin;
  result.before = prepare::prepare(result.scene, file, reference, {});
  result.head = result.before;
  result.opened =
      openings::open_head(result.scene, result.head, result.head.landmarks, generic(), false, options);
  return result;
}

std::vector<std::string> names(const openings::OpenedHead& opened) {
  std::vector<std::string> all;
  for (const openings::Parted& parted : opened.parted)
    all.push_back(parted.name);
  return all;
}

int open_edges(const TriangleMesh& mesh) {
  int count = 0;
  for (const auto& around : connectivity(mesh).neighbours)
    count += static_cast<int>(std::count(around.begin(), around.end(), -1));
  return count;
}

std::vector<std::string> lines(const std::vector<uint8_t>& bytes, const std::string& word) {
  std::istringstream text(std::string(bytes.begin(), bytes.end()));
  std::vector<std::string> found;
  for (std::string line; std::getline(text, line);)
    if (line.rfind(word + " ", 0) == 0) found.push_back(line);
  return found;
}

TEST(Openings, PartsClosedLipsAndLids) {
  const ClosedHead closed = closed_head(generic());
  const Case c = open(closed.skin, closed.landmarks);
  EXPECT_EQ(names(c.opened), (std::vector<std::string>{"mouth", "eye_left", "eye_right"}));
  EXPECT_EQ(c.opened.added, (std::vector<std::string>{"eye_left", "eye_right"}));
  EXPECT_TRUE(c.opened.warnings.empty()) << c.opened.warnings[0];
  // A surface as whole as before: no crack beside the cut, no edge of three triangles, lining sewn on.
  EXPECT_EQ(open_edges(c.head.skin), open_edges(c.before.skin));
  EXPECT_EQ(connectivity(c.head.skin).irregular_edges, connectivity(c.before.skin).irregular_edges);
  int pieces = 0;
  components(c.head.skin, &pieces);
  EXPECT_EQ(pieces, 1);
}

TEST(Openings, KeepsTheVerticesThatWereThere) {
  const ClosedHead closed = closed_head(generic());
  const Case c = open(closed.skin, closed.landmarks);
  const formats::SceneMesh &before = c.scene.meshes[0], &after = c.opened.scene.meshes[0];
  ASSERT_GT(after.positions.size(), before.positions.size());
  for (size_t v = 0; v < before.positions.size(); ++v)
    ASSERT_EQ(after.positions[v], before.positions[v]) << v;
  const int appended =
      std::accumulate(c.opened.parted.begin(), c.opened.parted.end(), 0,
                      [](int sum, const openings::Parted& parted) { return sum + parted.vertices; });
  EXPECT_EQ(after.positions.size(), before.positions.size() + static_cast<size_t>(appended));
  EXPECT_EQ(after.uvs.size(), after.positions.size());
  for (size_t t = 0; t < before.triangles.size(); ++t)
    if (after.triangles[t] != before.triangles[t]) {
      // Only triangles at lips and lids were touched.
      const Vec3 p = 1e-3 * before.positions[static_cast<size_t>(before.triangles[t][0])];
      double nearest = 1e9;
      for (const char* name : {"stomion", "cheilion_left", "cheilion_right", "endocanthion_left",
                               "exocanthion_left", "endocanthion_right", "exocanthion_right"})
        nearest = std::min(nearest, (p - closed.landmarks.at(name)).norm());
      EXPECT_LT(nearest, 0.022);
    }
}

/// `skin` with triangles without area on some edges that cross the line of the lips.
TriangleMesh with_slivers_between_lips(TriangleMesh skin, const Vec3& stomion, int& count) {
  const Connectivity links = connectivity(skin);
  std::vector<bool> is_taken(skin.triangles.size());
  count = 0;
  for (int t = 0; t < static_cast<int>(is_taken.size()); ++t)
    for (size_t e = 0; e < 3 && !is_taken[static_cast<size_t>(t)]; ++e) {
      const Triangle k = skin.triangles[static_cast<size_t>(t)];
      const int b = k[e], a = k[(e + 1) % 3], d = k[(e + 2) % 3],
                other = links.neighbours[static_cast<size_t>(t)][e];
      const Vec3 &p = skin.vertices[static_cast<size_t>(a)], &q = skin.vertices[static_cast<size_t>(b)];
      const Vec3 middle = 0.5 * (p + q);
      const bool crosses = (p.y() - stomion.y()) * (q.y() - stomion.y()) < 0.0 &&
                           std::abs(middle.x() - stomion.x()) < 0.012 && (middle - stomion).norm() < 0.016;
      if (!crosses || other < 0 || is_taken[static_cast<size_t>(other)]) continue;
      const int m = skin.vertex_count();
      skin.vertices.push_back(middle);
      skin.triangles[static_cast<size_t>(t)] = {m, a, d};
      skin.triangles.push_back({b, m, d});
      skin.triangles.push_back({a, m, b});
      is_taken[static_cast<size_t>(t)] = is_taken[static_cast<size_t>(other)] = true;
      ++count;
    }
  return skin;
}

/// Whether an edge leads from a vertex of the skin to one that is no farther than two edges of it.
class Nearness {
 public:
  explicit Nearness(const TriangleMesh& skin) : neighbours_(skin.vertices.size()) {
    for (const Triangle& t : skin.triangles)
      for (size_t e = 0; e < 3; ++e)
        for (size_t k = 1; k < 3; ++k)
          neighbours_[static_cast<size_t>(t[e])].push_back(t[(e + k) % 3]);
  }
  bool operator()(int a, int b) const {
    for (const int n : neighbours_[static_cast<size_t>(a)])
      for (const int m : neighbours_[static_cast<size_t>(n)])
        if (n == b || m == b) return true;
    return a == b;
  }

 private:
  std::vector<std::vector<int>> neighbours_;
};

TEST(Openings, FoldedTrianglesDoNotHoldTheLipsTogether) {
  const ClosedHead closed = closed_head(generic());
  TriangleMesh skin = closed.skin;
  // Fins across the line of the lips, each of two triangles back to back.
  const Vec3 stomion = closed.landmarks.at("stomion");
  const int own = skin.vertex_count();
  const auto triangles = skin.triangles;
  int count = 0;
  for (const Triangle& t : triangles) {
    const Vec3 &a = skin.vertices[static_cast<size_t>(t[0])], &b = skin.vertices[static_cast<size_t>(t[1])];
    if ((a.y() - stomion.y()) * (b.y() - stomion.y()) >= 0.0 || (a - stomion).norm() > 0.012) continue;
    skin.vertices.push_back(0.5 * (a + b) + Vec3(0, 0, 0.002));
    skin.triangles.push_back({t[0], t[1], skin.vertex_count() - 1});
    skin.triangles.push_back({t[1], t[0], skin.vertex_count() - 1});
    ++count;
  }
  ASSERT_GT(count, 2);
  const Case c = open(skin, closed.landmarks);
  ASSERT_FALSE(c.opened.parted.empty());
  EXPECT_EQ(c.opened.parted[0].name, "mouth");
  const std::vector<int>& of = c.head.meshes[0].skin_vertices;
  const Nearness is_near(c.head.skin);
  for (const Triangle& t : c.opened.scene.meshes[0].triangles) {
    std::vector<int> ends;  // of the skin's own vertices
    bool is_fin = false;
    for (const int v : t) {
      is_fin = is_fin || (v >= own && v < own + count);
      if (v < own || v >= own + count) ends.push_back(of[static_cast<size_t>(v)]);
    }
    if (!is_fin || ends.size() != 2 || ends[0] < 0 || ends[1] < 0) continue;
    EXPECT_TRUE(is_near(ends[0], ends[1])) << ends[0] << " " << ends[1];
  }
}

TEST(Openings, TrianglesWithoutAreaDoNotHoldTheLipsTogether) {
  const ClosedHead closed = closed_head(generic());
  int count = 0;
  const TriangleMesh skin = with_slivers_between_lips(closed.skin, closed.landmarks.at("stomion"), count);
  ASSERT_GT(count, 2);
  const Case c = open(skin, closed.landmarks);
  ASSERT_FALSE(c.opened.parted.empty());
  EXPECT_EQ(c.opened.parted[0].name, "mouth");
  // An edge of the file leads no farther than two edges of the skin that is computed with.
  const Nearness is_near(c.head.skin);
  const std::vector<int>& of = c.head.meshes[0].skin_vertices;
  const TriangleMesh file{c.opened.scene.meshes[0].positions, c.opened.scene.meshes[0].triangles};
  for (int i = 0; i < file.triangle_count(); ++i)
    for (size_t e = 0; e < 3 && triangle_area(file, i) < 1e-6; ++e) {
      const Triangle& t = file.triangles[static_cast<size_t>(i)];
      const int a = of[static_cast<size_t>(t[e])], b = of[static_cast<size_t>(t[(e + 1) % 3])];
      EXPECT_TRUE(a < 0 || b < 0 || is_near(a, b)) << a << " " << b;
    }
}

TEST(Openings, LeavesOpenEyesInOnePieceWithTheirLidsAlone) {
  const Case c = open(eyes_in_one_piece(generic()), closed_head(generic()).landmarks);
  EXPECT_TRUE(names(c.opened).empty());
  EXPECT_TRUE(c.opened.added.empty());
  ASSERT_EQ(c.opened.warnings.size(), 1U);
  EXPECT_NE(c.opened.warnings[0].find("lids"), std::string::npos) << c.opened.warnings[0];
}

TEST(Openings, LeavesOpenHeadsAlone) {
  const anatomy::MeshObject* skin = generic().head_object("skin");
  const ClosedHead closed = closed_head(generic());
  const Case c = open(skin->mesh, closed.landmarks);
  EXPECT_FALSE(c.opened.changed());
  openings::OpeningOptions options;
  options.open = "never";
  EXPECT_TRUE(open(closed.skin, closed.landmarks, options).opened.parted.empty());
}

TEST(Openings, LeavesAMouthAloneWhoseCornersWerePlacedTooFarOut) {
  constexpr double half_line = 0.036, side = 0.06;
  const auto is_slit_fused = [&](double half_slit) {
    TriangleMesh skin;
    for (const double up : {1.0, -1.0}) {  // two halves of a square, joined beside the slit
      const TriangleMesh half = grid(120, 60, [&](double u, double v) {
        const double x = side * (2.0 * u - 1.0), gap = std::abs(x) < half_slit ? 1e-4 : 0.0;
        return Vec3(x, up > 0.0 ? gap + v * (side - gap) : -gap - (1.0 - v) * (side - gap), 0.0);
      });
      const int first = skin.vertex_count();
      skin.vertices.insert(skin.vertices.end(), half.vertices.begin(), half.vertices.end());
      for (const Triangle& t : half.triangles)
        skin.triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
    }
    skin = weld(skin, 1e-6, nullptr);
    openings::MeetingLine line;
    line.half_width = half_line;
    line.heights = {0.0, 0.0};
    return openings::is_fused(skin, connectivity(skin), spatial::SurfaceQuery(skin), line);
  };
  EXPECT_TRUE(is_slit_fused(0.0));
  EXPECT_FALSE(is_slit_fused(0.0185));  // near its ends the way around them is short
  EXPECT_FALSE(is_slit_fused(half_line));
}

TEST(Openings, PartsOnlyWhatIsClosed) {
  const ClosedHead closed = closed_head(generic(), false);
  EXPECT_EQ(names(open(closed.skin, closed.landmarks).opened), (std::vector<std::string>{"mouth"}));
}

TEST(Openings, CutsBothSidesSymmetrically) {
  const ClosedHead closed = closed_head(generic());
  const Case c = open(closed.skin, closed.landmarks);
  EXPECT_EQ(c.opened.parted[1].vertices, c.opened.parted[2].vertices);
  const auto first = static_cast<size_t>(c.before.skin.vertex_count());
  double largest = 0.0;
  for (size_t v = first; v < c.head.skin.vertices.size(); ++v) {
    const Vec3& p = c.head.skin.vertices[v];
    double nearest = 1e9;
    for (size_t w = first; w < c.head.skin.vertices.size(); ++w)
      nearest = std::min(nearest, (c.head.skin.vertices[w] - Vec3(-p.x(), p.y(), p.z())).norm());
    largest = std::max(largest, nearest);
  }
  EXPECT_LT(1e3 * largest, 0.3);
}

TEST(Openings, DoesNotDependOnPoseOrOrder) {
  const ClosedHead closed = closed_head(generic());
  const Case plain = open(closed.skin, closed.landmarks);
  const Mat3 turn = (Eigen::AngleAxisd(0.2, Vec3::UnitY()) * Eigen::AngleAxisd(-0.15, Vec3::UnitX()) *
                     Eigen::AngleAxisd(0.1, Vec3::UnitZ()))
                        .toRotationMatrix();
  const Vec3 shift(0.4, 1.5, -0.2);
  std::vector<int> order(closed.skin.vertices.size());
  std::iota(order.begin(), order.end(), 0);
  std::mt19937 random(7);
  std::shuffle(order.begin(), order.end(), random);
  ClosedHead other = closed;
  for (size_t v = 0; v < order.size(); ++v)
    other.skin.vertices[static_cast<size_t>(order[v])] = turn * closed.skin.vertices[v] + shift;
  for (Triangle& t : other.skin.triangles)
    t = {order[static_cast<size_t>(t[1])], order[static_cast<size_t>(t[2])],
         order[static_cast<size_t>(t[0])]};
  std::shuffle(other.skin.triangles.begin(), other.skin.triangles.end(), random);
  for (auto& [name, p] : other.landmarks)
    p = turn * p + shift;
  const Case turned = open(other.skin, other.landmarks);
  ASSERT_EQ(names(turned.opened), names(plain.opened));
  const auto first = static_cast<size_t>(plain.before.skin.vertex_count());
  ASSERT_EQ(turned.head.skin.vertices.size(), plain.head.skin.vertices.size());
  double largest = 0.0;
  for (size_t v = first; v < plain.head.skin.vertices.size(); ++v) {
    const Vec3 p = turn * plain.head.skin.vertices[v] + shift;
    double nearest = 1e9;
    for (size_t w = first; w < turned.head.skin.vertices.size(); ++w)
      nearest = std::min(
          nearest,
          (transform_point(turned.head.input_to_metres.inverse(), turned.head.skin.vertices[w]) * 1e-3 - p)
              .norm());
    largest = std::max(largest, nearest);
  }
  EXPECT_LT(1e3 * largest, 0.2);
}

TEST(Openings, RewritesOnlyTheFacesThatWereCut) {
  const ClosedHead closed = closed_head(generic());
  Case c = open(closed.skin, closed.landmarks);
  const std::vector<std::string> vertices = lines(c.scene.bytes, "v"), faces = lines(c.scene.bytes, "f");
  formats::rewrite(c.opened.scene, c.opened.extensions);
  const std::vector<std::string> vertices_after = lines(c.opened.scene.bytes, "v"),
                                 faces_after = lines(c.opened.scene.bytes, "f");
  ASSERT_GT(vertices_after.size(), vertices.size());
  EXPECT_TRUE(std::equal(vertices.begin(), vertices.end(), vertices_after.begin()));
  // Faces that were not cut stand there as they did, in their order.
  size_t kept = 0, at = 0;
  for (const std::string& face : faces) {
    const auto found =
        std::find(faces_after.begin() + static_cast<std::ptrdiff_t>(at), faces_after.end(), face);
    if (found == faces_after.end()) continue;
    at = static_cast<size_t>(found - faces_after.begin()) + 1;
    ++kept;
  }
  size_t changed = 0;
  for (size_t t = 0; t < c.scene.meshes[0].triangles.size(); ++t)
    changed += c.scene.meshes[0].triangles[t] != c.opened.scene.meshes[0].triangles[t] ? 1 : 0;
  EXPECT_EQ(kept, faces.size() - changed);
  const formats::Scene again = formats::read("again.obj", c.opened.scene.bytes);
  ASSERT_EQ(again.meshes.size(), c.opened.scene.meshes.size());
  for (size_t m = 0; m < again.meshes.size(); ++m) {
    EXPECT_EQ(again.meshes[m].triangles.size(), c.opened.scene.meshes[m].triangles.size());
    EXPECT_EQ(again.meshes[m].positions.size(), c.opened.scene.meshes[m].positions.size());
  }
  // What was written opens as it is: nothing is closed any more.
  std::vector<Vec3> metres = again.meshes[0].positions;
  for (Vec3& p : metres)
    p *= 1e-3;
  EXPECT_TRUE(open({metres, again.meshes[0].triangles}, closed.landmarks).opened.parted.empty());
}

TEST(Openings, RejectsUnknownOptionValues) {
  openings::OpeningOptions options;
  options.add = {"ears"};
  EXPECT_THROW(openings::check(options), Error);
  options.add = {"teeth", "eyes"};
  EXPECT_NO_THROW(openings::check(options));
  options.open = "always";
  EXPECT_THROW(openings::check(options), Error);
}

}  // namespace
}  // namespace fascia::testing
