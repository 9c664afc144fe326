// How much of measured expressions the simulated ones explain: for each ARKit shape of a reference face
// 1 - sum|u-v|^2 / sum|v|^2 over its face, the same over all its skin with the linings of mouth and eye
// sockets, and the mean error over vertices of the skin that move more than 0.5 mm. Beside them what tells a
// wrong amplitude from a wrong direction: the factor that would serve best, and the share explained with it.
//
//   bench_expressions [neutral|person_0|...]... [--sheet FILE.png] [--level NAME] [--rigs DIR] [--remeshed]
//
// With --remeshed copies of each head cut into other triangles are scored too, and how far their poses lie
// from the head's own where either moves by more than 0.5 mm. With --rigs the rigs are left in DIR and
// nothing is scored.
//
// Doing nothing scores 0 and about 3 mm, a half-amplitude copy 0.75 and 1.5 mm. mouthClose is scored as
// jawOpen + mouthClose. The shapes are one sculpted, nearly mirrored set shared by all people: a reference,
// not an independent sample.

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>
#include <memory>

#include "anatomy/anatomy.h"
#include "bench/expressions/measured_shapes.h"
#include "bench/expressions/remeshed.h"
#include "bench/people/person.h"
#include "builder/rigging/build_rig.h"
#include "builder/rigging/gltf_source.h"
#include "builder/spatial/surface_query.h"
#include "cli/posing.h"
#include "formats/landmark_file.h"
#include "formats/scene.h"
#include "geometry/error.h"
#include "rig/write/write.h"
#include "tests/paths/paths.h"
#include "view/image.h"
#include "view/renderer.h"

namespace fascia::bench {

namespace {

namespace fs = std::filesystem;

const fs::path measured = test::measured_data() / "data/ict";

/// The head mesh lists its face first; neck and the linings of mouth and eye sockets follow.
constexpr size_t face_vertices = 9916;

struct Score {
  double explained = 0.0, skin_explained = 0.0, error_mm = 0.0;
  double best_scale = 0.0, at_best_scale = 0.0;  ///< of the face
  int turned = 0;  ///< triangles that the simulation turns over and the reference does not
};

Score score(const std::vector<Vec3>& rest, const std::vector<Triangle>& triangles,
            const std::vector<Vec3>& simulated, const std::vector<Vec3>& truth) {
  Score result;
  double miss[2] = {}, all[2] = {}, own = 0.0, both = 0.0, error = 0.0;  // [0] face, [1] lining
  int moving = 0;
  std::vector<Vec3> posed(rest.size()), wanted(rest.size());
  for (size_t v = 0; v < rest.size(); ++v) {
    const int part = v < face_vertices ? 0 : 1;
    miss[part] += (simulated[v] - truth[v]).squaredNorm();
    all[part] += truth[v].squaredNorm();
    if (part == 0) {
      own += simulated[v].squaredNorm();
      both += simulated[v].dot(truth[v]);
    }
    if (truth[v].norm() > 0.0005) {
      error += (simulated[v] - truth[v]).norm();
      ++moving;
    }
    posed[v] = rest[v] + simulated[v];
    wanted[v] = rest[v] + truth[v];
  }
  result.explained = 1.0 - miss[0] / all[0];
  result.skin_explained = 1.0 - (miss[0] + miss[1]) / (all[0] + all[1]);
  result.best_scale = own > 0.0 ? both / own : 0.0;
  result.at_best_scale = own > 0.0 ? both * both / (own * all[0]) : 0.0;
  result.error_mm = moving ? 1e3 * error / moving : 0.0;
  const TriangleMesh a{rest, triangles}, b{posed, triangles}, c{wanted, triangles};
  for (int t = 0; t < a.triangle_count(); ++t) {
    const Vec3 normal = triangle_normal(a, t);
    if (triangle_normal(b, t).dot(normal) < -0.2 && triangle_normal(c, t).dot(normal) > 0.2) ++result.turned;
  }
  return result;
}

std::vector<Vec3> simulated_displacement(cli::Face& face, const std::map<std::string, double>& values) {
  face.clear();
  face.reset();
  for (const auto& [name, value] : values)
    face.set(name, value);
  face.pose();
  for (size_t m = 0; m < face.meshes().size(); ++m) {
    if (face.meshes()[m].name != "head") continue;
    std::vector<Vec3> moved;
    const auto now = face.positions(m), rest = face.rest(m);
    for (size_t i = 0; i + 2 < now.size(); i += 3)
      moved.emplace_back(now[i] - rest[i], now[i + 1] - rest[i + 1], now[i + 2] - rest[i + 2]);
    return moved;
  }
  throw Error("the rig has no mesh 'head'");
}

Vec3 heat(double mm) {
  const double t = std::min(mm / 5.0, 1.0);
  return Vec3(std::min(1.0, 2.0 * t), std::min({1.0, 2.0 * t, 2.0 - 2.0 * t}), std::max(0.0, 1.0 - 2.0 * t));
}

/// Measured, simulated and error side by side.
void add_tiles(std::vector<view::Tile>& tiles, const view::Renderer& renderer, const formats::SceneMesh& head,
               const std::vector<Vec3>& simulated, const std::vector<Vec3>& truth, const std::string& name,
               const Score& result) {
  view::Camera camera;
  camera.target = Vec3(0.0, 0.005, 0.05);
  camera.distance = 0.62;
  camera.yaw = 20;
  for (int kind = 0; kind < 3; ++kind) {
    view::DrawList list;
    view::DrawSurface surface;
    surface.triangles = head.triangles;
    surface.colour = Vec3(0.86, 0.69, 0.59);
    surface.shine = 0.1;
    for (size_t v = 0; v < head.positions.size(); ++v) {
      surface.positions.push_back(head.positions[v] + (kind == 0 ? truth[v] : simulated[v]));
      if (kind == 2) surface.vertex_colours.push_back(heat(1e3 * (simulated[v] - truth[v]).norm()));
    }
    list.surfaces.push_back(std::move(surface));
    char caption[96];
    if (kind == 0)
      std::snprintf(caption, sizeof caption, "%s measured", name.c_str());
    else if (kind == 1)
      std::snprintf(caption, sizeof caption, "simulated %.2f", result.explained);
    else
      std::snprintf(caption, sizeof caption, "error 0..5 mm: %.2f", result.error_mm);
    tiles.push_back({renderer.draw(list, camera), caption});
  }
}

/// A rig built from `scene`, its file gone with this.
struct Subject {
  fs::path path;
  std::unique_ptr<cli::Face> face;
  Subject(const formats::Scene& scene, const formats::LandmarkFile& landmarks, const std::string& name,
          const std::string& level, const fs::path& kept = {})
      : path(kept.empty() ? fs::temp_directory_path() / ("fascia_bench_" + name + ".glb") : kept),
        is_kept(!kept.empty()) {
    rigging::BuildOptions options;
    if (!level.empty()) options.detail = level;
    const rigging::BuildResult built = rigging::build_rig(scene, landmarks, anatomy::load_generic(), options);
    const std::vector<uint8_t> bytes =
        rig::write(rigging::gltf_source(scene, built.report.input_to_metres), built.rig);
    formats::write_bytes(path, bytes.data(), bytes.size());
    if (!is_kept)
      face = std::make_unique<cli::Face>(path, cli::Face::Options{FASCIA_SPACE_INPUT, "own", level});
  }
  Subject(const Subject&) = delete;
  ~Subject() {
    std::error_code ignored;
    if (!is_kept) fs::remove(path, ignored);
  }

 private:
  bool is_kept;
};

/// What plays a measured shape, and what it should look like.
struct Goal {
  std::map<std::string, double> values;
  std::vector<Vec3> truth;
};

std::map<std::string, Goal> goals() {
  const std::vector<MeasuredShape> shapes = measured_shapes(measured / "expressions.glb", "head");
  std::map<std::string, Goal> goals;
  for (const MeasuredShape& shape : shapes)
    goals[shape.name] = {{{"arkit:" + shape.name, 1.0}}, shape.displacement};
  Goal& close = goals.at("mouthClose");
  close.values["arkit:jawOpen"] = 1.0;
  for (size_t v = 0; v < close.truth.size(); ++v)
    close.truth[v] += goals.at("jawOpen").truth[v];
  return goals;
}

void run_person(const std::string& person, const std::string& level, const std::string& sheet,
                const std::string& rigs) {
  const auto [scene, landmarks] = read_person(person);
  const Subject subject(scene, landmarks, person, level,
                        rigs.empty() ? fs::path() : fs::path(rigs) / (person + ".glb"));
  if (!rigs.empty()) return;
  const formats::SceneMesh& head = head_mesh(scene);
  std::printf("%s\n%-22s %9s %9s %9s %7s %10s %10s\n", person.c_str(), "shape", "explained", "all skin",
              "error mm", "turned", "best scale", "share at it");
  std::vector<view::Tile> tiles;
  std::unique_ptr<view::Renderer> renderer;
  if (!sheet.empty()) renderer = std::make_unique<view::Renderer>(300, 340);
  double sum = 0.0, skin_sum = 0.0, best_sum = 0.0, errors = 0.0, sum_without_look = 0.0;
  int without_look = 0;
  const std::map<std::string, Goal> shapes = goals();
  for (const auto& [name, goal] : shapes) {
    const std::vector<Vec3> simulated = simulated_displacement(*subject.face, goal.values);
    const Score result = score(head.positions, head.triangles, simulated, goal.truth);
    std::printf("%-22s %9.3f %9.3f %9.2f %7d %10.2f %10.3f\n", name.c_str(), result.explained,
                result.skin_explained, result.error_mm, result.turned, result.best_scale,
                result.at_best_scale);
    sum += result.explained;
    skin_sum += result.skin_explained;
    best_sum += result.at_best_scale;
    errors += result.error_mm;
    if (name.rfind("eyeLook", 0) != 0) {
      sum_without_look += result.explained;
      ++without_look;
    }
    if (renderer) add_tiles(tiles, *renderer, head, simulated, goal.truth, name, result);
  }
  const auto count = static_cast<double>(shapes.size());
  std::printf("%-22s %9.3f %9.3f %9.2f %29.3f\n%-22s %9.3f\n\n", "mean", sum / count, skin_sum / count,
              errors / count, best_sum / count, "mean without eyeLook", sum_without_look / without_look);
  if (renderer) view::write_png(sheet, view::contact_sheet(tiles, 9));
}

/// The same head in other triangles: its score, and how far its poses lie from the original's.
void run_copies(const std::string& person, const std::string& level) {
  const auto [scene, landmarks] = read_person(person);
  const Subject original(scene, landmarks, person, level);
  const std::map<std::string, Goal> shapes = goals();
  for (const char* kind : {"half", "uneven"}) {
    const RemeshedCopy copy = remeshed_copy(scene, "head", kind);
    const Subject subject(copy.scene, landmarks, person + "_" + kind, level);
    std::printf("%s, %s: %zu vertices instead of %zu\n%-22s %9s %9s %12s %9s\n", person.c_str(), kind,
                copy.head_vertices, head_mesh(scene).positions.size(), "shape", "explained", "original",
                "apart: mean", "95 % mm");
    double sum[4] = {};
    for (const auto& [name, goal] : shapes) {
      const std::vector<Vec3> own = simulated_displacement(*original.face, goal.values);
      const std::vector<Vec3> simulated =
          carried_over(copy, simulated_displacement(*subject.face, goal.values));
      const std::vector<Vec3>& truth = goal.truth;
      double all = 0.0, miss[2] = {}, mean = 0.0;
      std::vector<double> apart;
      for (size_t v = 0; v < face_vertices; ++v) {
        all += truth[v].squaredNorm();
        miss[0] += (simulated[v] - truth[v]).squaredNorm();
        miss[1] += (own[v] - truth[v]).squaredNorm();
        if (std::max(own[v].norm(), simulated[v].norm()) < 0.0005) continue;
        apart.push_back(1e3 * (own[v] - simulated[v]).norm());
        mean += apart.back();
      }
      std::sort(apart.begin(), apart.end());
      const double row[] = {1.0 - miss[0] / all, 1.0 - miss[1] / all,
                            apart.empty() ? 0.0 : mean / static_cast<double>(apart.size()),
                            apart.empty() ? 0.0 : apart[apart.size() * 95 / 100]};
      std::printf("%-22s %9.3f %9.3f %12.2f %9.2f\n", name.c_str(), row[0], row[1], row[2], row[3]);
      for (size_t k = 0; k < 4; ++k)
        sum[k] += row[k] / static_cast<double>(shapes.size());
    }
    std::printf("%-22s %9.3f %9.3f %12.2f %9.2f\n\n", "mean", sum[0], sum[1], sum[2], sum[3]);
  }
}

}  // namespace

}  // namespace fascia::bench

int main(int argc, char** argv) {
  std::vector<std::string> people;
  std::string sheet, level, rigs;
  bool remeshed = false;
  for (int i = 1; i < argc; ++i) {
    const std::string word = argv[i];
    if (word == "--sheet" && i + 1 < argc)
      sheet = argv[++i];
    else if (word == "--level" && i + 1 < argc)
      level = argv[++i];
    else if (word == "--rigs" && i + 1 < argc)
      rigs = argv[++i];
    else if (word == "--remeshed")
      remeshed = true;
    else
      people.push_back(word);
  }
  if (people.empty()) people = {"neutral"};
  if (!std::filesystem::exists(fascia::bench::measured)) {
    std::printf("skipped: the measured expressions are not at %s\n", fascia::bench::measured.c_str());
    return 0;
  }
  try {
    for (const std::string& person : people) {
      fascia::bench::run_person(person, level, sheet, rigs);
      if (remeshed) fascia::bench::run_copies(person, level);
    }
  } catch (const std::exception& error) {
    std::fprintf(stderr, "bench_expressions: %s\n", error.what());
    return 1;
  }
  return 0;
}
