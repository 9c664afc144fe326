#include "check/stillness.h"

#include <algorithm>
#include <limits>

namespace fascia::check {

std::vector<Stillness> stillness(const Head& head, const Shape& shape, double below) {
  const auto height = [&](const char* name, double otherwise) {
    const auto at = head.landmarks.find(name);
    return at == head.landmarks.end() ? otherwise : at->second.y();
  };
  constexpr double infinite = std::numeric_limits<double>::infinity();
  // A beard and the hair of the temples go with the skin they stand on.
  constexpr double over_hairline = 0.02;  // metres: at the hairline it goes with a raised brow
  const double scalp = height("trichion", height("glabella", infinite)) + over_hairline,
               neck = height("gnathion", -infinite) - below;
  std::vector<Stillness> all;
  const auto add = [&](const char* name, size_t part, auto belongs) {
    Stillness* found = nullptr;
    for (Stillness& one : all)
      if (one.name == name) found = &one;
    const std::vector<Vec3>& rest = head.parts[part].mesh.vertices;
    for (size_t v = 0; v < rest.size(); ++v) {
      if (!belongs(rest[v])) continue;
      if (!found) found = &all.emplace_back(Stillness{name, 0.0, rest[v]});
      const double moved = (shape[part][v] - rest[v]).norm();
      if (moved <= found->most) continue;
      found->most = moved;
      found->place = shape[part][v];
    }
  };
  for (size_t p = 0; p < head.parts.size(); ++p) {
    const std::string& name = head.parts[p].name;
    if (name == "hair") add("hair", p, [&](const Vec3& v) { return v.y() > scalp; });
    if (name == "glasses") add("glasses", p, [](const Vec3&) { return true; });
    if (name == "clothes") add("clothes", p, [](const Vec3&) { return true; });
    if (name == "skin") add("neck", p, [&](const Vec3& v) { return v.y() < neck; });
  }
  return all;
}

}  // namespace fascia::check
