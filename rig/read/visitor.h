#pragma once

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "geometry/error.h"
#include "gltf/read/accessors.h"
#include "rig/model/element.h"
#include "rig/model/fields.h"

namespace fascia::rig {

/// Reads the fields of rig/model/fields.h from one JSON object and the accessors it names. What the object
/// leaves out keeps its default, or stays empty.
class Reader {
 public:
  /// `object` may be null JSON: then every field is left out. `path` begins each message.
  Reader(const tinygltf::Model& model, const tinygltf::Value& object, std::string path)
      : model_(model), object_(object), path_(std::move(path)) {
    if (object_.Type() != tinygltf::NULL_TYPE && !object_.IsObject()) throw Error(path_ + ": not an object");
  }

  void text(const char* name, std::string& value) {
    if (!has(name)) return;
    if (!object_.Get(name).IsString()) fail(name, "not a text");
    value = object_.Get(name).Get<std::string>();
  }

  template <class T>
  void number(const char* name, T& value) {
    if (has(name)) value = checked_number<T>(object_.Get(name), name);
  }

  void bounded(const char* name, double& value, double least, double most) {
    if (!has(name)) fail(name, "missing");
    number(name, value);
    if (!(value >= least && value <= most)) fail_bounds(name, value, least, most);
  }

  void hash(const char* name, uint64_t& value);
  void vector(const char* name, Vec3f& value) { numbers(name, value.data(), 3); }
  void matrix(const char* name, Mat4f& value) { numbers(name, value.data(), 16); }

  template <class Enum>
  void choice(const char* name, Enum& value, std::span<const std::string_view> names) {
    std::string word;
    text(name, word);
    if (word.empty()) return;
    for (std::size_t i = 0; i < names.size(); ++i)
      if (names[i] == word) {
        value = static_cast<Enum>(i);
        return;
      }
    fail(name, "unknown value \"" + word + "\"");
  }

  template <class Body>
  void object(const char* name, const Body& body) {
    Reader inner(model_, object_.IsObject() ? object_.Get(name) : object_, at(name));
    body(inner);
  }

  template <class T, class Body>
  void array(const char* name, std::vector<T>& list, const Body& body) {
    if (!has(name)) return;
    const tinygltf::Value& values = object_.Get(name);
    if (!values.IsArray()) fail(name, "not an array");
    list.resize(values.ArrayLen());
    for (std::size_t i = 0; i < list.size(); ++i) {
      Reader inner(model_, values.Get(i), at(name) + "/" + std::to_string(i));
      body(inner, list[i], i);
    }
  }

  template <class T>
  void list(const char* name, std::vector<T>& values, std::size_t length) {
    floats(name, values, length);
    if (all_finite(reinterpret_cast<const float*>(values.data()), values.size() * Element<T>::components))
      return;
    for (std::size_t i = 0; i < values.size(); ++i)
      if (!Element<T>::finite(values[i]))
        fail(name, "element " + std::to_string(i) + " is not a finite number");
  }

  template <class T>
  void unbounded(const char* name, std::vector<T>& values, std::size_t length) {
    floats(name, values, length);
    for (T& value : values)
      Element<T>::open_bounds(value);
  }

  template <class T>
  void index(const char* name, std::vector<T>& values, std::size_t length, std::size_t limit) {
    const gltf::AccessorView view = accessor(name, Element<T>::components, length);
    switch (view.count == 0 ? 0 : view.component_type) {
      case 0:
        return;
      case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
        return whole_numbers<uint8_t>(name, view, values, limit);
      case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
        return whole_numbers<uint16_t>(name, view, values, limit);
      case TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT:
        return whole_numbers<uint32_t>(name, view, values, limit);
      default:
        fail(name, "its accessor does not hold unsigned whole numbers");
    }
  }

  void offsets(const char* name, std::vector<uint32_t>& values, std::size_t length) {
    // The offsets of no runs at all may be left out.
    if (length == 1 && !has(name)) {
      values = {0};
      return;
    }
    index(name, values, length, any);
    for (std::size_t i = 0; i < values.size(); ++i)
      if (values[i] < (i == 0 ? 0 : values[i - 1]) || (i == 0 && values[i] != 0))
        fail(name, "offsets must begin at 0 and never fall; entry " + std::to_string(i) + " does");
  }

  void triangles(const char* name, std::vector<Triangle>& triangles, std::size_t limit) {
    std::vector<uint32_t> corners;
    index(name, corners, any, limit);
    if (corners.size() % 3 != 0) fail(name, "its length is no multiple of three");
    triangles.resize(corners.size() / 3);
    if (!corners.empty()) std::memcpy(triangles.data(), corners.data(), corners.size() * sizeof(uint32_t));
  }

  void texts(const char* name, std::vector<std::string>& values);

  template <class T>
  void names(const char* name, std::vector<T>& list, std::string T::*member) {
    std::vector<std::string> values;
    texts(name, values);
    list.resize(values.size());
    for (std::size_t i = 0; i < values.size(); ++i)
      list[i].*member = std::move(values[i]);
  }

  template <class T, class M>
  void column(const char* name, std::vector<T>& elements, M T::*member) {
    std::vector<M> values;
    list(name, values, elements.size());
    for (std::size_t i = 0; i < values.size(); ++i)
      elements[i].*member = values[i];
  }

  bool has(const char* name) const { return object_.IsObject() && object_.Has(name); }
  std::string at(const std::string& name) const { return path_ + "/" + name; }
  [[noreturn]] void fail(const std::string& name, const std::string& what) const {
    throw Error(at(name) + ": " + what);
  }

 private:
  [[noreturn]] void fail_bounds(const char* name, double value, double least, double most) const;

  template <class T>
  T checked_number(const tinygltf::Value& value, const char* name) const {
    if (!value.IsNumber()) fail(name, "not a number");
    const double number = value.GetNumberAsDouble();
    if constexpr (std::is_integral_v<T>) {
      const auto least = static_cast<double>(std::numeric_limits<T>::min());
      const auto most = static_cast<double>(std::numeric_limits<T>::max());
      if (!(number >= least && number <= most) || std::floor(number) != number)
        fail(name, "not a whole number in range");
    } else if (!std::isfinite(static_cast<T>(number))) {
      fail(name, "not a finite number");
    }
    return static_cast<T>(number);
  }

  void numbers(const char* name, float* to, std::size_t count);

  /// True when no exponent is all ones: in one pass that vectorises.
  static bool all_finite(const float* values, std::size_t count) {
    constexpr uint32_t exponent = 0x7F800000U;
    uint32_t unsound = 0;
    for (std::size_t i = 0; i < count; ++i) {
      uint32_t bits;
      std::memcpy(&bits, values + i, sizeof bits);
      unsound |= static_cast<uint32_t>((bits & exponent) == exponent);
    }
    return unsound == 0;
  }

  template <class T>
  void floats(const char* name, std::vector<T>& values, std::size_t length) {
    const gltf::AccessorView view = accessor(name, Element<T>::components, length);
    if (view.count == 0) return;
    if (view.component_type != TINYGLTF_COMPONENT_TYPE_FLOAT) fail(name, "its accessor does not hold floats");
    values.resize(view.count);
    auto* to = reinterpret_cast<uint8_t*>(values.data());
    if (view.stride == sizeof(T)) {
      std::memcpy(to, view.data, view.count * sizeof(T));
      return;
    }
    for (std::size_t i = 0; i < view.count; ++i)
      std::memcpy(to + i * sizeof(T), view.data + i * view.stride, sizeof(T));
  }

  /// The accessor property `name` points at; of count 0 when it is left out. Checks shape and length.
  gltf::AccessorView accessor(const char* name, std::size_t components, std::size_t length);

  template <class Stored, class T>
  void whole_numbers(const char* name, const gltf::AccessorView& view, std::vector<T>& values,
                     std::size_t limit) {
    values.resize(view.count);
    using Scalar = typename Element<T>::Scalar;
    auto* to = reinterpret_cast<Scalar*>(values.data());
    constexpr std::size_t n = Element<T>::components;
    Stored greatest = 0;
    // Rows of one element each, or all in one row when they lie end to end.
    const bool packed = view.stride == n * sizeof(Stored);
    const std::size_t rows = packed ? 1 : view.count, row = packed ? view.count * n : n;
    for (std::size_t r = 0; r < rows; ++r, to += row) {
      const uint8_t* from = view.data + r * view.stride;
      for (std::size_t k = 0; k < row; ++k) {
        Stored value;
        std::memcpy(&value, from + k * sizeof(Stored), sizeof value);
        greatest = std::max(greatest, value);
        to[k] = static_cast<Scalar>(value);
      }
    }
    if (greatest >= limit)
      fail(name, "value " + std::to_string(greatest) + " is out of range: " + std::to_string(limit) +
                     " is the limit");
  }

  const tinygltf::Model& model_;
  const tinygltf::Value& object_;
  std::string path_;
};

}  // namespace fascia::rig
