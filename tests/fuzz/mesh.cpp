// GLB, glTF, OBJ, PLY and STL: the first byte says which, the rest is the file.
#include "formats/scene.h"
#include "geometry/error.h"
#include "tests/fuzz/scratch_file.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* bytes, size_t size) {
  static const char* const extensions[] = {".glb", ".gltf", ".obj", ".ply", ".stl"};
  if (size < 1) return 0;
  try {
    const fascia::formats::Scene scene =
        fascia::formats::read(fascia::fuzz::scratch_file(bytes + 1, size - 1, extensions[bytes[0] % 5]));
    // What was read is sound: every index has its vertex, every number is finite.
    for (const fascia::formats::SceneMesh& mesh : scene.meshes) {
      for (const fascia::Triangle& triangle : mesh.triangles)
        for (const int v : triangle)
          if (v < 0 || static_cast<size_t>(v) >= mesh.positions.size()) __builtin_trap();
      for (const fascia::Vec3& p : mesh.positions)
        if (!p.allFinite()) __builtin_trap();
    }
  } catch (const fascia::Error&) {
  }
  return 0;
}
