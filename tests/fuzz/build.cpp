// Rigs of heads with holes, spikes, flaps and torn edges: the generic head with changes that the input lists.
// A rig comes out, or an error that says why; never a crash, nor numbers that are none.
#include <cmath>
#include <cstring>

#include "anatomy/anatomy.h"
#include "builder/rigging/build_rig.h"
#include "geometry/error.h"

namespace {

using fascia::formats::Scene;
using fascia::formats::SceneMesh;

/// The generic head as a scene, in metres.
const Scene& sound() {
  static const Scene scene = [] {
    Scene made;
    const fascia::anatomy::GenericAnatomy anatomy = fascia::anatomy::load_generic();
    for (const char* name : {"skin", "eye_left", "eye_right", "teeth_upper", "teeth_lower"}) {
      const auto* object = anatomy.head_object(name);
      if (!object) continue;
      SceneMesh mesh;
      mesh.name = name;
      mesh.positions = object->mesh.vertices;
      mesh.triangles = object->mesh.triangles;
      made.meshes.push_back(mesh);
    }
    made.path = "head.obj";
    made.kind = fascia::formats::FileKind::obj;
    return made;
  }();
  return scene;
}

/// One change: eight bytes of the input.
void change(Scene& scene, const uint8_t* bytes) {
  SceneMesh& mesh = scene.meshes[bytes[0] % scene.meshes.size()];
  if (mesh.triangles.empty()) return;
  uint32_t place = 0;
  std::memcpy(&place, bytes + 1, 4);
  const double amount = (bytes[6] - 128) / 400.0;  // up to a third of a metre
  const size_t v = place % mesh.positions.size(), t = place % mesh.triangles.size();
  switch (bytes[5] % 8) {
    case 0:
      mesh.positions[v][bytes[7] % 3] += amount;
      break;
    case 1:
      mesh.positions[v] *= 1.0 + amount;
      break;
    case 2:
      mesh.triangles.erase(mesh.triangles.begin() + static_cast<std::ptrdiff_t>(t));
      break;
    case 3:
      mesh.triangles.push_back(mesh.triangles[t]);
      break;
    case 4:
      std::swap(mesh.triangles[t][0], mesh.triangles[t][1]);
      break;
    case 5:
      mesh.positions[v] = mesh.positions[(v + bytes[7]) % mesh.positions.size()];
      break;
    case 6:
      mesh.triangles[t][bytes[7] % 3] = static_cast<int>((v + bytes[6]) % mesh.positions.size());
      break;
    case 7:
      mesh.triangles.resize(mesh.triangles.size() * (128 + bytes[7] % 128) / 256 + 1);
      break;
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* bytes, size_t size) {
  static const fascia::anatomy::GenericAnatomy anatomy = fascia::anatomy::load_generic();
  Scene scene = sound();
  for (size_t i = 0; i + 8 <= size && i < 8 * 200; i += 8)
    change(scene, bytes + i);
  fascia::rigging::BuildOptions options;
  options.detail = "low";
  try {
    const fascia::rigging::BuildResult result = fascia::rigging::build_rig(scene, {}, anatomy, options);
    for (const auto& level : result.rig.tissue.levels)
      for (const float mass : level.masses)
        if (!std::isfinite(mass)) __builtin_trap();
  } catch (const fascia::Error&) {
  }
  return 0;
}
