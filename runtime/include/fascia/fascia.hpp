// Fascia's runtime for C++20: the C interface (fascia/fascia.h) with RAII, exceptions and spans. Header only.
//
//     fascia::api::Asset asset = fascia::api::Asset::load(bytes);
//     fascia::api::Face face(asset);
//     face.set("arkit:mouthSmileLeft", 0.8f);
//     face.step(1.0f / 60.0f);
//     std::span<const std::array<float, 3>> positions = face.positions(0);
//
// Everything that can fail throws fascia::api::Error, except that step returns false for
// FASCIA_ERROR_DIVERGED, after which a face can be stepped again. Functions without a wrapper can be called
// with the handle: fascia_face_energies(face.handle(), ...).
#ifndef FASCIA_FASCIA_HPP
#define FASCIA_FASCIA_HPP

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "fascia/fascia.h"
#include "fascia/fit.h"
#include "fascia/gpu.h"
#include "fascia/research.h"

namespace fascia::api {

// A failure: its message, and its result code in the C interface.
class Error : public std::runtime_error {
 public:
  Error(fascia_result result, const std::string& message) : std::runtime_error(message), result_(result) {}
  fascia_result result() const { return result_; }

 private:
  fascia_result result_;
};

inline void check(fascia_result result) {
  if (result != FASCIA_OK) throw Error(result, fascia_last_message());
}

// A structure of the C interface, zero except for its struct_size.
template <class Struct>
Struct sized() {
  Struct value{};
  value.struct_size = sizeof value;
  return value;
}

using Vector3 = std::array<float, 3>;
using Vector4 = std::array<float, 4>;
using Matrix4 = std::array<float, 16>;  // column-major

// A loaded rig: immutable, shared by copies and by faces, usable from any thread.
class Asset {
 public:
  // Throws Error if the bytes are not a valid rig.
  static Asset load(std::span<const std::byte> bytes) { return load(bytes.data(), bytes.size()); }
  static Asset load(std::span<const std::uint8_t> bytes) { return load(bytes.data(), bytes.size()); }

  fascia_asset_info info() const {
    auto info = sized<fascia_asset_info>();
    check(fascia_asset_get_info(handle(), &info));
    return info;
  }
  fascia_level_info level(std::uint32_t index) const {
    auto info = sized<fascia_level_info>();
    check(fascia_asset_get_level(handle(), index, &info));
    return info;
  }
  fascia_mesh_info mesh(std::uint32_t index) const {
    auto info = sized<fascia_mesh_info>();
    check(fascia_asset_get_mesh(handle(), index, &info));
    return info;
  }
  fascia_channels channels() const {
    auto channels = sized<fascia_channels>();
    check(fascia_asset_get_channels(handle(), &channels));
    return channels;
  }
  fascia_set_info set(std::uint32_t index) const {
    auto info = sized<fascia_set_info>();
    check(fascia_asset_get_set(handle(), index, &info));
    return info;
  }
  // -1 if there is none.
  std::int32_t find_channel(const std::string& name) const {
    return fascia_asset_find_channel(handle(), name.c_str());
  }

  fascia_asset* handle() const { return handle_.get(); }

 private:
  explicit Asset(fascia_asset* handle) : handle_(handle, fascia_asset_release) {}
  static Asset load(const void* bytes, std::size_t size) {
    fascia_asset* handle = nullptr;
    check(fascia_asset_load(bytes, size, &handle));
    return Asset(handle);
  }
  std::shared_ptr<fascia_asset> handle_;
};

// Named values over time: immutable, shared by copies, usable from any thread.
class Curves {
 public:
  // Throws Error if the bytes are not a curves file.
  static Curves load(std::span<const std::uint8_t> bytes, double frames_per_second = 0.0) {
    auto options = sized<fascia_curves_options>();
    options.frames_per_second = frames_per_second;
    fascia_curves* handle = nullptr;
    check(fascia_curves_load_as(bytes.data(), bytes.size(), &options, &handle));
    return Curves(handle);
  }
  fascia_curves_info info() const {
    auto info = sized<fascia_curves_info>();
    check(fascia_curves_get_info(handle(), &info));
    return info;
  }
  const fascia_curves* handle() const { return handle_.get(); }

 private:
  explicit Curves(fascia_curves* handle) : handle_(handle, fascia_curves_release) {}
  std::shared_ptr<fascia_curves> handle_;
};

// One instance of a rig; movable, not copyable. For one thread at a time.
class Face {
 public:
  explicit Face(const Asset& asset, const fascia_face_options& options = fascia_default_face_options())
      : asset_(asset) {
    fascia_face* handle = nullptr;
    check(fascia_face_create(asset.handle(), &options, &handle));
    handle_.reset(handle);
    channel_count_ = asset.channels().count;
  }

  const Asset& asset() const { return asset_; }

  std::span<float> values() { return {fascia_face_values(handle()), channel_count_}; }
  std::span<const float> effective_values() const {
    return {fascia_face_effective_values(handle()), channel_count_};
  }
  void set(const std::string& name, float value) { check(fascia_face_set(handle(), name.c_str(), value)); }
  void set_member(std::uint32_t set, std::uint32_t member, float value) {
    check(fascia_face_set_member(handle(), set, member, value));
  }
  float get(const std::string& name) const {
    float value = 0.0F;
    check(fascia_face_get(handle(), name.c_str(), &value));
    return value;
  }
  void clear() { check(fascia_face_clear(handle())); }

  // `mask` has a weight for each channel, or is empty.
  void set_layer(std::uint32_t index, fascia_combine combine, float weight = 1.0F,
                 std::span<const float> mask = {}) {
    if (!mask.empty() && mask.size() != channel_count_)
      throw Error(FASCIA_ERROR_ARGUMENT, "the mask has not one weight a channel");
    auto layer = sized<fascia_layer>();
    layer.combine = combine;
    layer.weight = weight;
    layer.mask = mask.empty() ? nullptr : mask.data();
    check(fascia_face_set_layer(handle(), index, &layer));
  }
  std::span<float> layer_values(std::uint32_t layer) {
    float* const values = fascia_face_layer_values(handle(), layer);
    return {values, values == nullptr ? 0 : channel_count_};
  }
  void apply(const Curves& curves, double seconds, float weight = 1.0F, std::uint32_t layer = 0) {
    check(fascia_curves_apply_to_layer(curves.handle(), seconds, weight, handle(), layer));
  }
  void look_at(const Vector3& point, float weight = 1.0F) {
    check(fascia_face_look_at(handle(), point.data(), weight));
  }
  void look_nowhere() { check(fascia_face_look_at(handle(), nullptr, 0.0F)); }
  void blend(float share, float seconds) { check(fascia_face_blend(handle(), share, seconds)); }

  void pose() { check(fascia_face_pose(handle())); }
  // False if the simulation was reset to rest (FASCIA_ERROR_DIVERGED).
  bool step(float seconds) {
    const fascia_result result = fascia_face_step(handle(), seconds);
    if (result == FASCIA_ERROR_DIVERGED) return false;
    check(result);
    return true;
  }
  void reset() { check(fascia_face_reset(handle())); }
  void move_head(const Matrix4& place, float inertia_scale = 1.0F) {
    check(fascia_face_move_head(handle(), place.data(), inertia_scale));
  }
  void set_level(std::int32_t level, float seconds = 0.25F) {
    check(fascia_face_set_level(handle(), level, seconds));
  }
  std::int32_t level() const { return fascia_face_level(handle()); }

  std::vector<std::uint8_t> save() {
    std::size_t size = 0;
    check(fascia_face_save(handle(), nullptr, 0, &size));
    std::vector<std::uint8_t> bytes(size);
    check(fascia_face_save(handle(), bytes.data(), bytes.size(), &size));
    return bytes;
  }
  void restore(std::span<const std::uint8_t> bytes) {
    check(fascia_face_restore(handle(), bytes.data(), bytes.size()));
  }

  // Views of the face's memory, valid during its lifetime; their contents change with each pose or step.
  std::span<const Vector3> positions(std::uint32_t mesh) {
    return view<Vector3>(fascia_face_positions, mesh);
  }
  std::span<const Vector3> normals(std::uint32_t mesh) { return view<Vector3>(fascia_face_normals, mesh); }
  std::span<const Vector4> tangents(std::uint32_t mesh) { return view<Vector4>(fascia_face_tangents, mesh); }
  std::span<const Vector3> compression(std::uint32_t mesh) {
    return view<Vector3>(fascia_face_compression, mesh);
  }
  Matrix4 jaw() const {
    Matrix4 matrix{};
    check(fascia_face_jaw(handle(), matrix.data()));
    return matrix;
  }

  fascia_face* handle() const { return handle_.get(); }

 private:
  template <class Vector, class Function>
  std::span<const Vector> view(Function function, std::uint32_t mesh) {
    auto vectors = sized<fascia_vectors>();
    check(function(handle(), mesh, &vectors));
    return {reinterpret_cast<const Vector*>(vectors.data), vectors.count};
  }

  struct Release {
    void operator()(fascia_face* face) const { fascia_face_release(face); }
  };
  Asset asset_;
  std::unique_ptr<fascia_face, Release> handle_;
  std::size_t channel_count_ = 0;
};

// Activations and head pose from a stream of landmarks; movable, not copyable. For one thread at a time.
class Fit {
 public:
  // `set` is a detector's landmark set, "ibug68" or "mediapipe478".
  Fit(const Asset& asset, const std::string& set,
      const fascia_fit_options& options = fascia_default_fit_options()) {
    auto landmarks = sized<fascia_fit_landmarks>();
    landmarks.set = set.c_str();
    make(asset, landmarks, options);
  }
  // Landmarks of the rig by name, one per point.
  Fit(const Asset& asset, std::span<const char* const> names,
      const fascia_fit_options& options = fascia_default_fit_options()) {
    auto landmarks = sized<fascia_fit_landmarks>();
    landmarks.names = names.data();
    landmarks.count = static_cast<std::uint32_t>(names.size());
    make(asset, landmarks, options);
  }

  // Points on the skin, one per point of a frame.
  Fit(const Asset& asset, std::span<const fascia_fit_place> places,
      const fascia_fit_options& options = fascia_default_fit_options()) {
    auto landmarks = sized<fascia_fit_landmarks>();
    landmarks.places = places.data();
    landmarks.count = static_cast<std::uint32_t>(places.size());
    make(asset, landmarks, options);
  }

  fascia_fit_info info() const {
    auto info = sized<fascia_fit_info>();
    check(fascia_fit_get_info(handle(), &info));
    return info;
  }
  // `weights` has one for each point, or is empty.
  void set_neutral(std::span<const float> points, std::span<const float> weights = {}) {
    check_sizes(points, weights);
    check(fascia_fit_set_neutral(handle(), points.data(), weights.empty() ? nullptr : weights.data()));
  }
  // The result is valid until the next call.
  fascia_fit_result push(std::span<const float> points, std::span<const float> weights = {}) {
    check_sizes(points, weights);
    auto result = sized<fascia_fit_result>();
    check(fascia_fit_push(handle(), points.data(), weights.empty() ? nullptr : weights.data(), &result));
    return result;
  }
  void reset() { check(fascia_fit_reset(handle())); }

  fascia_fit* handle() const { return handle_.get(); }

 private:
  void make(const Asset& asset, const fascia_fit_landmarks& landmarks, const fascia_fit_options& options) {
    fascia_fit* handle = nullptr;
    check(fascia_fit_create(asset.handle(), &landmarks, &options, &handle));
    handle_.reset(handle);
  }
  void check_sizes(std::span<const float> points, std::span<const float> weights) const {
    const fascia_fit_info known = info();
    if (points.size() != std::size_t{known.point_count} * known.dimensions ||
        (!weights.empty() && weights.size() != known.point_count))
      throw Error(FASCIA_ERROR_ARGUMENT, "the points or weights are not as many as a frame has");
  }
  struct Release {
    void operator()(fascia_fit* fit) const { fascia_fit_release(fit); }
  };
  std::unique_ptr<fascia_fit, Release> handle_;
};

}  // namespace fascia::api

#endif
