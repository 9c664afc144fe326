#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <type_traits>

#include "rig/model/rig.h"

namespace fascia::rig {

/// How one element of a list lies in an accessor: its scalar and how many of them.
///
/// glTF forbids infinity in accessors: the file's largest finite float stands for it, both ways.
template <class T>
struct Element {
  using Scalar =
      typename std::conditional_t<std::is_enum_v<T>, std::underlying_type<T>, std::type_identity<T>>::type;
  static constexpr std::size_t components = 1;
  static bool finite(T value) { return std::isfinite(value); }
  static void open_bounds(T& value) {
    if constexpr (std::is_floating_point_v<T>)
      if (value == std::numeric_limits<T>::max()) value = std::numeric_limits<T>::infinity();
  }
};

template <>
struct Element<Vec3f> {
  using Scalar = float;
  static constexpr std::size_t components = 3;
  static bool finite(const Vec3f& value) {
    return std::isfinite(value.x()) && std::isfinite(value.y()) && std::isfinite(value.z());
  }
  static void open_bounds(Vec3f&) {}
};

template <std::size_t N>
struct Element<std::array<uint32_t, N>> {
  using Scalar = uint32_t;
  static constexpr std::size_t components = N;
};

}  // namespace fascia::rig
