#include <chrono>
#include <cstdio>

#include "anatomy/anatomy.h"
#include "builder/landmarks/find_head.h"
#include "formats/scene.h"

using namespace fascia;

int main(int argc, char** argv) {
  const auto anatomy = anatomy::load_generic();
  const auto now = [] { return std::chrono::steady_clock::now(); };
  const auto ms = [](auto a, auto b) { return 1e3 * std::chrono::duration<double>(b - a).count(); };
  auto t0 = now();
  const auto face = landmarks::generic_face(anatomy);
  auto t1 = now();
  int faces = 0; for (bool b : face.is_face) faces += b;
  std::printf("generic: %zu points, %d face, vault %.1f mm at %.1f %.1f %.1f; %.1f ms\n", face.points.size(), faces, 1e3*face.vault.radius, 1e3*face.vault.centre[0], 1e3*face.vault.centre[1], 1e3*face.vault.centre[2], ms(t0,t1));
  for (int a = 1; a < argc; ++a) {
    const auto scene = formats::read(argv[a]);
    TriangleMesh all;
    for (const auto& mesh : scene.meshes) {
      const int base = all.vertex_count();
      all.vertices.insert(all.vertices.end(), mesh.positions.begin(), mesh.positions.end());
      for (const Triangle& t : mesh.triangles) all.triangles.push_back({t[0] + base, t[1] + base, t[2] + base});
    }
    t0 = now();
    try {
      const auto found = landmarks::find_head(face, all, argv[a]);
      t1 = now();
      std::printf("%s: likeness %.3f scale %.4f, %.0f ms\n", argv[a], found.likeness, found.placement.scale, ms(t0, t1));
      for (int r = 0; r < 3; ++r) std::printf("  %7.3f %7.3f %7.3f | %8.4f\n", found.placement.rotation(r,0), found.placement.rotation(r,1), found.placement.rotation(r,2), found.placement.shift[r]);
    } catch (const std::exception& e) {
      std::printf("%s: %s (%.0f ms)\n", argv[a], e.what(), ms(t0, now()));
    }
  }
}
