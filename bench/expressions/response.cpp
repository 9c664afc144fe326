#include "bench/expressions/response.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <cstdio>
#include <map>
#include <thread>

namespace fascia::bench {
namespace {

constexpr std::array<double, 4> weights = {0.1, 0.25, 0.5, 0.75};
using Way = std::array<double, weights.size()>;

/// By shape: share of the way at each weight; of a corrective, of what it adds to the shape it corrects.
std::map<std::string, Way> ways_of(const SculptedHead& head, const anatomy::ExpressionSet& table,
                                   const std::string& level) {
  std::map<std::string, Way> ways;
  KnownFace face(head, level);
  for (const auto& [name, shape] : face.shapes()) {
    if (table.find(name) == nullptr) continue;
    const auto added = [&, name = name, values = shape.values](double weight) {
      std::map<std::string, double> with = values, without;
      for (auto& [member, value] : with) {
        value *= weight;
        if (member != name) without[member] = value;
      }
      Eigen::VectorXd moved = face.pose(face.activations(table, with));
      if (!without.empty()) moved -= face.pose(face.activations(table, without));
      return moved;
    };
    const Eigen::VectorXd whole = added(1.0);
    if (whole.squaredNorm() < 1e-12) continue;
    for (size_t w = 0; w < weights.size(); ++w)
      ways[name][w] = added(weights[w]).dot(whole) / whole.squaredNorm();
  }
  return ways;
}

}  // namespace

void run_response(const std::vector<SculptedHead>& heads, const anatomy::ExpressionSet& table,
                  const std::string& level, int threads) {
  std::vector<std::map<std::string, Way>> by_head(heads.size());
  std::vector<std::string> failures(heads.size());
  std::atomic<size_t> next = 0;
  const auto work = [&] {
    for (size_t h = next++; h < heads.size(); h = next++) {
      try {
        by_head[h] = ways_of(heads[h], table, level);
      } catch (const std::exception& error) {
        failures[h] = error.what();
      }
    }
  };
  std::vector<std::thread> others;
  for (int i = 1; i < threads; ++i)
    others.emplace_back(work);
  work();
  for (std::thread& thread : others)
    thread.join();
  for (size_t h = 0; h < heads.size(); ++h)
    if (!failures[h].empty()) std::printf("%s: %s\n", heads[h].name.c_str(), failures[h].c_str());
  std::map<std::string, Way> sums;
  std::map<std::string, int> counts;
  std::map<std::string, double> worst;  ///< of a head, from its weight
  for (const auto& ways : by_head)
    for (const auto& [name, way] : ways) {
      ++counts[name];
      for (size_t w = 0; w < way.size(); ++w)
        sums[name][w] += way[w], worst[name] = std::max(worst[name], std::abs(way[w] - weights[w]));
    }
  std::printf("%-20s", "share of the way at");
  for (const double w : weights)
    std::printf(" %6.2f", w);
  std::printf("  worst head\n");
  Way mean{}, apart{};
  std::array<int, weights.size()> within{};
  for (auto& [name, sum] : sums) {
    std::printf("%-20s", name.c_str());
    for (size_t w = 0; w < sum.size(); ++w) {
      const double way = sum[w] / counts[name], off = std::abs(way - weights[w]);
      mean[w] += way / static_cast<double>(sums.size());
      apart[w] = std::max(apart[w], off);
      within[w] += off <= 0.05 ? 1 : 0;
      std::printf(" %6.3f", way);
    }
    std::printf("  %6.3f\n", worst[name]);
  }
  std::printf("%-20s", "mean");
  for (const double value : mean)
    std::printf(" %6.3f", value);
  std::printf("\n%-20s", "largest distance");
  for (const double value : apart)
    std::printf(" %6.3f", value);
  std::printf("\nwithin .05 of %zu   ", sums.size());
  for (const int count : within)
    std::printf(" %6d", count);
  std::printf("\n");
}

}  // namespace fascia::bench
