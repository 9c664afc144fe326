#include "bench/heads/reference.h"

#include <algorithm>
#include <cstdio>
#include <map>

#include "anatomy/checks.h"
#include "check/check.h"
#include "check/scale.h"
#include "tests/check/sculpted.h"

namespace fascia::bench {

int print_reference() {
  const anatomy::Checks checks = anatomy::load_checks();
  const std::vector<testing::SculptedHead> heads = testing::sculpted_heads();
  std::vector<std::string> names;
  std::map<std::string, std::vector<std::string>> cells;
  std::map<std::string, std::pair<double, double>> extremes;
  int failures = 0;
  std::printf("%-28s", "");
  for (const testing::SculptedHead& head : heads)
    std::printf(" %12.12s", head.name.c_str());
  std::printf("\n");
  for (const auto& [name, part] :
       {std::pair("face mm", &check::AdultSizes::face), std::pair("mouth mm", &check::AdultSizes::mouth),
        std::pair("eye mm", &check::AdultSizes::eye)}) {
    std::printf("%-28s", name);
    for (const testing::SculptedHead& head : heads)
      std::printf(" %12.2f", 1e3 * check::distances(head.head.landmarks).*part);
    std::printf("\n");
  }
  for (size_t h = 0; h < heads.size(); ++h) {
    for (const check::Row& row : check::run(heads[h].head, heads[h].player, checks)) {
      auto& line = cells[row.name];
      if (line.empty()) names.push_back(row.name);
      line.resize(heads.size());
      char text[32];
      std::snprintf(text, sizeof text, "%.2f%s", row.value, row.ok ? "" : "!");
      line[h] = text;
      failures += !row.ok;
      auto [at, is_new] = extremes.try_emplace(row.name, row.value, row.value);
      at->second = {std::min(at->second.first, row.value), std::max(at->second.second, row.value)};
      if (!row.ok)
        std::printf("%s: %s %.2f in %s\n", heads[h].name.c_str(), row.name.c_str(), row.value,
                    row.pose.c_str());
    }
  }
  for (const std::string& name : names) {
    std::printf("%-28s", name.c_str());
    for (const std::string& cell : cells[name])
      std::printf(" %12s", cell.c_str());
    std::printf("   %.2f .. %.2f\n", extremes[name].first, extremes[name].second);
  }
  return failures;
}

}  // namespace fascia::bench
