// How true a fitted skull is, and how quickly it follows.
//
//   bench_skull [picture=FILE.png] [truth] [curves] [leave-one-out] [noise] [ict] [update]      (all of them
//   without arguments)
//
// truth: depth of bone under the skin of a real person (CT), fitted against scanned, by region and by what
// was given. A table of mean depths has a standard error of 3.7 mm on one person (Stephan), a bound for any
// single landmark. leave-one-out: every placed landmark in turn is left out, and looked for where the fit
// without it puts its depth and bone. noise: placed landmarks moved along the skin. ict: people without
// scanned bone, against the table. update: processor time of one moved landmark.

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <functional>
#include <random>
#include <set>

#include "anatomy/anatomy.h"
#include "builder/skull/fitter.h"
#include "builder/skull/from_anatomy.h"
#include "builder/spatial/surface_query.h"
#include "tests/paths/paths.h"
#include "tests/skull/ct_head.h"
#include "tests/skull/ict_heads.h"
#include "view/renderer.h"

namespace fascia::bench {

namespace {

namespace fs = std::filesystem;
using Targets = std::map<std::string, skull::TargetLandmark>;

const fs::path measured = test::measured_data(), fixtures = test::data();

struct Bench {
  anatomy::GenericAnatomy anatomy = anatomy::load_generic();
  skull::Generic generic = skull::from_anatomy(anatomy);
  testing::CtHead head = testing::read_ct_head(measured, fixtures / "ct_head_landmarks.json", anatomy);
  skull::Exterior skin = skull::exterior(head.skin);
  std::vector<testing::DepthSample> samples = testing::depth_samples(head);

  Targets placed() const {
    Targets out;
    for (const auto& [name, p] : head.given)
      out[name] = {p, 1};
    return out;
  }
  Targets required() const {
    Targets out;
    for (const auto& [name, p] : head.given)
      if (const anatomy::Landmark* known = anatomy.landmark(name); known && known->required)
        out[name] = {p, 1};
    return out;
  }
  Targets completed(const Targets& from) const {
    Landmarks points;
    for (const auto& [name, landmark] : from)
      points[name] = landmark.skin;
    return testing::complete_targets(head.skin, points, anatomy);
  }
};

double processor_ms() {
  return 1e3 * static_cast<double>(std::clock()) / CLOCKS_PER_SEC;
}

void print_errors(const std::map<std::string, testing::DepthError>& errors) {
  for (const auto& [region, error] : errors)
    std::printf("  %-28s %5d samples, %4d missed, mean %5.2f mm, bias %+5.2f, nine in ten below %5.2f\n",
                region.c_str(), error.samples, error.missed, 1e3 * error.mean, 1e3 * error.bias,
                1e3 * error.ninth_decile);
}

void truth(const Bench& bench) {
  const Targets required = bench.required(), placed = bench.placed();
  const std::pair<const char*, Targets> sets[] = {
      {"required landmarks alone", required},
      {"required, the others carried over", bench.completed(required)},
      {"all placed landmarks", placed},
      {"all placed, the others carried over", bench.completed(placed)}};
  for (const auto& [title, targets] : sets) {
    const skull::FitResult fit = skull::fit(bench.generic, bench.skin, targets);
    std::printf("CT truth, %s (%zu): landmarks %.2f mm rms, %d vertices outside the skin\n", title,
                targets.size(), 1e3 * fit.landmark_rms, fit.bone_outside_skin);
    print_errors(testing::depth_errors(bench.samples, fit));
  }
}

void curves(const Bench& bench) {
  const auto show = [&](const char* title, const skull::FitOptions& options) {
    const auto errors = testing::depth_errors(
        bench.samples, skull::fit(bench.generic, bench.skin, bench.head.targets, options));
    std::printf("  %-50s mean %5.2f mm, bias %+5.2f\n", title, 1e3 * errors.at("all").mean,
                1e3 * errors.at("all").bias);
  };
  std::printf("CT truth by option\n");
  skull::FitOptions options;
  show("default", options);
  options.curve_spacing = 0;
  show("without semilandmarks", options);
  options = {};
  options.exponent = 3;
  options.smoothing = 2.5;
  show("kernel exponent 3", options);
  options.normal_deviation = 0.2;
  show("kernel exponent 3, normals as derivative data", options);
  options = {};
  options.skin_normal_share = 0;
  show("depth along the generic's direction", options);
  options.skin_normal_share = 1;
  show("depth along the skin's normal", options);
  options = {};
  for (double scale : {0.8, 0.9, 1.1}) {
    options.tissue_scale = scale;
    show(("tissue scale " + std::to_string(scale).substr(0, 3)).c_str(), options);
  }
}

void leave_one_out(const Bench& bench) {
  const Targets placed = bench.placed();
  const skull::FitResult whole = skull::fit(bench.generic, bench.skin, placed);
  double sum = 0;
  int count = 0;
  std::printf("leave one landmark out: how far its bone point and its depth move\n");
  for (const skull::FittedLandmark& landmark : whole.landmarks) {
    Targets rest = placed;
    rest.erase(landmark.name);
    const skull::FitResult fit = skull::fit(bench.generic, bench.skin, rest);
    Vec3 bone = Vec3::Zero();
    for (const skull::GenericLandmark& known : bench.generic.landmarks)
      if (known.name == landmark.name) bone = fit.bone_map(known.bone);
    const double moved = (bone - landmark.bone).norm();
    sum += moved;
    ++count;
    std::printf("  %-28s %5.2f mm, depth %+5.2f mm\n", landmark.name.c_str(), 1e3 * moved,
                1e3 * ((landmark.skin - bone).dot(landmark.direction) - landmark.table_depth));
  }
  std::printf("  mean of %d: %.2f mm\n", count, 1e3 * sum / count);
}

void noise(const Bench& bench) {
  const Targets placed = bench.placed();
  const skull::FitResult whole = skull::fit(bench.generic, bench.skin, placed);
  std::printf("landmarks moved along the skin, normal deviation in each direction (8 trials each)\n");
  for (double deviation : {0.001, 0.002, 0.003}) {
    std::mt19937 random(7);
    std::normal_distribution<double> step(0, deviation);
    double moved = 0, error = 0;
    long vertices = 0;
    constexpr int trials = 8;
    for (int trial = 0; trial < trials; ++trial) {
      Targets noisy = placed;
      for (auto& [name, landmark] : noisy) {
        const Vec3 shift(step(random), step(random), step(random));
        landmark.skin = bench.skin.surface.closest(landmark.skin + shift).position;
      }
      const skull::FitResult fit = skull::fit(bench.generic, bench.skin, noisy);
      error += testing::depth_errors(bench.samples, fit).at("all").mean / trials;
      const std::vector<Vec3> before = whole.bone_map(std::span<const Vec3>(bench.generic.mandible.vertices)),
                              after = fit.bone_map(std::span<const Vec3>(bench.generic.mandible.vertices));
      for (size_t v = 0; v < before.size(); ++v)
        moved += (after[v] - before[v]).norm();
      vertices += static_cast<long>(before.size());
    }
    std::printf("  %.0f mm: mandible moves by %.2f mm in the mean, depth error %.2f mm\n", 1e3 * deviation,
                1e3 * moved / static_cast<double>(vertices), 1e3 * error);
  }
}

void ict(const Bench& bench) {
  std::printf("ICT people: all landmarks given, no scanned bone\n");
  for (const char* name :
       {"neutral", "person_0", "person_1", "person_2", "person_3", "person_4", "person_5"}) {
    if (!testing::has_ict_head(measured, name)) continue;
    const testing::IctHead head =
        testing::read_ict_head(measured, name, fixtures / "ict_neutral_landmarks.json", bench.anatomy);
    const skull::Exterior skin = skull::exterior(head.head.skin);
    const double start = processor_ms();
    const skull::FitResult fit = skull::fit(bench.generic, skin, head.targets);
    const double ms = processor_ms() - start;
    double off = 0;
    for (const skull::FittedLandmark& landmark : fit.landmarks)
      off += std::abs(landmark.depth - landmark.table_depth) / static_cast<double>(fit.landmarks.size());
    std::printf(
        "  %-9s landmarks %.2f mm rms, %.2f max; depth %.2f mm off the table in the mean; outside %d, too "
        "near %d, "
        "corrected %d by at most %.2f mm; %d of %d curve points; uncovered %.1f %%; %.0f ms\n",
        name, 1e3 * fit.landmark_rms, 1e3 * fit.landmark_max, 1e3 * off, fit.bone_outside_skin,
        fit.bone_within_clearance, fit.corrected_vertices, 1e3 * fit.corrected_max, fit.curve_points_used,
        fit.curve_points, 100 * fit.uncovered_share, ms);
  }
}

void update_on(const char* title, const skull::Generic& generic, const skull::Exterior& skin,
               const Targets& targets) {
  double start = processor_ms();
  skull::Fitter fitter(generic, skin, targets);
  const double first = processor_ms() - start;
  const skull::FitResult& result = fitter.result();
  const int triangles = generic.cranium.triangle_count() + generic.mandible.triangle_count() +
                        generic.teeth_upper.triangle_count() + generic.teeth_lower.triangle_count();
  std::vector<double> times;
  const std::vector<skull::FittedLandmark> landmarks = result.landmarks;
  for (const skull::FittedLandmark& landmark : landmarks)
    for (double way : {0.001, 0.002, 0.0}) {
      const Vec3 beside = landmark.skin + way * landmark.direction.unitOrthogonal();
      start = processor_ms();
      fitter.move_landmark(landmark.name, skin.surface.closest(beside).position);
      times.push_back(processor_ms() - start);
    }
  std::sort(times.begin(), times.end());
  std::printf(
      "  %-10s %d triangles, %zu landmarks, fit %.0f ms; one landmark moved: median %.1f ms, nine in ten "
      "below %.1f ms, "
      "worst %.1f ms\n",
      title, triangles, landmarks.size(), first, times[times.size() / 2], times[times.size() * 9 / 10],
      times.back());
}

void update(const Bench& bench) {
  std::printf("processor time of an update\n");
  update_on("CT", bench.generic, bench.skin, bench.head.targets);
  if (!testing::has_ict_head(measured, "neutral")) return;
  const testing::IctHead head =
      testing::read_ict_head(measured, "neutral", fixtures / "ict_neutral_landmarks.json", bench.anatomy);
  update_on("ICT mean", bench.generic, skull::exterior(head.head.skin), head.targets);
}

/// The fitted skull of the CT head, coloured by its distance to the scanned bone: red in front of it, blue
/// behind.
void picture(const Bench& bench, const fs::path& path) {
  const skull::FitResult fit = skull::fit(bench.generic, bench.skin, bench.head.targets);
  const spatial::SurfaceQuery bone(bench.head.bone);
  view::DrawList list;
  std::vector<Vec3> all;
  for (const TriangleMesh* mesh : {&fit.cranium, &fit.mandible}) {
    view::DrawSurface surface;
    surface.positions = mesh->vertices;
    surface.triangles = mesh->triangles;
    const std::vector<Vec3> normals = vertex_normals(*mesh);
    for (int v = 0; v < mesh->vertex_count(); ++v) {
      const spatial::ClosestPoint closest = bone.closest(mesh->vertices[v]);
      const double side = (mesh->vertices[v] - closest.position).dot(normals[v]);
      const double off = std::clamp(side / 0.006, -1.0, 1.0);
      surface.vertex_colours.push_back(
          off > 0 ? Vec3(0.92, 0.88 - 0.65 * off, 0.78 - 0.65 * off)
                  : Vec3(0.92 + 0.70 * off, 0.88 + 0.45 * off, 0.78 + 0.1 * std::abs(off)));
    }
    all.insert(all.end(), mesh->vertices.begin(), mesh->vertices.end());
    list.surfaces.push_back(std::move(surface));
  }
  const view::Renderer renderer(520, 520);
  std::vector<view::Tile> tiles;
  for (const char* name : {"front", "three-quarter", "side"})
    tiles.push_back({renderer.draw(list, view::named_camera(name, bounds(all))), name});
  view::write_png(path, view::contact_sheet(tiles, 3));
}

int run(const std::set<std::string>& asked) {
  if (!testing::has_ct_head(measured)) {
    std::fprintf(stderr, "the CT head is not at %s\n", (measured / "data/ct").c_str());
    return 1;
  }
  const std::pair<const char*, std::function<void(const Bench&)>> parts[] = {
      {"truth", truth}, {"curves", curves}, {"leave-one-out", leave_one_out},
      {"noise", noise}, {"ict", ict},       {"update", update}};
  const Bench bench;
  for (const auto& [name, part] : parts)
    if (asked.empty() || asked.count(name)) part(bench);
  for (const std::string& name : asked)
    if (name.rfind("picture=", 0) == 0) picture(bench, name.substr(8));
  return 0;
}

}  // namespace

}  // namespace fascia::bench

int main(int count, char** arguments) {
  try {
    return fascia::bench::run({arguments + 1, arguments + count});
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
}
