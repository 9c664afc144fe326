// How much of measured expressions the simulated ones explain: for each ARKit shape of a reference face
// 1 - sum|u-v|^2 / sum|v|^2 over its skin, and the mean error over vertices that move more than 0.5 mm.
//
//   bench_expressions [neutral|person_0|...]... [--sheet FILE.png] [--level NAME]
//
// Doing nothing scores 0 and about 3 mm, a half-amplitude copy 0.75 and 1.5 mm. mouthClose is scored as jawOpen + mouthClose.
// The shapes are one sculpted, nearly mirrored set shared by all people: a reference, not an independent sample.

#include <cmath>
#include <cstdio>
#include <map>

#include "anatomy/anatomy.h"
#include "bench/expressions/measured_shapes.h"
#include "builder/rigging/build_rig.h"
#include "builder/rigging/gltf_source.h"
#include "builder/spatial/surface_query.h"
#include "cli/posing.h"
#include "formats/landmark_file.h"
#include "formats/scene.h"
#include "geometry/error.h"
#include "rig/write/write.h"
#include "view/image.h"
#include "view/renderer.h"

namespace fascia::bench {

namespace {

namespace fs = std::filesystem;

const fs::path measured = fs::path(FASCIA_MEASURED_DATA) / "data/ict";

struct Score {
  double explained = 0.0, error_mm = 0.0;
  int turned = 0;  ///< triangles that the simulation turns over and the reference does not
};

const formats::SceneMesh& head_mesh(const formats::Scene& scene) {
  for (const formats::SceneMesh& mesh : scene.meshes)
    if (mesh.name == "head") return mesh;
  throw Error("the scene has no mesh 'head'");
}

/// The landmarks placed on the mean head, at the same places of another person's mesh.
formats::LandmarkFile landmarks_on(const formats::Scene& person) {
  formats::LandmarkFile file = formats::read_landmarks(fs::path(FASCIA_TEST_DATA) / "ict_neutral_landmarks.json");
  const formats::Scene neutral = formats::read(measured / "neutral.glb");
  const formats::SceneMesh& from = head_mesh(neutral);
  const spatial::SurfaceQuery surface({from.positions, from.triangles});
  const TriangleMesh to{head_mesh(person).positions, head_mesh(person).triangles};
  for (auto& [name, p] : file.points) p = position(to, surface.closest(p).surface);
  return file;
}

Score score(const std::vector<Vec3>& rest, const std::vector<Triangle>& triangles, const std::vector<Vec3>& simulated,
            const std::vector<Vec3>& truth) {
  Score result;
  double miss = 0.0, all = 0.0, error = 0.0;
  int moving = 0;
  std::vector<Vec3> posed(rest.size()), wanted(rest.size());
  for (size_t v = 0; v < rest.size(); ++v) {
    miss += (simulated[v] - truth[v]).squaredNorm();
    all += truth[v].squaredNorm();
    if (truth[v].norm() > 0.0005) {
      error += (simulated[v] - truth[v]).norm();
      ++moving;
    }
    posed[v] = rest[v] + simulated[v];
    wanted[v] = rest[v] + truth[v];
  }
  result.explained = 1.0 - miss / all;
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
  for (const auto& [name, value] : values) face.set(name, value);
  face.pose();
  for (size_t m = 0; m < face.meshes().size(); ++m) {
    if (face.meshes()[m].name != "head") continue;
    std::vector<Vec3> moved;
    const auto now = face.positions(m), rest = face.rest(m);
    for (size_t i = 0; i + 2 < now.size(); i += 3) moved.emplace_back(now[i] - rest[i], now[i + 1] - rest[i + 1], now[i + 2] - rest[i + 2]);
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
               const std::vector<Vec3>& simulated, const std::vector<Vec3>& truth, const std::string& name, const Score& result) {
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
    if (kind == 0) std::snprintf(caption, sizeof caption, "%s measured", name.c_str());
    else if (kind == 1) std::snprintf(caption, sizeof caption, "simulated %.2f", result.explained);
    else std::snprintf(caption, sizeof caption, "error 0..5 mm: %.2f", result.error_mm);
    tiles.push_back({renderer.draw(list, camera), caption});
  }
}

void run_person(const std::string& person, const std::string& level, const std::string& sheet) {
  const formats::Scene scene = formats::read(measured / (person + ".glb"));
  const auto anatomy = anatomy::load_generic();
  rigging::BuildOptions options;
  const rigging::BuildResult built = rigging::build_rig(scene, landmarks_on(scene), anatomy, options);
  const std::vector<uint8_t> bytes = rig::write(rigging::gltf_source(scene, built.report.input_to_metres), built.rig);
  const fs::path rig_path = fs::temp_directory_path() / ("fascia_bench_" + person + ".glb");
  formats::write_bytes(rig_path, bytes.data(), bytes.size());
  cli::Face face(rig_path, {FASCIA_SPACE_INPUT, "own", level});
  const formats::SceneMesh& head = head_mesh(scene);
  const std::vector<MeasuredShape> shapes = measured_shapes(measured / "expressions.glb", "head");
  std::map<std::string, const MeasuredShape*> by_name;
  for (const MeasuredShape& shape : shapes) by_name[shape.name] = &shape;

  std::printf("%s\n%-22s %9s %9s %7s\n", person.c_str(), "shape", "explained", "error mm", "turned");
  std::vector<view::Tile> tiles;
  std::unique_ptr<view::Renderer> renderer;
  if (!sheet.empty()) renderer = std::make_unique<view::Renderer>(300, 340);
  double sum = 0.0, errors = 0.0, sum_without_look = 0.0;
  int without_look = 0;
  for (const MeasuredShape& shape : shapes) {
    std::map<std::string, double> values = {{"arkit:" + shape.name, 1.0}};
    std::vector<Vec3> truth = shape.displacement;
    if (shape.name == "mouthClose") {
      values["arkit:jawOpen"] = 1.0;
      for (size_t v = 0; v < truth.size(); ++v) truth[v] += by_name.at("jawOpen")->displacement[v];
    }
    const std::vector<Vec3> simulated = simulated_displacement(face, values);
    const Score result = score(head.positions, head.triangles, simulated, truth);
    std::printf("%-22s %9.3f %9.2f %7d\n", shape.name.c_str(), result.explained, result.error_mm, result.turned);
    sum += result.explained;
    errors += result.error_mm;
    if (shape.name.rfind("eyeLook", 0) != 0) {
      sum_without_look += result.explained;
      ++without_look;
    }
    if (renderer) add_tiles(tiles, *renderer, head, simulated, truth, shape.name, result);
  }
  std::printf("%-22s %9.3f %9.2f\n%-22s %9.3f\n\n", "mean", sum / static_cast<double>(shapes.size()),
              errors / static_cast<double>(shapes.size()), "mean without eyeLook", sum_without_look / without_look);
  if (renderer) view::write_png(sheet, view::contact_sheet(tiles, 9));
  fs::remove(rig_path);
}

}  // namespace

}  // namespace fascia::bench

int main(int argc, char** argv) {
  std::vector<std::string> people;
  std::string sheet, level;
  for (int i = 1; i < argc; ++i) {
    const std::string word = argv[i];
    if (word == "--sheet" && i + 1 < argc) sheet = argv[++i];
    else if (word == "--level" && i + 1 < argc) level = argv[++i];
    else people.push_back(word);
  }
  if (people.empty()) people = {"neutral"};
  if (!std::filesystem::exists(fascia::bench::measured)) {
    std::printf("skipped: the measured expressions are not at %s\n", fascia::bench::measured.c_str());
    return 0;
  }
  try {
    for (const std::string& person : people) fascia::bench::run_person(person, level, sheet);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "bench_expressions: %s\n", error.what());
    return 1;
  }
  return 0;
}
