// A head with eyes, teeth, tongue, lashes, brows and hair at all three levels of detail: what follows what,
// and that the levels agree.
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <numeric>
#include <queue>

#include "builder/spatial/surface_query.h"
#include "geometry/error.h"
#include "tests/builder/dressed_head.h"
#include "tests/builder/posed_face.h"

namespace fascia::testing {
namespace {

namespace fs = std::filesystem;

class DressedHead : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    const fs::path folder = fs::temp_directory_path() / "fascia_dressed_head";
    fs::create_directories(folder);
    write_dressed_head(folder / "head.obj", folder / "landmarks.json");
    face_ = new PosedFace(folder / "head.obj", folder / "landmarks.json", "test_dressed", "high");
    fs::remove_all(folder);
  }
  static void TearDownTestSuite() { delete face_; }
  static PosedFace* face_;

  static size_t mesh(const std::string& name) {
    const auto& meshes = face_->face().meshes();
    for (size_t m = 0; m < meshes.size(); ++m)
      if (meshes[m].name == name) return m;
    std::string names;
    for (const auto& mesh : meshes)
      names += " " + mesh.name;
    ADD_FAILURE() << "no mesh " << name << " among" << names;
    return 0;
  }
  static const rig::Binding& binding(size_t mesh, size_t level = 0) {
    for (const rig::Binding& b : face_->rig().tissue.bindings[level])
      if (b.mesh == face_->face().meshes()[mesh].mesh &&
          b.primitive == face_->face().meshes()[mesh].primitive)
        return b;
    throw Error("a mesh is not bound");
  }
  /// Motion of every vertex of a mesh in millimetres.
  static std::vector<Vec3> moved(cli::Face& face, size_t mesh) {
    std::vector<Vec3> out;
    const auto now = face.positions(mesh), rest = face.rest(mesh);
    for (size_t i = 0; i + 2 < now.size(); i += 3)
      out.push_back(1e3 * Vec3(now[i] - rest[i], now[i + 1] - rest[i + 1], now[i + 2] - rest[i + 2]));
    return out;
  }
  /// The meshes that make up the skin: the head's groups, one by one.
  static std::vector<size_t> skins() {
    std::vector<size_t> out;
    for (size_t m = 0; m < face_->face().meshes().size(); ++m)
      if (face_->face().meshes()[m].part == "skin") out.push_back(m);
    return out;
  }
  static std::vector<Vec3> skin_moved(cli::Face& face) {
    std::vector<Vec3> all;
    for (const size_t m : skins()) {
      const std::vector<Vec3> more = moved(face, m);
      all.insert(all.end(), more.begin(), more.end());
    }
    return all;
  }
  static Vec3 rest(size_t mesh, size_t vertex) {
    const auto flat = face_->face().rest(mesh);
    return {flat[3 * vertex], flat[3 * vertex + 1], flat[3 * vertex + 2]};
  }
};

PosedFace* DressedHead::face_ = nullptr;

bool is_still(const rig::Binding& b, size_t vertex) {
  float sum = b.jaw_weights[vertex] + static_cast<float>(b.eye[vertex]);
  for (size_t k = 0; k < b.influences; ++k)
    sum += b.weights[vertex * b.influences + k];
  return sum == 0.0F;
}

TEST_F(DressedHead, EyesTeethAndTongueFollowTheirBones) {
  const std::map<std::string, std::pair<float, uint8_t>> wanted = {{"eye_left", {0.0F, 1}},
                                                                   {"eye_right", {0.0F, 2}},
                                                                   {"teeth_upper", {0.0F, 0}},
                                                                   {"teeth_lower", {1.0F, 0}},
                                                                   {"tongue", {1.0F, 0}}};
  for (const auto& [name, bone] : wanted) {
    const rig::Binding& b = binding(mesh(name));
    for (size_t v = 0; v < b.vertex_count; ++v) {
      EXPECT_EQ(b.jaw_weights[v], bone.first) << name;
      EXPECT_EQ(b.eye[v], bone.second) << name;
      for (size_t k = 0; k < b.influences; ++k)
        EXPECT_EQ(b.weights[v * b.influences + k], 0.0F) << name;
    }
  }
}

TEST_F(DressedHead, LashesBrowsAndHairGoWithTheSkinAtTheirRoots) {
  cli::Face face(face_->rig_path(), {FASCIA_SPACE_METRES, "own", "low"});
  for (const char* shape :
       {"arkit:eyeBlinkLeft", "arkit:browInnerUp", "arkit:browOuterUpLeft", "arkit:mouthPucker"})
    face.set(shape, 1.0);
  face.pose();
  const size_t lashes = mesh("lashes");
  const auto skin_at = [&](const Vec3& p) {
    double nearest = 1e9;
    Vec3 motion = Vec3::Zero();
    for (const size_t m : skins()) {
      TriangleMesh surface;
      for (size_t v = 0; 3 * v < face.rest(m).size(); ++v)
        surface.vertices.push_back(rest(m, v));
      surface.triangles = face.meshes()[m].triangles;
      const spatial::ClosestPoint hit = spatial::SurfaceQuery(surface).closest(p);
      if (hit.distance >= nearest) continue;
      nearest = hit.distance;
      surface.vertices = moved(face, m);
      motion = position(surface, hit.surface);
    }
    return motion;
  };
  const std::vector<Vec3> lash = moved(face, lashes);
  EXPECT_LT(skin_at(rest(lashes, 0)).y(), -1.0) << "the lid closes";
  for (size_t card = 0; card < 3; ++card)
    for (size_t v = 0; v < 6; ++v) {
      EXPECT_LT((lash[6 * card + v] - skin_at(rest(lashes, 6 * card))).norm(), 2.0) << "card " << card;
      EXPECT_LT((lash[6 * card + v] - lash[6 * card]).norm(), 1e-3) << "a card goes as one";
    }
  for (size_t v = 18; v + 1 < lash.size(); v += 2)
    EXPECT_LT((lash[v] - lash[v + 1]).norm(), 1.0)
        << "a strip's tip goes with its root, not with the skin behind it";
  const std::vector<Vec3> brow = moved(face, mesh("brows"));
  for (size_t v = 0; v < brow.size(); ++v)
    EXPECT_LT((brow[v] - skin_at(rest(mesh("brows"), v))).norm(), 1.8)
        << "of some 6 mm, from up to 3 mm before the skin";
  EXPECT_GT(brow[2].y(), 1.0);
  for (const Vec3& hair : moved(face, mesh("hair")))
    EXPECT_EQ(hair.norm(), 0.0) << "the crown stays";
  const std::vector<Vec3> moustache = moved(face, mesh("moustache"));
  EXPECT_GT(moustache[0].norm(), 1.0);
  for (const Vec3& strand : moustache)
    EXPECT_LT((strand - moustache[0]).norm(), 1e-3) << "a strand goes as one";
}

TEST_F(DressedHead, NeckCrownAndBackStayWhereTheyAre) {
  Landmarks landmark;
  for (const rig::Landmark& l : face_->rig().skull.landmarks)
    landmark[l.name] = l.skin.cast<double>();
  const double third = landmark["glabella"].y() - landmark["subnasale"].y();
  double lowest = 1e9;
  for (const size_t skin : skins())
    for (size_t v = 0; 3 * v < face_->face().rest(skin).size(); ++v)
      lowest = std::min(lowest, rest(skin, v).y());
  cli::Face face(face_->rig_path(), {FASCIA_SPACE_METRES, "own", "low"});
  for (const char* name :
       {"jaw_open", "arkit:mouthStretchLeft", "arkit:mouthStretchRight", "arkit:browInnerUp"})
    face.set(name, 1.0);
  face.pose();
  int below = 0, above = 0, behind = 0;
  for (const size_t skin : skins()) {
    const std::vector<Vec3> motion = moved(face, skin);
    for (size_t v = 0; v < motion.size(); ++v) {
      const Vec3 p = rest(skin, v);
      const bool neck = p.y()<lowest + 0.004, crown = p.y()> landmark["trichion"].y() + 0.15 * third;
      const bool back = p.z() < landmark["tragion_left"].z() - 0.15 * third;
      below += neck;
      above += crown;
      behind += back;
      EXPECT_TRUE(!(neck || crown || back) || motion[v].norm() < 1e-3)
          << p.transpose() << " moves " << motion[v].transpose() << " mm";
      for (size_t level = 0; level < 3; ++level)
        EXPECT_TRUE(!(crown || back) || is_still(binding(skin, level), v)) << p.transpose();
    }
  }
  EXPECT_GT(below, 10);
  EXPECT_GT(above, 50);
  EXPECT_GT(behind, 200);
}

/// Steps from triangle corner to corner between two columns of a level, along its surface; never more than
/// `most` + 1.
int steps_between(const std::vector<std::vector<uint32_t>>& next, uint32_t from, uint32_t to, int most) {
  std::map<uint32_t, int> steps = {{from, 0}};
  std::queue<uint32_t> open({from});
  while (!open.empty()) {
    const uint32_t at = open.front();
    open.pop();
    if (at == to) return steps[at];
    if (steps[at] == most) continue;
    for (const uint32_t n : next[at])
      if (steps.emplace(n, steps[at] + 1).second) open.push(n);
  }
  return most + 1;
}

TEST_F(DressedHead, LipsLidsAndNostrilsAreNeverBoundAcross) {
  // Neighbours on the skin follow neighbours on the lattice: whoever would follow the other lip, lid or wall
  // of a nostril would jump.
  for (size_t level = 0; level < 3; ++level) {
    const rig::TissueLevel& lattice = face_->rig().tissue.levels[level];
    std::vector<std::vector<uint32_t>> next(lattice.columns);
    std::vector<double> edge(lattice.columns, 0.0);
    for (const auto& t : lattice.triangles)
      for (size_t e = 0; e < 3; ++e) {
        next[t[e]].push_back(t[(e + 1) % 3]);
        next[t[e]].push_back(t[(e + 2) % 3]);
        edge[t[e]] = std::max(
            edge[t[e]], static_cast<double>((lattice.rest[t[e]] - lattice.rest[t[(e + 1) % 3]]).norm()));
      }
    int checked = 0, wide = 0, jumps = 0;
    for (const size_t skin : skins()) {
      const rig::Binding& b = binding(skin, level);
      // The column each vertex follows most; none where it stays, or follows what lies behind it too, as deep
      // in the mouth.
      constexpr uint32_t none = 0xffffffff;
      std::vector<uint32_t> column(b.vertex_count, none);
      for (size_t v = 0; v < b.vertex_count; ++v) {
        float sum = 0.0F, most = 0.0F;
        bool near = true;
        for (size_t k = 0; k < b.influences; ++k) {
          const float w = b.weights[v * b.influences + k];
          const uint32_t node = b.nodes[v * b.influences + k];
          sum += w;
          if (w > 0.02F)
            near = near && (lattice.rest[node].cast<double>() - rest(skin, v)).norm() < 2.5 * edge[node];
          if (w <= most) continue;
          most = w;
          column[v] = node;
        }
        if (sum < 0.98F || !near) column[v] = none;
        if (column[v] == none) continue;
        ++checked;
        const int about = std::max(
            6, static_cast<int>(0.006 / edge[column[v]]));  // millimetres; round a lip's corner it is 25
        for (size_t k = 0; k < b.influences; ++k)
          if (b.weights[v * b.influences + k] > 0.02F &&
              steps_between(next, column[v], b.nodes[v * b.influences + k], about) > about)
            ++wide;
      }
      for (const Triangle& t : face_->face().meshes()[skin].triangles)
        for (size_t e = 0; e < 3; ++e) {
          const uint32_t a = column[static_cast<size_t>(t[e])],
                         c = column[static_cast<size_t>(t[(e + 1) % 3])];
          if (a == none || c == none) continue;
          const double length =
              (rest(skin, static_cast<size_t>(t[e])) - rest(skin, static_cast<size_t>(t[(e + 1) % 3])))
                  .norm();
          const int most = 4 + static_cast<int>(2.0 * length / std::max(1e-4, std::min(edge[a], edge[c])));
          if (steps_between(next, a, c, most) > most) ++jumps;
        }
    }
    EXPECT_GT(checked, 2000);
    EXPECT_EQ(wide, 0) << "vertices that follow columns far apart along the surface, level " << lattice.name;
    EXPECT_EQ(jumps, 0) << "level " << lattice.name;
  }
}

/// Mean and 95th percentile of how far two levels' poses lie apart where either moves by half a millimetre.
std::pair<double, double> apart(const std::vector<Vec3>& a, const std::vector<Vec3>& b) {
  std::vector<double> gaps;
  for (size_t v = 0; v < a.size(); ++v)
    if (std::max(a[v].norm(), b[v].norm()) > 0.5) gaps.push_back((a[v] - b[v]).norm());
  if (gaps.empty()) return {0.0, 0.0};
  std::sort(gaps.begin(), gaps.end());
  return {std::accumulate(gaps.begin(), gaps.end(), 0.0) / static_cast<double>(gaps.size()),
          gaps[gaps.size() * 95 / 100]};
}

TEST_F(DressedHead, LevelsOfDetailGiveTheSamePoses) {
  std::vector<std::unique_ptr<cli::Face>> faces;
  for (const char* level : {"low", "medium", "high"})
    faces.push_back(std::make_unique<cli::Face>(face_->rig_path(),
                                                cli::Face::Options{FASCIA_SPACE_METRES, "own", level}));
  for (const char* shape : {"arkit:browInnerUp", "arkit:noseSneerLeft"}) {
    std::vector<std::vector<Vec3>> motion;
    for (const auto& face : faces) {
      face->clear();
      face->set(shape, 1.0);
      face->pose();
      motion.push_back(skin_moved(*face));
    }
    double largest = 0.0;
    for (const Vec3& m : motion[1])
      largest = std::max(largest, m.norm());
    EXPECT_GT(largest, 3.0) << shape;
    const auto [mean, most] = apart(motion[1], motion[2]);
    EXPECT_LT(mean, 0.5) << shape;
    EXPECT_LT(most, 1.5) << shape;
    const auto [low_mean, low_most] = apart(motion[0], motion[1]);  // may differ more at lids and lips
    EXPECT_LT(low_mean, 0.7) << shape;
    EXPECT_LT(low_most, 2.0) << shape;
  }
}

}  // namespace
}  // namespace fascia::testing
