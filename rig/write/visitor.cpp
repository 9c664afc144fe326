#include "rig/write/visitor.h"

#include <charconv>
#include <cstdio>
#include <cstring>

namespace fascia::rig {
namespace {

constexpr int component_float = 5126, component_byte = 5121, component_short = 5123, component_int = 5125;

const char* element_type(std::size_t components) {
  constexpr const char* types[] = {"SCALAR", "VEC2", "VEC3", "VEC4"};
  return types[components - 1];
}

template <class T>
std::span<const uint8_t> as_bytes(const std::vector<T>& values) {
  return {reinterpret_cast<const uint8_t*>(values.data()), values.size() * sizeof(T)};
}

Json& array_of(Json& root, const char* name) {
  if (!root.contains(name)) root[name] = Json::array();
  return root[name];
}

template <class T>
std::size_t add_accessor(Json& root, std::size_t view, int component_type, std::span<const T> numbers,
                         std::size_t components) {
  Json minimum = Json::array(), maximum = Json::array();
  for (std::size_t k = 0; k < components; ++k) {
    T least = numbers[k], most = numbers[k];
    for (std::size_t i = k; i < numbers.size(); i += components) {
      least = std::min(least, numbers[i]);
      most = std::max(most, numbers[i]);
    }
    minimum.push_back(least);
    maximum.push_back(most);
  }
  Json accessor = {{"bufferView", view},
                   {"componentType", component_type},
                   {"count", numbers.size() / components},
                   {"type", element_type(components)}};
  accessor["min"] = std::move(minimum);
  accessor["max"] = std::move(maximum);
  Json& accessors = array_of(root, "accessors");
  accessors.push_back(std::move(accessor));
  return accessors.size() - 1;
}

}  // namespace

double shortest(float value) {
  char text[32];
  const auto end = std::to_chars(text, text + sizeof text, value).ptr;
  double result = 0;
  std::from_chars(text, end, result);
  return result;
}

std::size_t Appendix::add_view(std::span<const uint8_t> bytes) {
  bin_.resize((bin_.size() + 7) / 8 * 8, 0);
  Json& views = array_of(root_, "bufferViews");
  views.push_back({{"buffer", 0}, {"byteOffset", bin_.size()}, {"byteLength", bytes.size()}});
  bin_.insert(bin_.end(), bytes.begin(), bytes.end());
  return views.size() - 1;
}

std::size_t Appendix::add_floats(std::span<const float> numbers, std::size_t components) {
  const std::size_t view = add_view({reinterpret_cast<const uint8_t*>(numbers.data()), numbers.size_bytes()});
  return add_accessor(root_, view, component_float, numbers, components);
}

std::size_t Appendix::add_whole(std::span<const uint32_t> numbers, std::size_t components) {
  const uint32_t greatest = *std::max_element(numbers.begin(), numbers.end());
  // The greatest value of a type is kept free: in index accessors it means primitive restart.
  if (greatest < UINT8_MAX) {
    const std::vector<uint8_t> bytes(numbers.begin(), numbers.end());
    return add_accessor(root_, add_view(as_bytes(bytes)), component_byte, numbers, components);
  }
  if (greatest < UINT16_MAX) {
    const std::vector<uint16_t> words(numbers.begin(), numbers.end());
    return add_accessor(root_, add_view(as_bytes(words)), component_short, numbers, components);
  }
  const std::size_t view = add_view({reinterpret_cast<const uint8_t*>(numbers.data()), numbers.size_bytes()});
  return add_accessor(root_, view, component_int, numbers, components);
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
