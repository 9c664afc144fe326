// Redraws Figures 4.1 to 4.12: draw_spline_figures FOLDER writes splines_4_01.png to splines_4_12.png.
#include <cstdio>
#include <exception>
#include <filesystem>

#include "tools/figures/drawing.h"

int main(int argc, char** argv) {
  using namespace fascia;
  if (argc != 2) return std::fputs("usage: draw_spline_figures FOLDER\n", stderr), 2;
  using Draw = view::Image (*)();
  const Draw draws[] = {figures::figure_4_1,  figures::figure_4_2,  figures::figure_4_3,
                        figures::figure_4_4,  figures::figure_4_5,  figures::figure_4_6,
                        figures::figure_4_7,  figures::figure_4_8,  figures::figure_4_9,
                        figures::figure_4_10, figures::figure_4_11, figures::figure_4_12};
  try {
    const std::filesystem::path folder = argv[1];
    std::filesystem::create_directories(folder);
    int number = 0;
    for (const Draw draw : draws) {
      char name[32];
      std::snprintf(name, sizeof name, "splines_4_%02d.png", ++number);
      view::write_png(folder / name, draw());
      std::printf("%s\n", (folder / name).c_str());
    }
  } catch (const std::exception& error) {
    std::fprintf(stderr, "draw_spline_figures: %s\n", error.what());
    return 1;
  }
}
