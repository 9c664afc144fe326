#include "geometry/nearest_names.h"

#include <algorithm>
#include <cctype>

namespace fascia {

namespace {

/// Lower case, without separators.
std::string plain(const std::string& name) {
  std::string text;
  for (const char c : name)
    if (std::string("-_.: ").find(c) == std::string::npos)
      text += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return text;
}

/// Insertions, deletions, substitutions and swaps of neighbours that turn one word into the other.
size_t alignment_distance(const std::string& a, const std::string& b) {
  std::vector<std::vector<size_t>> cost(a.size() + 1, std::vector<size_t>(b.size() + 1));
  for (size_t i = 0; i <= a.size(); ++i)
    for (size_t j = 0; j <= b.size(); ++j) {
      if (i == 0 || j == 0) {
        cost[i][j] = i + j;
        continue;
      }
      cost[i][j] = std::min({cost[i - 1][j] + 1, cost[i][j - 1] + 1,
                             cost[i - 1][j - 1] + (a[i - 1] == b[j - 1] ? size_t{0} : size_t{1})});
      if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1])
        cost[i][j] = std::min(cost[i][j], cost[i - 2][j - 2] + 1);
    }
  return cost[a.size()][b.size()];
}

}  // namespace

std::vector<std::string> nearest_names(const std::string& name, const std::vector<std::string>& known,
                                       size_t most) {
  constexpr size_t longest = 200;  // what is longer is no misspelt name
  const std::string wanted = plain(name);
  if (wanted.empty() || wanted.size() > longest) return {};
  std::vector<std::pair<size_t, std::string>> near;
  for (const std::string& candidate : known) {
    const std::string word = plain(candidate);
    size_t distance = alignment_distance(wanted, word);
    const size_t shorter = std::min(wanted.size(), word.size());
    const bool contains =
        shorter >= 3 && (word.find(wanted) != std::string::npos || wanted.find(word) != std::string::npos);
    // A part of a name is a better guess than a word with every third letter wrong, a worse one than a typo.
    if (contains) distance = std::min<size_t>(distance, 2);
    if (contains || distance <= std::max<size_t>(1, wanted.size() / 3))
      near.emplace_back(distance, candidate);
  }
  std::stable_sort(near.begin(), near.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  std::vector<std::string> names;
  for (size_t i = 0; i < near.size() && i < most; ++i)
    names.push_back(near[i].second);
  return names;
}

std::string did_you_mean(const std::string& name, const std::vector<std::string>& known, size_t most) {
  const std::vector<std::string> names = nearest_names(name, known, most);
  std::string text;
  for (size_t i = 0; i < names.size(); ++i)
    text += (i == 0 ? "" : i + 1 == names.size() ? " or " : ", ") + ("'" + names[i] + "'");
  return text.empty() ? "" : " (did you mean " + text + "?)";
}

}  // namespace fascia
