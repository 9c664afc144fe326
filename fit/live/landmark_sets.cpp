#include "fit/live/landmark_sets.h"

#include <nlohmann/json.hpp>

namespace fascia::fit {

extern const std::string_view landmark_set_text;

std::vector<LandmarkSet> landmark_sets() {
  std::vector<LandmarkSet> found;
  const nlohmann::json table = nlohmann::json::parse(landmark_set_text);
  for (const auto& set : table["sets"]) {
    LandmarkSet entry;
    entry.name = set["name"].get<std::string>();
    entry.points = set["points"].get<size_t>();
    for (const auto& [landmark, points] : set["landmarks"].items())
      entry.entries.push_back({landmark, points.get<std::vector<uint32_t>>()});
    found.push_back(std::move(entry));
  }
  return found;
}

std::optional<LandmarkSet> find_landmark_set(std::string_view name) {
  for (LandmarkSet& set : landmark_sets())
    if (set.name == name) return std::move(set);
  return std::nullopt;
}

}  // namespace fascia::fit
