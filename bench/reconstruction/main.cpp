// How true skin put over a skull is.
//
//   bench_reconstruction [picture=FILE.png]
//
// ct: a real person's scanned bone, without its skin; the distance of the true skin from the one put over the
// bone, by region. ict: a round trip on people of a face model: the skull fitted under a head, and the head
// put over that skull again; what is left is what a skull and mean depths do not say of a face.

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <filesystem>

#include "anatomy/anatomy.h"
#include "builder/reconstruction/reconstruction.h"
#include "builder/skull/from_anatomy.h"
#include "builder/spatial/surface_query.h"
#include "tests/paths/paths.h"
#include "tests/skull/ct_head.h"
#include "tests/skull/ict_heads.h"
#include "view/renderer.h"

namespace fascia::bench {

namespace {

namespace fs = std::filesystem;
const fs::path measured = test::measured_data(), fixtures = test::data();

struct Error {
  int count = 0;
  double sum = 0.0, bias = 0.0;
  std::vector<double> all;
  void add(double off) {
    ++count;
    sum += std::abs(off);
    bias += off;
    all.push_back(std::abs(off));
  }
  void print(const std::string& name) {
    if (count == 0) return;
    std::sort(all.begin(), all.end());
    std::printf("  %-28s %5d places, mean %5.2f mm, outward %+5.2f, nine in ten below %5.2f\n", name.c_str(),
                count, 1e3 * sum / count, 1e3 * bias / count, 1e3 * all[all.size() * 9 / 10]);
  }
};

TriangleMesh skin_over(const anatomy::GenericAnatomy& anatomy, const reconstruction::Result& result,
                       const skull::BoneMap& map) {
  TriangleMesh skin = anatomy.head_object("skin")->mesh;
  skin.vertices = result.place(map, skin.vertices);
  return skin;
}

/// Distance of `point` from `surface`, positive where the surface stands out beyond the point.
double off(const spatial::SurfaceQuery& surface, const Vec3& point) {
  return -surface.closest(point).signed_distance;
}

void draw(const fs::path& path, const TriangleMesh& bone, const TriangleMesh& skin,
          const TriangleMesh& truth) {
  view::DrawList with_truth, over_bone;
  view::DrawSurface face;
  face.positions = skin.vertices;
  face.triangles = skin.triangles;
  face.colour = Vec3(0.86, 0.69, 0.59);
  view::DrawSurface scan;
  scan.positions = truth.vertices;
  scan.triangles = truth.triangles;
  scan.colour = Vec3(0.6, 0.75, 0.9);
  with_truth.surfaces = {scan};
  view::DrawSurface skull;
  skull.positions = bone.vertices;
  skull.triangles = bone.triangles;
  skull.colour = Vec3(0.92, 0.88, 0.78);
  face.opacity = 0.6;
  over_bone.surfaces = {skull, face};
  view::DrawList alone;
  face.opacity = 1.0;
  alone.surfaces = {face};
  const view::Renderer renderer(520, 520);
  std::vector<view::Tile> tiles;
  for (const char* name : {"front", "three-quarter", "side"})
    for (const auto* list : {&alone, &over_bone, &with_truth})
      tiles.push_back({renderer.draw(*list, view::named_camera(name, bounds(skin.vertices))), name});
  view::write_png(path, view::contact_sheet(tiles, 3));
}

void ct(const anatomy::GenericAnatomy& anatomy, const fs::path& picture) {
  if (!testing::has_ct_head(measured)) return;
  const testing::CtHead head = testing::read_ct_head(measured, fixtures / "ct_head_landmarks.json", anatomy);
  const std::clock_t begin = std::clock();
  reconstruction::Options options;
  options.metres = 1.0;
  const reconstruction::Result result = reconstruction::reconstruct(anatomy, head.bone, options);
  const double seconds = static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC;
  const TriangleMesh skin = skin_over(anatomy, result, result.mean);
  const spatial::SurfaceQuery surface(skin);
  std::map<std::string, Error> errors;
  for (const testing::DepthSample& sample : testing::depth_samples(head)) {
    const double d = off(surface, sample.skin);
    errors[sample.region].add(d);
    errors["all"].add(d);
  }
  std::printf(
      "CT: true skin from the skin put over the bone (%.1f s, bone within %.2f mm, %.0f %% covered)\n",
      seconds, 1e3 * result.bone_residual, 100 * result.covered_share);
  for (auto& [name, error] : errors)
    error.print(name);
  if (!picture.empty()) draw(picture, head.bone, skin, head.skin);
}

void ict(const anatomy::GenericAnatomy& anatomy, const char* name) {
  if (!testing::has_ict_head(measured, name)) return;
  const testing::IctHead head =
      testing::read_ict_head(measured, name, fixtures / "ict_neutral_landmarks.json", anatomy);
  const skull::Exterior outer = skull::exterior(head.head.skin);
  const skull::FitResult fit = skull::fit(skull::from_anatomy(anatomy), outer, head.targets);
  TriangleMesh bone;
  for (const TriangleMesh* part : {&fit.cranium, &fit.mandible, &fit.teeth_upper, &fit.teeth_lower}) {
    const int first = bone.vertex_count();
    bone.vertices.insert(bone.vertices.end(), part->vertices.begin(), part->vertices.end());
    for (const Triangle& t : part->triangles)
      bone.triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
  }
  const reconstruction::Result result = reconstruction::reconstruct(anatomy, bone);
  const spatial::SurfaceQuery surface(skin_over(anatomy, result, result.mean));
  Error error, landmarks;
  for (const skull::FittedLandmark& landmark : fit.landmarks)
    landmarks.add(off(surface, landmark.skin));
  const double chin = head.targets.at("menton").skin.y(), back = head.targets.at("tragion_left").skin.z();
  for (int t = 0; t < outer.surface.mesh().triangle_count(); t += 7) {
    const Vec3 p = position(outer.surface.mesh(), {t, Vec3::Constant(1.0 / 3)});
    if (p.y() > chin && p.z() > back) error.add(off(surface, p));
  }
  std::printf("%s: bone within %.2f mm\n", name, 1e3 * result.bone_residual);
  landmarks.print("landmarks over bone");
  error.print("face before the ears");
}

}  // namespace

}  // namespace fascia::bench

int main(int count, char** arguments) {
  try {
    const fascia::anatomy::GenericAnatomy anatomy = fascia::anatomy::load_generic();
    std::filesystem::path picture;
    for (int i = 1; i < count; ++i)
      if (const std::string word = arguments[i]; word.rfind("picture=", 0) == 0) picture = word.substr(8);
    fascia::bench::ct(anatomy, picture);
    for (const char* name : {"neutral", "person_0", "person_1", "person_2", "person_3"})
      fascia::bench::ict(anatomy, name);
    return 0;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
}
