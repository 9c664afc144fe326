// What every actuator does alone, on several heads: a contact sheet, and a table of how far the landmark it
// is there for moves and which way, beside what anatomy expects.
//
//   bench_actuators [embedded|neutral|person_0|...]... [--sheet PREFIX] [--level NAME] [--only SUBSTRING]
//   [--layers LIST]
//                   [--keep FOLDER] [--zoom FACTOR]
//
// Pairs are shown on the left; a row is marked when a travel lies outside the expected range.

#include <chrono>
#include <cmath>
#include <cstdio>
#include <map>

#include "anatomy/anatomy.h"
#include "bench/actuators/expected.h"
#include "bench/people/arguments.h"
#include "bench/people/person.h"
#include "builder/rigging/build_rig.h"
#include "builder/rigging/gltf_source.h"
#include "cli/picture.h"
#include "formats/landmark_file.h"
#include "formats/scene.h"
#include "geometry/error.h"
#include "rig/read/read.h"
#include "rig/write/write.h"
#include "view/image.h"

namespace fascia::bench {
namespace {

namespace fs = std::filesystem;

struct Request {
  std::vector<std::string> people;
  std::string sheet, level, only, layers = "skin,eyes";
  double zoom = 1.0;  ///< towards the landmark
  fs::path keep;      ///< folder that the rigs stay in; empty: they are removed
};

/// A rig written to a file of its own, gone with this.
struct BuiltRig {
  fs::path path;
  rig::Rig rig;
  bool is_kept = false;
  ~BuiltRig() {
    std::error_code ignored;
    if (!is_kept) fs::remove(path, ignored);
  }
};

std::unique_ptr<BuiltRig> build(const std::string& person, const fs::path& keep) {
  const auto [scene, landmarks] = read_person(person);
  const rigging::BuildResult built = rigging::build_rig(scene, landmarks, anatomy::load_generic(), {});
  for (const std::string& warning : built.report.warnings)
    std::printf("%s: %s\n", person.c_str(), warning.c_str());
  const std::vector<uint8_t> bytes =
      rig::write(rigging::gltf_source(scene, built.report.input_to_metres), built.rig);
  auto out = std::make_unique<BuiltRig>();
  out->is_kept = !keep.empty();
  out->path = (out->is_kept ? keep : fs::temp_directory_path()) / ("fascia_actuators_" + person + ".glb");
  formats::write_bytes(out->path, bytes.data(), bytes.size());
  out->rig = built.rig;
  return out;
}

/// Where the rig's skin landmarks go with the pose: the motion of the skin vertex nearest to each at rest.
struct LandmarkIndices {
  std::map<std::string, std::pair<size_t, size_t>> vertex;  // mesh, vertex
  LandmarkIndices(const cli::Face& face, const rig::Rig& rig) {
    for (const rig::Landmark& landmark : rig.skull.landmarks) {
      float best = 1e9F;
      for (size_t m = 0; m < face.meshes().size(); ++m) {
        if (face.meshes()[m].part != "skin") continue;
        const auto rest = face.rest(m);
        for (size_t v = 0; 3 * v < rest.size(); ++v) {
          const float d = (rig::Vec3f(rest[3 * v], rest[3 * v + 1], rest[3 * v + 2]) - landmark.skin).norm();
          if (d >= best) continue;
          best = d;
          vertex[landmark.name] = {m, v};
        }
      }
    }
  }
  Vec3 motion(const cli::Face& face, const std::string& name) const {
    const auto found = vertex.find(name);
    if (found == vertex.end()) return Vec3::Constant(NAN);
    const auto [m, v] = found->second;
    const auto now = face.positions(m), rest = face.rest(m);
    return {static_cast<double>(now[3 * v] - rest[3 * v]),
            static_cast<double>(now[3 * v + 1] - rest[3 * v + 1]),
            static_cast<double>(now[3 * v + 2] - rest[3 * v + 2])};
  }
};

bool is_channel(const cli::Face& face, const std::string& name) {
  const auto names = face.channel_names();
  return std::find(names.begin(), names.end(), name) != names.end();
}

/// The picture of the side of the face where an actuator works.
view::Camera camera_for(const rig::Rig& rig, const std::string& landmark, double zoom) {
  Vec3 brow = Vec3::Zero(), chin = Vec3::Zero(), at = Vec3::Zero();
  for (const rig::Landmark& l : rig.skull.landmarks) {
    if (l.name == "glabella") brow = l.skin.cast<double>();
    if (l.name == "gnathion") chin = l.skin.cast<double>();
    if (l.name == landmark) at = l.skin.cast<double>();
  }
  view::Camera camera;
  camera.target = at + 0.5 / zoom * (0.5 * (brow + chin) - at);
  camera.distance = 3.3 * (brow - chin).norm() / zoom;
  camera.yaw = 30;
  return camera;
}

int run(const std::string& person, const Request& request) {
  const std::unique_ptr<BuiltRig> built = build(person, request.keep);
  cli::Face face(built->path, {FASCIA_SPACE_METRES, "own", request.level});
  const LandmarkIndices landmarks(face, built->rig);
  std::printf("%s\n%-46s %5s  %-32s %21s %7s  %s\n", person.c_str(), "actuator", "value", "landmark",
              "lateral/up/fwd mm", "travel", "expected");
  std::vector<view::Tile> tiles;
  std::unique_ptr<view::Renderer> renderer;
  if (!request.sheet.empty()) renderer = std::make_unique<view::Renderer>(300, 300);
  int outside = 0;
  for (const Expectation& e : expectations()) {
    if (e.actuator.find(request.only) == std::string::npos) continue;
    const bool is_both = e.actuator.rfind("both:", 0) == 0;
    const std::string bare = is_both ? e.actuator.substr(5) : e.actuator;
    const std::string name = is_channel(face, bare) ? bare : bare + "_left";
    face.clear();
    face.reset();
    face.set(name, e.value);
    if (is_both) face.set(bare + "_right", e.value);
    const auto begin = std::chrono::steady_clock::now();
    face.pose();
    const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    const Vec3 motion = 1e3 * landmarks.motion(face, e.landmark);
    const double travel = motion.dot(Vec3(e.direction[0], e.direction[1], e.direction[2]).normalized());
    const bool fits = travel >= e.least && travel <= e.most;
    outside += !fits;
    std::printf("%-46s %5.1f  %-32s %6.1f %6.1f %6.1f %7.1f  %4.1f..%-4.1f %s %5.2fs\n", name.c_str(),
                e.value, e.landmark.c_str(), motion.x(), motion.y(), motion.z(), travel, e.least, e.most,
                fits ? " " : "*", seconds);
    if (renderer) {
      char caption[64];
      std::snprintf(caption, sizeof caption, "%.27s %+.1f", bare.c_str(), travel);
      tiles.push_back({renderer->draw(cli::draw_face(face, built->rig, cli::layers_from(request.layers)),
                                      camera_for(built->rig, e.landmark, request.zoom)),
                       caption});
    }
  }
  std::printf("%d outside the expected range\n\n", outside);
  if (renderer) view::write_png(request.sheet + "_" + person + ".png", view::contact_sheet(tiles, 8));
  return outside;
}

}  // namespace
}  // namespace fascia::bench

int main(int argc, char** argv) {
  fascia::bench::Request request;
  fascia::bench::Arguments arguments("bench_actuators", "[embedded|neutral|person_0|...]...");
  arguments.option("--sheet", "PREFIX", request.sheet);
  arguments.option("--level", "NAME", request.level);
  arguments.option("--only", "SUBSTRING", request.only);
  arguments.option("--layers", "LIST", request.layers);
  arguments.option("--keep", "FOLDER", request.keep);
  arguments.option("--zoom", "FACTOR", request.zoom);
  if (!arguments.parse(argc, argv, request.people)) return 2;
  return fascia::bench::for_each_person("bench_actuators", request.people, [&](const std::string& person) {
    fascia::bench::run(person, request);
  });
}
