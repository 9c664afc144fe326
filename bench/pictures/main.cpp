// Processor time of one picture of a rig, as the window draws it in motion and at rest, and as films and
// stills are drawn: bench_pictures RIG.glb [WIDTH HEIGHT]
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <vector>

#include "cli/picture.h"
#include "formats/files.h"
#include "rig/read/read.h"
#include "view/renderer.h"

namespace {

using fascia::Vec3;
using fascia::view::Look;

double processor_ms() {
  return 1e3 * static_cast<double>(std::clock()) / CLOCKS_PER_SEC;  // of all threads
}

struct Case {
  const char* name;
  bool has_shadows, has_occlusion;
  int samples;
  double resolution = 1.0;
};
constexpr Case cases[] = {{"window, in motion, smaller", false, false, 1, 0.75},
                          {"window, in motion", false, false, 1},
                          {"window, in motion, larger", false, false, 2},
                          {"window, with shadows", true, false, 2},
                          {"film", true, true, 2},
                          {"still", true, true, 8}};

}  // namespace

int main(int count, char** words) {
  if (count < 2) return std::puts("bench_pictures RIG.glb [WIDTH HEIGHT]"), 2;
  const int width = count > 3 ? std::atoi(words[2]) : 826, height = count > 3 ? std::atoi(words[3]) : 600;
  const fascia::rig::RigFile file = fascia::rig::read(fascia::formats::read_bytes(words[1]), words[1]);
  fascia::cli::Face face(words[1], {FASCIA_SPACE_METRES, "own", ""});
  const fascia::view::FaceView what;
  const fascia::view::Renderer renderer(width, height);
  const fascia::view::DrawList list = fascia::cli::draw_face(face, file.rig, what);
  fascia::Bounds box;
  for (const fascia::view::DrawSurface& surface : list.surfaces)
    for (const Vec3& p : surface.positions) {
      box.lower = box.lower.cwiseMin(p);
      box.upper = box.upper.cwiseMax(p);
    }
  fascia::view::Camera camera = fascia::view::named_camera("front", box, 0.82);
  std::printf("%d x %d, processor time of all threads, the median of nine\n", width, height);
  const auto median_of = [](const auto& work) {
    std::vector<double> times;
    for (int i = 0; i < 10; ++i) {
      const double before = processor_ms();
      work(i);
      if (i > 0) times.push_back(processor_ms() - before);  // the first one compiles and copies
    }
    std::sort(times.begin(), times.end());
    return times[times.size() / 2];
  };
  std::printf("%-26s %7.1f ms\n", "list of what to draw",
              median_of([&](int) { fascia::cli::draw_face(face, file.rig, what); }));
  for (const Case& one : cases) {
    Look look;
    look.has_shadows = one.has_shadows;
    look.has_occlusion = one.has_occlusion;
    look.has_mirrors = one.samples > 1;
    look.samples = one.samples;
    look.has_backdrop = true;
    look.resolution = one.resolution;
    std::printf("%-26s %7.1f ms\n", one.name, median_of([&](int i) {
                  camera.yaw = 3.0 * i;
                  renderer.draw_with(list, camera, look);
                }));
  }
  return 0;
}
