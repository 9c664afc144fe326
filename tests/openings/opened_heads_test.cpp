// A head whose lips were stitched together and parted again moves like the one that was never closed.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>

#include "builder/rigging/build_rig.h"
#include "builder/rigging/gltf_source.h"
#include "cli/posing.h"
#include "rig/write/write.h"
#include "tests/openings/closed_head.h"

namespace fascia::testing {
namespace {

namespace fs = std::filesystem;

/// A rig of a mesh, and a face of it.
struct Built {
  rigging::BuildReport report;
  fs::path path;
  std::unique_ptr<cli::Face> face;
  size_t vertices = 0;  ///< of the skin in the input
};

Built build(const TriangleMesh& skin, const Landmarks& landmarks, const std::string& name) {
  Built built;
  const std::string text = obj_text(skin);
  const formats::Scene scene = formats::read(name + ".obj", {text.begin(), text.end()});
  formats::LandmarkFile file;
  file.units = "mm";
  for (const auto& [landmark, p] : landmarks)
    file.points[landmark] = 1e3 * p;
  rigging::BuildOptions options;
  options.detail = "low";
  rigging::BuildResult result = rigging::build_rig(scene, file, anatomy::load_generic(), options);
  const auto bytes = rig::write(
      rigging::gltf_source(result.opened.value_or(scene), result.report.input_to_metres), result.rig);
  built.report = std::move(result.report);
  built.path = fs::temp_directory_path() / ("fascia_opened_" + name + ".glb");
  formats::write_bytes(built.path, bytes.data(), bytes.size());
  built.face = std::make_unique<cli::Face>(built.path, cli::Face::Options{FASCIA_SPACE_METRES, "own", ""});
  return built;
}

/// Where each vertex of `skin` is in the mesh the rig was made from, by place: OBJ vertices come in the order
/// of the faces.
std::vector<size_t> find_vertices(const cli::Face& face, const TriangleMesh& skin) {
  const auto rest = face.rest(0);
  std::map<std::array<long, 3>, size_t> at;
  const auto key = [](double x, double y, double z) {
    return std::array<long, 3>{std::lround(2e5 * x), std::lround(2e5 * y), std::lround(2e5 * z)};
  };
  for (size_t i = 0; i + 2 < rest.size(); i += 3)
    at.try_emplace(key(rest[i], rest[i + 1], rest[i + 2]), i / 3);
  std::vector<size_t> found;
  for (const Vec3& p : skin.vertices) {
    size_t best = rest.size();
    for (long x = -1; x <= 1; ++x)
      for (long y = -1; y <= 1; ++y)
        for (long z = -1; z <= 1; ++z) {
          auto k = key(p[0], p[1], p[2]);
          const auto hit = at.find({k[0] + x, k[1] + y, k[2] + z});
          if (hit != at.end()) best = std::min(best, hit->second);
        }
    found.push_back(best);
  }
  return found;
}

Vec3 motion(const cli::Face& face, size_t vertex) {
  const auto now = face.positions(0), rest = face.rest(0);
  return 1e3 * Vec3(now[3 * vertex] - rest[3 * vertex], now[3 * vertex + 1] - rest[3 * vertex + 1],
                    now[3 * vertex + 2] - rest[3 * vertex + 2]);
}

TEST(OpenedHeads, MoveLikeHeadsThatWereOpen) {
  const anatomy::GenericAnatomy anatomy = anatomy::load_generic();
  const TriangleMesh& open = anatomy.head_object("skin")->mesh;
  const ClosedHead closed = closed_head(anatomy, false);
  Built whole = build(open, closed.landmarks, "open"),
        stitched = build(closed.skin, closed.landmarks, "closed");
  EXPECT_TRUE(whole.report.parted.empty());
  ASSERT_EQ(stitched.report.parted.size(), 1U);
  const std::vector<size_t> in_whole = find_vertices(*whole.face, open),
                            in_stitched = find_vertices(*stitched.face, closed.skin);
  for (const char* pose : {"arkit:jawOpen", "arkit:mouthSmileLeft", "arkit:mouthPucker"}) {
    for (Built* built : {&whole, &stitched}) {
      built->face->clear();
      built->face->reset();
      built->face->set(pose, 1.0);
      built->face->pose();
    }
    double sum = 0.0, moved = 0.0, largest = 0.0;
    int count = 0;
    for (size_t v = 0; v < open.vertices.size(); ++v) {
      const int other = closed.of_generic[v];
      if (other < 0 || in_whole[v] >= whole.face->rest(0).size() / 3 ||
          in_stitched[static_cast<size_t>(other)] >= stitched.face->rest(0).size() / 3)
        continue;
      // The stitches themselves lie elsewhere than the lips did.
      if ((closed.skin.vertices[static_cast<size_t>(other)] - open.vertices[v]).norm() > 1e-6) continue;
      const Vec3 a = motion(*whole.face, in_whole[v]),
                 b = motion(*stitched.face, in_stitched[static_cast<size_t>(other)]);
      if (a.norm() < 0.5) continue;
      sum += (a - b).norm();
      moved += a.norm();
      largest = std::max(largest, (a - b).norm());
      ++count;
    }
    ASSERT_GT(count, 50) << pose;
    std::printf("%s: %d vertices move %.2f mm, differ by %.2f mm in the mean, %.2f at most\n", pose, count,
                moved / count, sum / count, largest);
    EXPECT_LT(sum, 0.12 * moved) << pose;
  }
  for (Built* built : {&whole, &stitched})
    fs::remove(built->path);
}

TEST(OpenedHeads, OpenMouthAndEyes) {
  const anatomy::GenericAnatomy anatomy = anatomy::load_generic();
  const ClosedHead closed = closed_head(anatomy);
  Built built = build(closed.skin, closed.landmarks, "lids");
  ASSERT_EQ(built.report.parted.size(), 3U);
  EXPECT_EQ(built.report.added,
            (std::vector<std::string>{"eye_left", "eye_right", "teeth_upper", "teeth_lower"}));
  cli::Face& face = *built.face;
  // Places along the upper and the lower edge: appended vertices that touch at rest and part in the pose.
  const auto gap_after = [&](const std::vector<std::pair<std::string, double>>& values, const Vec3& near) {
    face.clear();
    face.reset();
    for (const auto& [name, value] : values)
      face.set(name, value);
    face.pose();
    const auto rest = face.rest(0), now = face.positions(0);
    double widest = 0.0;
    std::vector<size_t> beside;
    for (size_t i = 0; i + 2 < rest.size(); i += 3)
      if ((Vec3(rest[i], rest[i + 1], rest[i + 2]) - near).norm() < 0.02) beside.push_back(i);
    for (const size_t a : beside)
      for (const size_t b : beside)
        if ((Vec3(rest[a], rest[a + 1], rest[a + 2]) - Vec3(rest[b], rest[b + 1], rest[b + 2])).norm() < 3e-5)
          widest = std::max(widest, 1e3 * static_cast<double>(now[a + 1] - now[b + 1]));
    return widest;
  };
  const Vec3 mouth = closed.landmarks.at("stomion");
  const Vec3 eye = 0.5 * (closed.landmarks.at("endocanthion_left") + closed.landmarks.at("exocanthion_left"));
  EXPECT_LT(gap_after({}, mouth), 0.05);
  EXPECT_GT(gap_after({{"arkit:jawOpen", 1.0}}, mouth), 12.0);
  EXPECT_LT(gap_after({}, eye), 0.05);
  EXPECT_GT(gap_after({{"arkit:eyeWideLeft", 1.0}}, eye), 3.0);
  EXPECT_LT(gap_after({{"arkit:eyeBlinkLeft", 1.0}}, eye), 0.5);
  fs::remove(built.path);
}

}  // namespace
}  // namespace fascia::testing
