#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "gltf/edit/appendix.h"
#include "gltf/edit/element.h"

namespace fascia::gltf {

/// Numbers of an accessor as they are stored: normalised integers stay integers.
struct RawNumbers {
  std::vector<double> values;  ///< #elements x `width`, one element after the other
  std::size_t width = 1;       ///< numbers in an element
  int component = float32;

  std::size_t count() const { return values.size() / width; }
  double* at(std::size_t element) { return &values[element * width]; }
  const double* at(std::size_t element) const { return &values[element * width]; }
};

/// The numbers of an accessor of scalars or vectors of a joined document, sparse values applied; nothing
/// unless it has `count` elements, so that no memory is taken for a count that only the file vouches for.
/// Throws fascia::Error when a range is out of bounds, nlohmann::json::exception when the JSON is incomplete.
std::optional<RawNumbers> raw_numbers(const Json& root, std::span<const uint8_t> bin, std::size_t accessor,
                                      std::size_t count);

/// Appends `numbers` as a new accessor that is like accessor `like` of `root` (its component type, and bounds
/// where it has them), for a buffer view of `target`; returns its index. Of morph targets, which are zero in
/// most places, only the others are stored (`is_sparse`).
std::size_t append_like(const Json& root, Appendix& appendix, const RawNumbers& numbers, std::size_t like,
                        int target, bool is_sparse = false);

}  // namespace fascia::gltf
