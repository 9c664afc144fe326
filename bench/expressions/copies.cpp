#include "bench/expressions/copies.h"

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <map>
#include <memory>

#include "anatomy/anatomy.h"
#include "bench/expressions/measured_shapes.h"
#include "bench/expressions/remeshed.h"
#include "bench/people/person.h"
#include "builder/rigging/build_rig.h"
#include "builder/rigging/gltf_source.h"
#include "cli/posing.h"
#include "formats/landmark_file.h"
#include "geometry/error.h"
#include "rig/write/write.h"
#include "tests/paths/paths.h"

namespace fascia::bench {

namespace {

namespace fs = std::filesystem;

const fs::path measured = test::measured_data() / "data/ict";

/// The head mesh lists its face first; neck and the linings of mouth and eye sockets follow.
constexpr size_t face_vertices = 9916;

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

/// A rig built from `scene`, its file gone with this.
struct Subject {
  fs::path path;
  std::unique_ptr<cli::Face> face;
  Subject(const formats::Scene& scene, const formats::LandmarkFile& landmarks, const std::string& name,
          const std::string& level)
      : path(fs::temp_directory_path() / ("fascia_bench_" + name + ".glb")) {
    rigging::BuildOptions options;
    if (!level.empty()) options.detail = level;
    const rigging::BuildResult built = rigging::build_rig(scene, landmarks, anatomy::load_generic(), options);
    const std::vector<uint8_t> bytes =
        rig::write(rigging::gltf_source(scene, built.report.input_to_metres), built.rig);
    formats::write_bytes(path, bytes.data(), bytes.size());
    face = std::make_unique<cli::Face>(path, cli::Face::Options{FASCIA_SPACE_INPUT, "own", level});
  }
  Subject(const Subject&) = delete;
  ~Subject() {
    std::error_code ignored;
    fs::remove(path, ignored);
  }
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

/// The same head in other triangles: its score, and how far its poses lie from the original's.
}  // namespace

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

}  // namespace fascia::bench
