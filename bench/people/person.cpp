#include "bench/people/person.h"

#include <cstdio>

#include "anatomy/anatomy.h"
#include "builder/rigging/build_rig.h"
#include "builder/rigging/embedded_head.h"
#include "builder/rigging/gltf_source.h"
#include "builder/spatial/surface_query.h"
#include "geometry/error.h"
#include "rig/write/write.h"
#include "tests/paths/paths.h"

namespace fascia::bench {
namespace {

namespace fs = std::filesystem;

const fs::path measured = test::measured_data() / "data/ict";

/// The landmarks placed on the mean head, at the same places of another person's mesh.
formats::LandmarkFile landmarks_on(const formats::Scene& person) {
  formats::LandmarkFile file = formats::read_landmarks(test::data() / "ict_neutral_landmarks.json");
  const formats::Scene neutral = formats::read(measured / "neutral.glb");
  const formats::SceneMesh& from = head_mesh(neutral);
  const spatial::SurfaceQuery surface({from.positions, from.triangles});
  const TriangleMesh to{head_mesh(person).positions, head_mesh(person).triangles};
  for (auto& [name, p] : file.points)
    p = position(to, surface.closest(p).surface);
  return file;
}

Person embedded() {
  const fs::path head = fs::temp_directory_path() / "fascia_bench_head.obj";
  const fs::path points = fs::temp_directory_path() / "fascia_bench_landmarks.json";
  rigging::write_embedded_head(head, points);
  Person person{formats::read(head), formats::read_landmarks(points)};
  fs::remove(head);
  fs::remove(points);
  return person;
}

}  // namespace

bool has_measured_people() {
  return fs::exists(measured);
}

const formats::SceneMesh& head_mesh(const formats::Scene& scene) {
  for (const formats::SceneMesh& mesh : scene.meshes)
    if (mesh.name == "head" || mesh.name == "skin") return mesh;
  throw Error("the scene has no mesh 'head'");
}

Person read_person(const std::string& name) {
  if (name == "embedded") return embedded();
  Person person;
  person.scene = formats::read(measured / (name + ".glb"));
  person.landmarks = landmarks_on(person.scene);
  return person;
}

void build_rig_file(const Person& person, const std::string& detail, const fs::path& path) {
  rigging::BuildOptions options;
  options.detail = detail;
  const rigging::BuildResult built =
      rigging::build_rig(person.scene, person.landmarks, anatomy::load_generic(), options);
  for (const std::string& warning : built.report.warnings)
    std::printf("%s: %s\n", path.stem().c_str(), warning.c_str());
  const std::vector<uint8_t> bytes =
      rig::write(rigging::gltf_source(person.scene, built.report.input_to_metres), built.rig);
  formats::write_bytes(path, bytes.data(), bytes.size());
}

int for_each_person(const char* program, const std::vector<std::string>& people,
                    const std::function<void(const std::string&)>& run) {
  try {
    for (const std::string& person : people.empty() ? std::vector<std::string>{"embedded"} : people) {
      if (person == "embedded" || has_measured_people())
        run(person);
      else
        std::printf("skipped %s: the measured heads are not beside the project\n", person.c_str());
    }
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s: %s\n", program, error.what());
    return 1;
  }
  return 0;
}

}  // namespace fascia::bench
