#pragma once

#include <algorithm>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "geometry/error.h"
#include "gltf/edit/appendix.h"
#include "rig/model/element.h"
#include "rig/model/fields.h"

namespace fascia::rig {

using Json = gltf::Json;

/// `value` as the double whose shortest decimal is the float's: 0.436, not 0.43599998950958252.
double shortest(float value);

/// Writes the fields of rig/model/fields.h into one JSON object. Empty lists are left out.
class Writer {
 public:
  Writer(gltf::Appendix& appendix, std::string path) : appendix_(appendix), path_(std::move(path)) {}

  void text(const char* name, const std::string& value) { json[name] = value; }
  void number(const char* name, float value) {
    if (!std::isfinite(value)) fail(name, "not a finite number");
    json[name] = shortest(value);
  }
  void number(const char* name, double value) {
    if (!std::isfinite(value)) fail(name, "not a finite number");
    json[name] = value;
  }
  void bounded(const char* name, double value, double /*least*/, double /*most*/) { number(name, value); }
  void number(const char* name, uint32_t value) { json[name] = value; }
  void number(const char* name, int32_t value) { json[name] = value; }
  void hash(const char* name, uint64_t value);
  void vector(const char* name, const Vec3f& value) { numbers(name, {value.data(), 3}); }
  void matrix(const char* name, const Mat4f& value) { numbers(name, {value.data(), 16}); }

  template <class Enum>
  void choice(const char* name, Enum value, std::span<const std::string_view> names) {
    const auto index = static_cast<std::size_t>(value);
    if (index >= names.size()) fail(name, "not a known value");
    json[name] = std::string(names[index]);
  }

  template <class Body>
  void object(const char* name, const Body& body) {
    Writer inner(appendix_, at(name));
    body(inner);
    if (!inner.json.empty()) json[name] = std::move(inner.json);
  }

  template <class T, class Body>
  void array(const char* name, const std::vector<T>& list, const Body& body) {
    if (list.empty()) return;
    Json& values = json[name] = Json::array();
    for (std::size_t i = 0; i < list.size(); ++i) {
      Writer inner(appendix_, at(name) + "/" + std::to_string(i));
      body(inner, list[i], i);
      values.push_back(std::move(inner.json));
    }
  }

  template <class T>
  void list(const char* name, const std::vector<T>& values, std::size_t length) {
    check_length(name, values.size(), length);
    for (std::size_t i = 0; i < values.size(); ++i)
      if (!Element<T>::finite(values[i]))
        fail(name, "element " + std::to_string(i) + " is not a finite number");
    if (values.empty()) return;
    const auto* numbers = reinterpret_cast<const float*>(values.data());
    constexpr std::size_t n = Element<T>::components;
    json[name] = appendix_.add_floats({numbers, values.size() * n}, n);
  }

  void unbounded(const char* name, std::vector<float> values, std::size_t length) {
    // glTF forbids infinity: the largest float stands for it.
    for (float& value : values)
      if (value == std::numeric_limits<float>::infinity()) value = std::numeric_limits<float>::max();
    list(name, values, length);
  }

  template <class T>
  void index(const char* name, const std::vector<T>& values, std::size_t length, std::size_t limit) {
    check_length(name, values.size(), length);
    if (values.empty()) return;
    constexpr std::size_t n = Element<T>::components;
    const auto* from = reinterpret_cast<const typename Element<T>::Scalar*>(values.data());
    const std::vector<uint32_t> numbers(from, from + values.size() * n);
    const uint32_t greatest = *std::max_element(numbers.begin(), numbers.end());
    if (greatest >= limit)
      fail(name, "value " + std::to_string(greatest) + " is out of range: " + std::to_string(limit) +
                     " is the limit");
    json[name] = appendix_.add_whole(numbers, n);
  }

  void offsets(const char* name, const std::vector<uint32_t>& values, std::size_t length) {
    if (length == 1 && values.size() <= 1) return;
    if (values.empty() || values.front() != 0 || !std::is_sorted(values.begin(), values.end()))
      fail(name, "offsets must begin at 0 and never fall");
    index(name, values, length, any);
  }

  void triangles(const char* name, const std::vector<Triangle>& triangles, std::size_t limit) {
    const auto* corners = reinterpret_cast<const uint32_t*>(triangles.data());
    index(name, std::vector<uint32_t>(corners, corners + triangles.size() * 3), any, limit);
  }

  void texts(const char* name, const std::vector<std::string>& values) {
    if (!values.empty()) json[name] = values;
  }

  template <class T>
  void names(const char* name, const std::vector<T>& list, std::string T::*member) {
    std::vector<std::string> values;
    for (const T& element : list)
      values.push_back(element.*member);
    texts(name, values);
  }

  template <class T, class M>
  void column(const char* name, const std::vector<T>& elements, M T::*member) {
    std::vector<M> values;
    for (const T& element : elements)
      values.push_back(element.*member);
    list(name, values, values.size());
  }

  Json json = Json::object();

 private:
  std::string at(const std::string& name) const { return path_ + "/" + name; }
  [[noreturn]] void fail(const std::string& name, const std::string& what) const {
    throw Error(at(name) + ": " + what);
  }
  void check_length(const char* name, std::size_t length, std::size_t due) const {
    if (due != any && length != due)
      fail(name, std::to_string(length) + " elements where " + std::to_string(due) + " are due");
  }
  void numbers(const char* name, std::span<const float> values);

  gltf::Appendix& appendix_;
  std::string path_;
};

}  // namespace fascia::rig
