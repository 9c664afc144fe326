// make_skull FIGURES_FOLDER OUT.obj: shapes the generic skull from its figures.

#include <cstdio>
#include <exception>
#include <string>

#include "geometry/connectivity.h"
#include "tools/anatomy/skull/skull.h"

int main(int argc, char** argv) {
  if (argc != 3) {
    std::fprintf(stderr, "usage: make_skull anatomy/figures anatomy/data/skull.obj\n");
    return 2;
  }
  try {
    const auto skull = fascia::skull_maker::make_skull(fascia::skull_maker::read_figures(argv[1]));
    for (const auto& part : skull) {
      std::printf("%s: %d vertices, %d triangles\n", part.name.c_str(), part.mesh.vertex_count(),
                  part.mesh.triangle_count());
    }
    fascia::skull_maker::write_obj(skull, argv[2]);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "make_skull: %s\n", error.what());
    return 1;
  }
  return 0;
}
