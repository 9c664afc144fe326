#include "gltf/edit/appendix.h"

#include <algorithm>
#include <cstring>
#include <string_view>

#include "gltf/edit/element.h"

namespace fascia::gltf {
namespace {

const char* element_type(std::size_t components) {
  constexpr const char* types[] = {"SCALAR", "VEC2", "VEC3", "VEC4"};
  return types[components - 1];
}

template <class T>
std::span<const uint8_t> as_bytes(std::span<const T> values) {
  return {reinterpret_cast<const uint8_t*>(values.data()), values.size_bytes()};
}

Json& array_of(Json& root, const char* name) {
  if (!root.contains(name)) root[name] = Json::array();
  return root[name];
}

void put_entry(Json& list, std::size_t number, Json entry) {
  if (number < list.size())
    list[number] = std::move(entry);
  else
    list.push_back(std::move(entry));
}

template <class T>
Json accessor_over(std::size_t view, int component_type, std::span<const T> numbers, std::size_t components,
                   bool bounds) {
  Json accessor = {{"bufferView", view},
                   {"componentType", component_type},
                   {"count", numbers.size() / components},
                   {"type", element_type(components)}};
  if (!bounds || numbers.empty()) return accessor;
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
  accessor["min"] = std::move(minimum);
  accessor["max"] = std::move(maximum);
  return accessor;
}

std::span<const float> flat(std::span<const Vec3f> vectors) {
  return {reinterpret_cast<const float*>(vectors.data()), 3 * vectors.size()};
}

}  // namespace

std::size_t Appendix::add_view(std::span<const uint8_t> bytes, int target, std::size_t stride) {
  const auto hash =
      std::hash<std::string_view>{}({reinterpret_cast<const char*>(bytes.data()), bytes.size()});
  Json& views = array_of(root_, "bufferViews");
  for (auto [at, end] = views_.equal_range(hash); at != end; ++at) {
    const Json& view = views[at->second];
    const std::size_t begin = view["byteOffset"];
    if (view["byteLength"] == bytes.size() && view.value("target", 0) == target &&
        view.value("byteStride", std::size_t{0}) == stride &&
        std::equal(bytes.begin(), bytes.end(), bin_.begin() + static_cast<std::ptrdiff_t>(begin)))
      return at->second;
  }
  const std::size_t begin = place_for(bytes.size());
  std::copy(bytes.begin(), bytes.end(), bin_.begin() + static_cast<std::ptrdiff_t>(begin));
  Json view = {{"buffer", 0}, {"byteOffset", begin}, {"byteLength", bytes.size()}};
  if (stride != 0) view["byteStride"] = stride;
  if (target != 0) view["target"] = target;
  const std::size_t number = free_entry(free_views_, views);
  put_entry(views, number, std::move(view));
  views_.emplace(hash, number);
  return number;
}

/// Where `size` bytes go: the smallest free room they fit in, aligned to eight, or the end of the file.
std::size_t Appendix::place_for(std::size_t size) {
  const auto begin_in = [](const ByteRange& room) { return (room.begin + 7) / 8 * 8; };
  const auto fits = [&](const ByteRange& room) { return begin_in(room) + size <= room.end; };
  auto best = free_bytes_.end();
  for (auto room = free_bytes_.begin(); room != free_bytes_.end(); ++room)
    if (fits(*room) && (best == free_bytes_.end() || room->size() < best->size())) best = room;
  if (best != free_bytes_.end()) {
    const std::size_t begin = begin_in(*best);
    best->begin = begin + size;
    return begin;
  }
  const std::size_t begin = (bin_.size() + 7) / 8 * 8;
  bin_.resize(begin + size, 0);
  return begin;
}

/// The number of an entry of `list` that may be overwritten, or of one to be put behind the last.
std::size_t Appendix::free_entry(std::vector<std::size_t>& free, const Json& list) {
  if (free.empty()) return list.size();
  const std::size_t number = free.back();
  free.pop_back();
  return number;
}

std::size_t Appendix::add_accessor(Json accessor) {
  Json& accessors = array_of(root_, "accessors");
  const std::string text = accessor.dump();
  if (const auto known = accessors_.find(text); known != accessors_.end()) return known->second;
  const std::size_t number = free_entry(free_accessors_, accessors);
  put_entry(accessors, number, std::move(accessor));
  accessors_.emplace(text, number);
  return number;
}

void Appendix::give_back(std::size_t accessor) {
  if (uses_of(root_, accessor) > 0) return;
  const OwnRoom own = own_room(root_, accessor);
  for (const ByteRange& bytes : own.bytes) {
    // Neighbours become one room.
    const auto before = std::find_if(free_bytes_.begin(), free_bytes_.end(),
                                     [&](const ByteRange& room) { return room.end == bytes.begin; });
    if (before != free_bytes_.end())
      before->end = bytes.end;
    else
      free_bytes_.push_back(bytes);
  }
  for (const std::size_t view : own.views) {
    root_["bufferViews"][view] = {{"buffer", 0}, {"byteOffset", 0}, {"byteLength", 1}};
    free_views_.push_back(view);
  }
  root_["accessors"][accessor] = {{"componentType", float32}, {"count", 1}, {"type", element_type(1)}};
  free_accessors_.push_back(accessor);
}

std::size_t Appendix::add_floats(std::span<const float> numbers, std::size_t components, bool bounds,
                                 int target) {
  return add_accessor(
      accessor_over(add_view(as_bytes(numbers), target), float32, numbers, components, bounds));
}

std::size_t Appendix::add_whole(std::span<const uint32_t> numbers, std::size_t components) {
  const uint32_t greatest = *std::max_element(numbers.begin(), numbers.end());
  // The greatest value of a type is kept free: in index accessors it means primitive restart.
  if (greatest < UINT8_MAX) {
    const std::vector<uint8_t> bytes(numbers.begin(), numbers.end());
    return add_accessor(
        accessor_over(add_view(bytes), uint8, std::span<const uint8_t>(bytes), components, true));
  }
  if (greatest < UINT16_MAX) {
    const std::vector<uint16_t> words(numbers.begin(), numbers.end());
    const std::span<const uint16_t> span(words);
    return add_accessor(accessor_over(add_view(as_bytes(span)), uint16, span, components, true));
  }
  return add_accessor(accessor_over(add_view(as_bytes(numbers)), uint32, numbers, components, true));
}

std::size_t Appendix::add_indices(std::span<const uint32_t> corners) {
  const uint32_t greatest = corners.empty() ? 0 : *std::max_element(corners.begin(), corners.end());
  if (greatest < UINT16_MAX) {
    const std::vector<uint16_t> words(corners.begin(), corners.end());
    const std::span<const uint16_t> span(words);
    return add_accessor(accessor_over(add_view(as_bytes(span), index_target), uint16, span, 1, false));
  }
  return add_accessor(accessor_over(add_view(as_bytes(corners), index_target), uint32, corners, 1, false));
}

std::size_t Appendix::add_sparse(std::span<const Vec3f> vectors, const std::vector<uint32_t>& moved,
                                 bool bounds) {
  std::vector<Vec3f> values;
  Vec3f low = Vec3f::Zero(), high = low;
  for (const uint32_t v : moved) {
    values.push_back(vectors[v]);
    low = low.cwiseMin(vectors[v]);
    high = high.cwiseMax(vectors[v]);
  }
  const bool is_short = vectors.size() <= UINT16_MAX;
  const std::vector<uint16_t> words(moved.begin(), moved.end());
  const std::size_t index_view =
      is_short ? add_view(as_bytes(std::span<const uint16_t>(words))) : add_view(as_bytes(std::span(moved)));
  const std::size_t value_view = add_view(as_bytes(flat(values)));
  Json accessor = {{"componentType", float32}, {"count", vectors.size()}, {"type", "VEC3"}};
  if (bounds) {
    accessor["min"] = {low[0], low[1], low[2]};
    accessor["max"] = {high[0], high[1], high[2]};
  }
  accessor["sparse"] = {
      {"count", moved.size()},
      {"indices", {{"bufferView", index_view}, {"componentType", is_short ? uint16 : uint32}}},
      {"values", {{"bufferView", value_view}}}};
  return add_accessor(std::move(accessor));
}

std::size_t Appendix::add_vectors(std::span<const Vec3f> vectors, bool bounds) {
  std::vector<uint32_t> moved;
  for (std::size_t v = 0; v < vectors.size(); ++v)
    if (!vectors[v].isZero(0)) moved.push_back(static_cast<uint32_t>(v));
  const std::size_t index_size = vectors.size() <= UINT16_MAX ? 2 : 4;
  if (moved.size() * (12 + index_size) >= 12 * vectors.size())
    return add_floats(flat(vectors), 3, bounds, vertex_target);
  if (moved.empty()) moved.push_back(0);
  return add_sparse(vectors, moved, bounds);
}

}  // namespace fascia::gltf
