#include "gltf/edit/raw_numbers.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <string>

#include "geometry/error.h"

namespace fascia::gltf {
namespace {

double number_at(const uint8_t* raw, int component) {
  const auto as = [raw](auto value) {
    std::memcpy(&value, raw, sizeof value);
    return static_cast<double>(value);
  };
  switch (component) {
    case int8:
      return as(int8_t{});
    case uint8:
      return as(uint8_t{});
    case int16:
      return as(int16_t{});
    case uint16:
      return as(uint16_t{});
    case uint32:
      return as(uint32_t{});
    default:
      return as(float{});
  }
}

void put_number(uint8_t* raw, int component, double value) {
  const auto as = [raw](auto number) { std::memcpy(raw, &number, sizeof number); };
  switch (component) {
    case int8:
      return as(static_cast<int8_t>(std::lround(value)));
    case uint8:
      return as(static_cast<uint8_t>(std::lround(value)));
    case int16:
      return as(static_cast<int16_t>(std::lround(value)));
    case uint16:
      return as(static_cast<uint16_t>(std::lround(value)));
    case uint32:
      return as(static_cast<uint32_t>(std::llround(value)));
    default:
      return as(static_cast<float>(value));
  }
}

void set_bounds(const RawNumbers& numbers, Json& accessor) {
  std::vector<double> low(numbers.width, 0.0), high(numbers.width, 0.0);
  for (size_t i = 0; i < numbers.values.size(); ++i) {
    const size_t k = i % numbers.width;
    low[k] = i < numbers.width ? numbers.values[i] : std::min(low[k], numbers.values[i]);
    high[k] = i < numbers.width ? numbers.values[i] : std::max(high[k], numbers.values[i]);
  }
  accessor["min"] = low;
  accessor["max"] = high;
}

std::vector<double> read_view(const Json& root, std::span<const uint8_t> bin, std::size_t index,
                              std::size_t offset, int component, std::size_t width, std::size_t count) {
  const Json& view = root.at("bufferViews").at(index);
  const std::size_t begin = view.value("byteOffset", std::size_t{0}),
                    length = view.at("byteLength").get<std::size_t>(), size = bytes_of(component),
                    element = size * width, stride = view.value("byteStride", element);
  if (size == 0) throw Error("an accessor has the unknown component type " + std::to_string(component));
  if (count > 0 &&
      (offset > length || stride > 65536 || element > length - offset ||
       (count - 1) * stride > length - offset - element || begin > bin.size() || length > bin.size() - begin))
    throw Error("an accessor reaches past the end of bufferView " + std::to_string(index));
  std::vector<double> values(count * width);
  for (std::size_t i = 0; i < values.size(); ++i)
    values[i] = number_at(&bin[begin + offset + i / width * stride + i % width * size], component);
  return values;
}

/// Elements of vertex attributes are aligned to four bytes (glTF 2.0, 3.6.2.4).
std::size_t append_view(Appendix& appendix, std::span<const double> values, std::size_t width, int component,
                        int target) {
  const std::size_t size = bytes_of(component), element = size * width,
                    stride = target == vertex_target ? (element + 3) / 4 * 4 : element;
  std::vector<uint8_t> bytes(values.size() / width * stride, 0);
  for (std::size_t i = 0; i < values.size(); ++i)
    put_number(&bytes[i / width * stride + i % width * size], component, values[i]);
  return appendix.add_view(bytes, target, stride == element ? 0 : stride);
}

void replace_sparse(const Json& root, std::span<const uint8_t> bin, const Json& sparse, RawNumbers& numbers) {
  const auto some = sparse.at("count").get<std::size_t>();
  if (some > numbers.count()) throw Error("a sparse accessor replaces more elements than it has");
  const Json &indices = sparse.at("indices"), &values = sparse.at("values");
  const std::vector<double> places =
      read_view(root, bin, indices.at("bufferView").get<std::size_t>(),
                indices.value("byteOffset", std::size_t{0}), indices.at("componentType").get<int>(), 1, some);
  const std::vector<double> replaced =
      read_view(root, bin, values.at("bufferView").get<std::size_t>(),
                values.value("byteOffset", std::size_t{0}), numbers.component, numbers.width, some);
  for (std::size_t i = 0; i < some; ++i) {
    if (!(places[i] >= 0.0 && places[i] < static_cast<double>(numbers.count())))
      throw Error("a sparse accessor names an element that is not there");
    std::copy_n(&replaced[i * numbers.width], numbers.width, numbers.at(static_cast<std::size_t>(places[i])));
  }
}

}  // namespace

std::optional<RawNumbers> raw_numbers(const Json& root, std::span<const uint8_t> bin, std::size_t accessor,
                                      std::size_t count) {
  const Json& json = root.at("accessors").at(accessor);
  if (json.at("count").get<std::size_t>() != count) return std::nullopt;
  RawNumbers numbers;
  numbers.width = components_of(json.at("type").get<std::string>());
  if (numbers.width == 0)
    throw Error("accessor " + std::to_string(accessor) + " is not of scalars or vectors");
  numbers.component = json.at("componentType").get<int>();
  if (json.contains("bufferView"))
    numbers.values =
        read_view(root, bin, json["bufferView"].get<std::size_t>(), json.value("byteOffset", std::size_t{0}),
                  numbers.component, numbers.width, count);
  else
    numbers.values.assign(count * numbers.width, 0.0);
  if (json.contains("sparse")) replace_sparse(root, bin, json["sparse"], numbers);
  return numbers;
}

std::size_t append_like(const Json& root, Appendix& appendix, const RawNumbers& numbers, std::size_t like,
                        int target, bool is_sparse) {
  Json accessor = root.at("accessors").at(like);
  for (const char* gone : {"bufferView", "byteOffset", "sparse"})
    accessor.erase(gone);
  accessor["count"] = numbers.count();
  std::vector<double> places, values;
  for (std::size_t i = 0; is_sparse && i < numbers.count(); ++i)
    if (std::any_of(numbers.at(i), numbers.at(i) + numbers.width, [](double x) { return x != 0.0; })) {
      places.push_back(static_cast<double>(i));
      values.insert(values.end(), numbers.at(i), numbers.at(i) + numbers.width);
    }
  if (!is_sparse || 2 * places.size() >= numbers.count()) {
    accessor["bufferView"] = append_view(appendix, numbers.values, numbers.width, numbers.component, target);
  } else if (!places.empty()) {
    accessor["sparse"] = {
        {"count", places.size()},
        {"indices", {{"bufferView", append_view(appendix, places, 1, uint32, 0)}, {"componentType", uint32}}},
        {"values", {{"bufferView", append_view(appendix, values, numbers.width, numbers.component, 0)}}}};
  }
  if (accessor.contains("min") || accessor.contains("max")) set_bounds(numbers, accessor);
  return appendix.add_accessor(std::move(accessor));
}

}  // namespace fascia::gltf
