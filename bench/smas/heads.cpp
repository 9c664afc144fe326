// The SMAS stage on heads with found landmarks: bench_smas_heads HEAD|embedded ...
// One line a head: processor time (median of five), shape of the triangles, how it lies between skin and
// bone.

#include <algorithm>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <vector>

#include "bench/smas/workload.h"
#include "builder/rigging/embedded_head.h"
#include "builder/rigging/find_landmarks.h"
#include "builder/rigging/stages.h"
#include "builder/smas/smas.h"
#include "geometry/error.h"

namespace {

using namespace fascia;

double quantile(std::vector<double> values, double share) {
  std::sort(values.begin(), values.end());
  return values[static_cast<size_t>(share * static_cast<double>(values.size() - 1))];
}

void run(const std::filesystem::path& file, const anatomy::GenericAnatomy& anatomy) {
  const rigging::FoundLandmarks found = rigging::find_landmarks(formats::read(file), {}, anatomy);
  const skull::FitResult skull = rigging::fit_skull(anatomy, found, 1.0);
  smas::Inputs inputs = smas::inputs_from(anatomy);
  inputs.skin = &found.head.skin;
  inputs.cranium = &skull.cranium;
  inputs.mandible = &skull.mandible;
  for (const auto& [name, landmark] : found.landmarks)
    inputs.landmarks[name] = landmark.position;
  std::vector<double> seconds;
  smas::Result smas;
  for (int repeat = 0; repeat < 5; ++repeat) {
    const double started = bench::processor_time();
    smas = smas::build(inputs);
    seconds.push_back(bench::processor_time() - started);
  }
  const auto millimetres = [](double metres) { return 1e3 * metres; };
  std::printf(
      "%-24s %7.0f skin triangles %7.3f s  %5d triangles  angle min %4.1f mean %4.1f  ratio %.3f  %zu loops  "
      "folds %d  outside %d  "
      "to skin %.2f/%.2f mm  to bone %.2f/%.2f mm (least/median)  %d centres  %ld evaluations\n",
      file.filename().c_str(), static_cast<double>(inputs.skin->triangle_count()), quantile(seconds, 0.5),
      smas.mesh.triangle_count(), smas.quality.min_angle, smas.quality.mean_min_angle,
      smas.quality.mean_radius_ratio, smas.boundary.size(), smas.folds, smas.outside_layers,
      millimetres(quantile(smas.skin_distance, 0.0)), millimetres(quantile(smas.skin_distance, 0.5)),
      millimetres(quantile(smas.bone_distance, 0.0)), millimetres(quantile(smas.bone_distance, 0.5)),
      smas.centres, smas.evaluations);
  std::fflush(stdout);
}

}  // namespace

int main(int count, char** arguments) {
  if (count < 2) {
    std::fprintf(stderr, "usage: bench_smas_heads HEAD|embedded ...\n");
    return 2;
  }
  const anatomy::GenericAnatomy anatomy = anatomy::load_generic();
  for (int i = 1; i < count; ++i)
    try {
      std::filesystem::path file = arguments[i];
      if (std::strcmp(arguments[i], "embedded") == 0) {
        file = std::filesystem::temp_directory_path() / "fascia_bench_smas_head.obj";
        rigging::write_embedded_head(
            file, std::filesystem::temp_directory_path() / "fascia_bench_smas_landmarks.json");
      }
      run(file, anatomy);
    } catch (const Error& error) {
      std::printf("%-24s %s\n", arguments[i], error.what());
    }
}
