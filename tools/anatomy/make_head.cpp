// make_head FIGURES_FOLDER DATA_FOLDER: shapes the generic head from the measured figures and writes head.obj
// and head_regions.json (mm, the frame of the figures). The same figures give the same bytes.

#include <cstdio>
#include <exception>

#include "tools/anatomy/head/head.h"
#include "tools/anatomy/head/write.h"

int main(int argc, char** argv) try {
  using namespace fascia::head_maker;
  if (argc != 3) {
    std::fprintf(stderr, "usage: make_head FIGURES_FOLDER DATA_FOLDER\n");
    return 2;
  }
  const Figures figures = read_figures(argv[1]);
  const HalfHead half = make_half(figures);
  const PolygonMesh skin = mirrored(half, unwrap(half));
  const std::vector<PolygonMesh> meshes = {skin, make_eyeball(figures, true), make_eyeball(figures, false)};
  write_head(meshes, argv[2]);
  return 0;
} catch (const std::exception& error) {
  std::fprintf(stderr, "make_head: %s\n", error.what());
  return 1;
}
