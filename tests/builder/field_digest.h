#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace fascia::testing {

/// A visitor of a rig's fields: everything that a part of a rig holds, as one number (FNV-1a).
class FieldDigest {
 public:
  uint64_t value() const { return hash_; }
  void text(std::string_view, const std::string& text) { bytes(text.data(), text.size()); }
  template <class T>
  void number(std::string_view, const T& number) {
    bytes(&number, sizeof number);
  }
  void bounded(std::string_view name, double value, double /*least*/, double /*most*/) {
    number(name, value);
  }
  template <class T>
  void hash(std::string_view name, const T& value) {
    number(name, value);
  }
  template <class T>
  void vector(std::string_view, const T& vector) {
    bytes(vector.data(), sizeof vector);
  }
  template <class T>
  void matrix(std::string_view, const T& matrix) {
    bytes(matrix.data(), sizeof matrix);
  }
  template <class T, class Names>
  void choice(std::string_view name, const T& value, const Names&) {
    number(name, value);
  }
  template <class Body>
  void object(std::string_view, Body body) {
    body(*this);
  }
  template <class T, class Body>
  void array(std::string_view, const std::vector<T>& list, Body body) {
    for (size_t i = 0; i < list.size(); ++i)
      body(*this, list[i], i);
  }
  template <class T, class... Checks>
  void list(std::string_view, const std::vector<T>& list, Checks...) {
    bytes(list.data(), list.size() * sizeof(T));
  }
  template <class T, class... Checks>
  void unbounded(std::string_view name, const std::vector<T>& values, Checks...) {
    list(name, values);
  }
  template <class T, class... Checks>
  void index(std::string_view name, const std::vector<T>& values, Checks...) {
    list(name, values);
  }
  template <class T, class... Checks>
  void offsets(std::string_view name, const std::vector<T>& values, Checks...) {
    list(name, values);
  }
  template <class T, class... Checks>
  void triangles(std::string_view name, const std::vector<T>& values, Checks...) {
    list(name, values);
  }
  template <class T, class Member>
  void names(std::string_view name, const std::vector<T>& list, Member member) {
    for (const T& element : list)
      text(name, element.*member);
  }
  template <class T, class Member>
  void column(std::string_view, const std::vector<T>& list, Member member) {
    for (const T& element : list)
      bytes(&(element.*member), sizeof(element.*member));
  }
  void texts(std::string_view name, const std::vector<std::string>& list) {
    for (const std::string& element : list)
      text(name, element);
  }

 private:
  void bytes(const void* data, size_t count) {
    for (size_t i = 0; i < count; ++i)
      hash_ = (hash_ ^ static_cast<const unsigned char*>(data)[i]) * 1099511628211U;
    hash_ = (hash_ ^ count) * 1099511628211U;
  }
  uint64_t hash_ = 14695981039346656037U;
};

}  // namespace fascia::testing
