#include "bench/muscles/measured.h"
#include "tests/paths/paths.h"

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

namespace fascia::bench {

namespace {

namespace fs = std::filesystem;

const fs::path data = test::measured_data() / "data";

double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return values.empty() ? 0.0 : values[values.size() / 2];
}

}  // namespace

void print_lengths(const muscles::Result& built) {
  struct Pair {
    const char* muscle;
    int fibre;
    const char* ours;
  };
  constexpr Pair pairs[] = {{"ZYG", 1, "zygomaticus_major_superior"},
                            {"LLS", 1, "levator_labii_superioris_medial"},
                            {"LLSAN", 1, "levator_labii_superioris_alaeque_nasi_labial"},
                            {"LLSAN", 2, "levator_labii_superioris_alaeque_nasi_alar"},
                            {"LAO", 1, "levator_anguli_oris"},
                            {"RIS", 1, "risorius"},
                            {"BUC", 1, "buccinator_upper"},
                            {"BUC", 2, "buccinator_lower"},
                            {"DAO", 1, "depressor_anguli_oris"},
                            {"DLI", 1, "depressor_labii_inferioris_medial"},
                            {"DLI", 2, "depressor_labii_inferioris_lateral"},
                            {"MENT", 1, "mentalis"},
                            {"OOM", 1, "orbicularis_oris_marginal_upper"},
                            {"OOM", 2, "orbicularis_oris_marginal_lower"},
                            {"OOP", 1, "orbicularis_oris_peripheral_upper"},
                            {"OOP", 2, "orbicularis_oris_peripheral_lower"}};
  std::ifstream stream(data / "artisynth/face_fibres_left_mm.json");
  if (!stream) return void(std::printf("published fibres are not at %s\n", data.c_str()));
  const nlohmann::json published = nlohmann::json::parse(stream);
  std::vector<std::pair<double, double>> lengths;  // theirs, ours; millimetres
  std::vector<double> ratios;
  for (const Pair& pair : pairs) {
    double theirs = 0.0, ours = 0.0;
    for (const auto& fibre : published)
      if (fibre["muscle"] == pair.muscle && fibre["fibre"] == pair.fibre) theirs = fibre["length_mm"];
    for (const muscles::Muscle& muscle : built.muscles)
      if (muscle.name == std::string(pair.ours) + "_left") ours = 1e3 * muscle.mean_length;
    lengths.emplace_back(theirs, ours);
    ratios.push_back(ours / theirs);
  }
  const double size = median(ratios);
  std::printf("Mean fibre lengths beside a published face's, whose size is 1 : %.2f of ours (median)\n",
              size);
  std::printf("%-48s %10s %10s %10s\n", "muscle", "published", "ours mm", "ratio");
  for (size_t k = 0; k < lengths.size(); ++k)
    std::printf("%-48s %10.1f %10.1f %10.2f%s\n", pairs[k].ours, lengths[k].first, lengths[k].second,
                ratios[k] / size, std::abs(ratios[k] / size - 1.0) > 0.25 ? "  outside 25 %" : "");
}

}  // namespace fascia::bench
