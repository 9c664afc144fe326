#include "rig/write/visitor.h"

#include <charconv>
#include <cstdio>

namespace fascia::rig {
double shortest(float value) {
  char text[32];
  const auto end = std::to_chars(text, text + sizeof text, value).ptr;
  double result = 0;
  std::from_chars(text, end, result);
  return result;
}

void Writer::hash(const char* name, uint64_t value) {
  char digits[17];
  std::snprintf(digits, sizeof digits, "%016llx", static_cast<unsigned long long>(value));
  json[name] = digits;
}

void Writer::numbers(const char* name, std::span<const float> values) {
  Json& array = json[name] = Json::array();
  for (const float value : values) {
    if (!std::isfinite(value)) fail(name, "not a finite number");
    array.push_back(shortest(value));
  }
}

}  // namespace fascia::rig
