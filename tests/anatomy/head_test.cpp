#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>

#include "tests/paths/paths.h"
#include "tools/anatomy/head/head.h"

// The generic head as it lies in anatomy/data: what the other rooms rely on.

namespace {

using fascia::Vec2;
using fascia::Vec3;

struct Mesh {
  std::vector<Vec3> vertices;
  std::vector<Vec2> uv;
  std::vector<std::vector<int>> faces, face_uv;  // counted from 0 within the object
  std::vector<std::string> group;
};

std::string data_file(const std::string& name) {
  return fascia::test::data().string() + "/../../anatomy/" + name;
}

std::map<std::string, Mesh> read_head() {
  std::map<std::string, Mesh> out;
  std::ifstream file(data_file("data/head.obj"));
  EXPECT_TRUE(file.good());
  Mesh* mesh = nullptr;
  std::string group;
  int vertices = 0, uv = 0, first_vertex = 1, first_uv = 1;
  for (std::string line; std::getline(file, line);) {
    std::istringstream words(line);
    std::string key;
    words >> key;
    if (key == "o") {
      std::string name;
      words >> name;
      mesh = &out[name];
      first_vertex = vertices + 1;
      first_uv = uv + 1;
    } else if (key == "v") {
      Vec3 p;
      words >> p.x() >> p.y() >> p.z();
      mesh->vertices.push_back(p);
      ++vertices;
    } else if (key == "vt") {
      Vec2 t;
      words >> t.x() >> t.y();
      mesh->uv.push_back(t);
      ++uv;
    } else if (key == "g") {
      words >> group;
    } else if (key == "f") {
      std::vector<int> face, chart;
      for (std::string corner; words >> corner;) {
        const auto slash = corner.find('/');
        face.push_back(std::stoi(corner.substr(0, slash)) - first_vertex);
        chart.push_back(std::stoi(corner.substr(slash + 1)) - first_uv);
      }
      mesh->faces.push_back(face);
      mesh->face_uv.push_back(chart);
      mesh->group.push_back(group);
    }
  }
  return out;
}

const std::map<std::string, Mesh>& head() {
  static const std::map<std::string, Mesh> meshes = read_head();
  return meshes;
}

const nlohmann::json& regions() {
  static const nlohmann::json json =
      nlohmann::json::parse(std::ifstream(data_file("data/head_regions.json"))).at("objects");
  return json;
}

std::map<std::pair<int, int>, int> directed_edges(const Mesh& mesh) {
  std::map<std::pair<int, int>, int> out;
  for (const auto& face : mesh.faces)
    for (std::size_t k = 0; k < face.size(); ++k)
      ++out[{face[k], face[(k + 1) % face.size()]}];
  return out;
}

std::map<int, int> boundary(const Mesh& mesh) {
  const auto edges = directed_edges(mesh);
  std::map<int, int> next;
  for (const auto& [edge, count] : edges)
    if (!edges.count({edge.second, edge.first})) next[edge.first] = edge.second;
  return next;
}

std::vector<int> loop(const std::string& name) {
  return regions().at("skin").at("loops").at(name).get<std::vector<int>>();
}

TEST(Head, HoldsSkinAndEyeballsWithinItsBudget) {
  int triangles = 0;
  for (const auto& [name, mesh] : head())
    for (const auto& face : mesh.faces)
      triangles += static_cast<int>(face.size()) - 2;
  EXPECT_EQ(head().size(), 3u);
  EXPECT_GE(triangles, 6000);
  EXPECT_LE(triangles, 12000);
}

TEST(Head, IsManifoldAndConsistentlyOriented) {
  for (const auto& [name, mesh] : head()) {
    for (const auto& [edge, count] : directed_edges(mesh))
      ASSERT_EQ(count, 1) << name << ' ' << edge.first << ' ' << edge.second;
    std::vector<int> corners(mesh.vertices.size(), 0);
    for (const auto& face : mesh.faces)
      for (int v : face)
        ++corners[v];
    for (std::size_t v = 0; v < corners.size(); ++v)
      EXPECT_GT(corners[v], 0) << name << " vertex " << v << " is in no face";
  }
}

TEST(Head, SkinIsADiscThatEndsAtTheNeckAndEyesAreClosed) {
  const Mesh& skin = head().at("skin");
  const auto next = boundary(skin);
  ASSERT_FALSE(next.empty());
  std::size_t length = 1;
  for (int v = next.at(next.begin()->first); v != next.begin()->first; v = next.at(v))
    ++length;
  EXPECT_EQ(length, next.size());
  for (const auto& [v, _] : next)
    EXPECT_LT(skin.vertices[v].y(), -85.0);
  const int edges = static_cast<int>((directed_edges(skin).size() + next.size()) / 2);
  EXPECT_EQ(static_cast<int>(skin.vertices.size()) - edges + static_cast<int>(skin.faces.size()), 1);
  EXPECT_TRUE(boundary(head().at("eye_left")).empty());
  EXPECT_TRUE(boundary(head().at("eye_right")).empty());
}

TEST(Head, FacesOutward) {
  for (const auto& [name, mesh] : head()) {
    double volume = 0.0;
    for (const auto& face : mesh.faces)
      for (std::size_t k = 1; k + 1 < face.size(); ++k)
        volume += mesh.vertices[face[0]].dot(mesh.vertices[face[k]].cross(mesh.vertices[face[k + 1]])) / 6.0;
    EXPECT_GT(volume, name == "skin" ? 1e6 : 1e3) << name;
  }
}

TEST(Head, IsExactlySymmetric) {
  std::set<std::array<double, 3>> skin;
  const Mesh& mesh = head().at("skin");
  for (const Vec3& p : mesh.vertices)
    skin.insert({p.x(), p.y(), p.z()});
  EXPECT_EQ(skin.size(), mesh.vertices.size());
  for (const Vec3& p : mesh.vertices)
    EXPECT_TRUE(skin.count({p.x() == 0.0 ? 0.0 : -p.x(), p.y(), p.z()})) << p.transpose();
}

TEST(Head, HasNoDegenerateFace) {
  for (const auto& [name, mesh] : head())
    for (std::size_t f = 0; f < mesh.faces.size(); ++f) {
      const auto& face = mesh.faces[f];
      Vec3 normal = Vec3::Zero();
      for (std::size_t k = 1; k + 1 < face.size(); ++k)
        normal += (mesh.vertices[face[k]] - mesh.vertices[face[0]])
                      .cross(mesh.vertices[face[k + 1]] - mesh.vertices[face[0]]);
      EXPECT_GT(normal.norm(), 1e-2) << name << " face " << f << " of " << mesh.group[f];
    }
}

// On the open skin, away from lips, lids, nostrils and ears, the surface is smooth: a face turned against its
// neighbour would be a fold.
TEST(Head, OuterSkinHasNoFold) {
  const Mesh& mesh = head().at("skin");
  const std::set<std::string> open = {"cheek", "chin", "forehead",  "temple",
                                      "scalp", "neck", "submental", "perioral"};
  const auto normal = [&](const std::vector<int>& f) {
    Vec3 n = Vec3::Zero();
    for (std::size_t k = 1; k + 1 < f.size(); ++k)
      n += (mesh.vertices[f[k]] - mesh.vertices[f[0]]).cross(mesh.vertices[f[k + 1]] - mesh.vertices[f[0]]);
    return Vec3(n.normalized());
  };
  std::map<std::pair<int, int>, int> face_of;
  for (std::size_t f = 0; f < mesh.faces.size(); ++f)
    for (std::size_t k = 0; k < mesh.faces[f].size(); ++k)
      face_of[{mesh.faces[f][k], mesh.faces[f][(k + 1) % mesh.faces[f].size()]}] = static_cast<int>(f);
  for (const auto& [edge, f] : face_of) {
    const auto other = face_of.find({edge.second, edge.first});
    if (other == face_of.end() || !open.count(mesh.group[f]) || !open.count(mesh.group[other->second]))
      continue;
    EXPECT_GT(normal(mesh.faces[f]).dot(normal(mesh.faces[other->second])), 0.3)
        << mesh.group[f] << " near " << mesh.vertices[edge.first].transpose();
  }
}

TEST(Head, TextureChartLiesInTheUnitSquareAndKeepsItsOrientation) {
  for (const auto& [name, mesh] : head()) {
    double covered = 0.0;
    for (const Vec2& t : mesh.uv) {
      EXPECT_GE(t.minCoeff(), 0.0);
      EXPECT_LE(t.maxCoeff(), 1.0);
    }
    for (std::size_t f = 0; f < mesh.faces.size(); ++f) {
      const auto& c = mesh.face_uv[f];
      double area = 0.0;
      for (std::size_t k = 1; k + 1 < c.size(); ++k) {
        const Vec2 a = mesh.uv[c[k]] - mesh.uv[c[0]], b = mesh.uv[c[k + 1]] - mesh.uv[c[0]];
        area += 0.5 * (a.x() * b.y() - a.y() * b.x());
      }
      EXPECT_GT(area, 0.0) << name << " face " << f << " of " << mesh.group[f];
      covered += area;
    }
    EXPECT_LT(covered, 1.0) << name;
    EXPECT_GT(covered, 0.5) << name;
  }
}

// Rasterised at 2048 x 2048, sample by sample: no texture point belongs to two faces.
TEST(Head, TextureChartDoesNotOverlap) {
  const Mesh& mesh = head().at("skin");
  constexpr int kSize = 2048;
  std::vector<int> owner(kSize * kSize, -1);
  int overlaps = 0;
  for (std::size_t f = 0; f < mesh.faces.size(); ++f) {
    const auto& c = mesh.face_uv[f];
    for (std::size_t k = 1; k + 1 < c.size(); ++k) {
      const Vec2 a = mesh.uv[c[0]] * kSize, b = mesh.uv[c[k]] * kSize, d = mesh.uv[c[k + 1]] * kSize;
      const double area = (b - a).x() * (d - a).y() - (b - a).y() * (d - a).x();
      const Vec2 low = a.cwiseMin(b).cwiseMin(d), high = a.cwiseMax(b).cwiseMax(d);
      for (int y = static_cast<int>(low.y()); y <= static_cast<int>(high.y()) && y < kSize; ++y)
        for (int x = static_cast<int>(low.x()); x <= static_cast<int>(high.x()) && x < kSize; ++x) {
          const Vec2 p(x + 0.5, y + 0.5);
          const auto side = [&](const Vec2& from, const Vec2& to) {
            return (to - from).x() * (p - from).y() - (to - from).y() * (p - from).x();
          };
          const double within = 1e-4 * std::abs(area) + 1e-3;
          if (side(a, b) < within || side(b, d) < within || side(d, a) < within) continue;
          int& own = owner[y * kSize + x];
          if (own >= 0 && own != static_cast<int>(f)) ++overlaps;
          own = static_cast<int>(f);
        }
    }
  }
  EXPECT_EQ(overlaps, 0);
}

TEST(Head, RegionsNameRangesOfFacesAndTheirMirrorImages) {
  for (const auto& [name, mesh] : head()) {
    std::size_t total = 0;
    for (const auto& [region, range] : regions().at(name).at("faces").items()) {
      const int first = range.at("first"), count = range.at("count");
      ASSERT_LE(static_cast<std::size_t>(first + count), mesh.faces.size());
      for (int f = first; f < first + count; ++f)
        EXPECT_EQ(mesh.group[f], region);
      total += count;
    }
    EXPECT_EQ(total, mesh.faces.size()) << name;
  }
  const auto& skin = regions().at("skin").at("faces");
  for (const char* region : {"lid_upper_left", "lid_lower_left", "lip_upper", "lip_lower", "mouth_lining",
                             "nostril_left", "ear_left", "conjunctiva_left", "neck", "scalp", "nose", "cheek",
                             "chin", "forehead", "temple", "perioral"}) {
    ASSERT_TRUE(skin.contains(region)) << region;
    std::string other = region;
    if (other.ends_with("_left")) other.replace(other.size() - 4, 4, "right");
    EXPECT_EQ(skin.at(region).at("count"), skin.at(other).at("count")) << region;
  }
  for (const char* region : {"iris", "pupil", "sclera"})
    EXPECT_TRUE(regions().at("eye_left").at("faces").contains(region));
}

TEST(Head, LoopsAreClosedWaysAlongEdges) {
  const Mesh& skin = head().at("skin");
  const auto edges = directed_edges(skin);
  for (const char* name : {"lip_contact", "vermilion_border", "lid_margin_left", "lid_margin_right",
                           "lid_margin_inner_left", "nostril_rim_left", "helix_left", "neck_end"}) {
    const auto way = loop(name);
    ASSERT_GT(way.size(), 8u) << name;
    for (std::size_t k = 0; k < way.size(); ++k) {
      const std::pair<int, int> step(way[k], way[(k + 1) % way.size()]);
      EXPECT_TRUE(edges.count(step) || edges.count({step.second, step.first})) << name << " step " << k;
    }
  }
}

TEST(Head, LipsPartAlongTheirContactLine) {
  const Mesh& skin = head().at("skin");
  const auto way = loop("lip_contact");
  // Upper midline to the left corner to the lower midline and back on the right.
  const std::size_t n = way.size(), corner = n / 4;
  EXPECT_NEAR(skin.vertices[way[0]].x(), 0.0, 1e-9);
  EXPECT_NEAR(skin.vertices[way[n / 2]].x(), 0.0, 1e-9);
  EXPECT_NEAR(skin.vertices[way[corner]].x(), 22.0, 2.5);
  for (std::size_t k = 0; k < corner; ++k) {
    const Vec3 &upper = skin.vertices[way[k]], &lower = skin.vertices[way[n / 2 - k]];
    EXPECT_GT(upper.y(), lower.y()) << k;
    EXPECT_LT(upper.y() - lower.y(), 2.0) << "the neutral mouth is closed";
  }
}

TEST(Head, EyesAreOpenAboutTenMillimetres) {
  const Mesh& skin = head().at("skin");
  const auto way = loop("lid_margin_left");
  double low = 1e9, high = -1e9, medial = 1e9, lateral = -1e9;
  for (int v : way) {
    const Vec3& p = skin.vertices[v];
    if (std::abs(p.x() - 32.0) < 4.0) {
      low = std::min(low, p.y());
      high = std::max(high, p.y());
    }
    medial = std::min(medial, p.x());
    lateral = std::max(lateral, p.x());
  }
  EXPECT_NEAR(high - low, 11.0, 2.0);
  EXPECT_NEAR(lateral - medial, 27.0, 3.0);
}

// The lid margin has a thickness, and nothing of the lids reaches into the eyeball.
TEST(Head, LidsRestOnTheEyeball) {
  const Mesh& skin = head().at("skin");
  const Mesh& eye = head().at("eye_left");
  Vec3 centre = Vec3::Zero();
  double radius = 0.0;
  fascia::Bounds box = fascia::bounds(eye.vertices);
  centre = Vec3(box.centre().x(), box.centre().y(), 0.0);
  radius = 0.5 * box.size().x();
  centre.z() = box.lower.z() + radius;
  const auto outer = loop("lid_margin_left"), inner = loop("lid_margin_inner_left");
  for (std::size_t k = 0; k < outer.size(); ++k) {
    EXPECT_GT((skin.vertices[outer[k]] - skin.vertices[inner[k]]).norm(), 0.8);
    const double height = (skin.vertices[inner[k]] - centre).norm() - radius;
    EXPECT_GT(height, -0.4) << k;
    EXPECT_LT(height, 5.0) << k;
  }
}

TEST(Head, ConjunctivalSacHoldsTheEyeball) {
  const Mesh& skin = head().at("skin");
  const fascia::Bounds box = fascia::bounds(head().at("eye_left").vertices);
  const double radius = 0.5 * box.size().x();
  const Vec3 centre(box.centre().x(), box.centre().y(), box.lower.z() + radius);
  int behind = 0;
  for (std::size_t f = 0; f < skin.faces.size(); ++f) {
    if (skin.group[f] != "conjunctiva_left") continue;
    Vec3 middle = Vec3::Zero();
    for (int v : skin.faces[f])
      middle += skin.vertices[v] / static_cast<double>(skin.faces[f].size());
    if (middle.z() > centre.z()) continue;
    ++behind;
    EXPECT_GT((middle - centre).norm(), radius) << f;
  }
  EXPECT_GT(behind, 50);
}

TEST(Head, MouthLiningEnclosesTheTeeth) {
  const Mesh& skin = head().at("skin");
  fascia::Bounds box;
  for (std::size_t f = 0; f < skin.faces.size(); ++f)
    if (skin.group[f] == "mouth_lining")
      for (int v : skin.faces[f]) {
        box.lower = box.lower.cwiseMin(skin.vertices[v]);
        box.upper = box.upper.cwiseMax(skin.vertices[v]);
      }
  std::ifstream file(data_file("figures/head_figures.json"));
  const auto teeth = nlohmann::json::parse(file).at("teeth");
  // The measured incisors' roots reach higher and lower than the crowns that stand in the mouth.
  EXPECT_LT(box.lower.x(), teeth.at("lower")[0].get<double>());
  EXPECT_GT(box.upper.x(), teeth.at("upper")[0].get<double>());
  EXPECT_LT(box.lower.y(), -50.0);
  EXPECT_GT(box.upper.y(), -15.0);
  EXPECT_LT(box.lower.z(), teeth.at("lower")[2].get<double>());
}

TEST(Head, IsWhatItsToolMakesOfTheFigures) {
  using namespace fascia::head_maker;
  const Figures figures = read_figures(data_file("figures"));
  const HalfHead half = make_half(figures);
  const PolygonMesh made = mirrored(half, unwrap(half));
  const Mesh& stored = head().at("skin");
  ASSERT_EQ(made.vertices.size(), stored.vertices.size());
  ASSERT_EQ(made.faces.size(), stored.faces.size());
  for (std::size_t v = 0; v < made.vertices.size(); ++v)
    ASSERT_LT((made.vertices[v] - stored.vertices[v]).norm(), 1e-3)
        << "run make_head anatomy/figures anatomy/data";
}

}  // namespace
