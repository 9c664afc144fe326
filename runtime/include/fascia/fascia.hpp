/// \file
/// Fascia's runtime for C++20: the C interface (fascia/fascia.h) with RAII, exceptions and spans. Header
/// only.
///
///     fascia::api::Asset asset = fascia::api::Asset::load(bytes);
///     fascia::api::Face face(asset);
///     face.set("arkit:mouthSmileLeft", 0.8f);
///     face.step(1.0f / 60.0f);
///     std::span<const std::array<float, 3>> positions = face.positions(0);
///
/// Everything that can fail throws fascia::api::Error, except that step returns false for
/// FASCIA_ERROR_DIVERGED, after which a face can be stepped again. Functions without a wrapper can be called
/// with the handle: fascia_face_energies(face.handle(), ...).
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

/// A failure: its message, and its result code in the C interface.
class Error : public std::runtime_error {
 public:
  /// `message` is what what() returns.
  Error(fascia_result result, const std::string& message) : std::runtime_error(message), result_(result) {}
  /// Never FASCIA_OK.
  fascia_result result() const { return result_; }

 private:
  fascia_result result_;
};

/// Throws Error with this thread's last message unless `result` is FASCIA_OK.
inline void check(fascia_result result) {
  if (result != FASCIA_OK) throw Error(result, fascia_last_message());
}

/// A structure of the C interface, zero except for its struct_size.
template <class Struct>
Struct sized() {
  Struct value{};
  value.struct_size = sizeof value;
  return value;
}

using Vector3 = std::array<float, 3>;   ///< x, y, z
using Vector4 = std::array<float, 4>;   ///< a tangent: x, y, z and the handedness
using Matrix4 = std::array<float, 16>;  ///< column-major

/// A loaded rig: immutable, shared by copies and by faces, usable from any thread.
class Asset {
 public:
  /// Loads a rig from the bytes of a .glb file, which may be freed afterwards: see fascia_asset_load. Throws
  /// Error if they are not a valid rig.
  static Asset load(std::span<const std::byte> bytes) { return load(bytes.data(), bytes.size()); }
  /// The same.
  static Asset load(std::span<const std::uint8_t> bytes) { return load(bytes.data(), bytes.size()); }

  /// The size of the rig and its axes.
  fascia_asset_info info() const {
    auto info = sized<fascia_asset_info>();
    check(fascia_asset_get_info(handle(), &info));
    return info;
  }
  /// A level of detail, 0 the coarsest. Throws Error if there is none of that index.
  fascia_level_info level(std::uint32_t index) const {
    auto info = sized<fascia_level_info>();
    check(fascia_asset_get_level(handle(), index, &info));
    return info;
  }
  /// A mesh that the rig deforms. Throws Error if there is none of that index.
  fascia_mesh_info mesh(std::uint32_t index) const {
    auto info = sized<fascia_mesh_info>();
    check(fascia_asset_get_mesh(handle(), index, &info));
    return info;
  }
  /// The channels, as arrays in the asset's memory.
  fascia_channels channels() const {
    auto channels = sized<fascia_channels>();
    check(fascia_asset_get_channels(handle(), &channels));
    return channels;
  }
  /// A vocabulary and its members. Throws Error if there is none of that index.
  fascia_set_info set(std::uint32_t index) const {
    auto info = sized<fascia_set_info>();
    check(fascia_asset_get_set(handle(), index, &info));
    return info;
  }
  /// Index of a channel by name, case-insensitive; -1 if there is none.
  std::int32_t find_channel(const std::string& name) const {
    return fascia_asset_find_channel(handle(), name.c_str());
  }

  /// The asset in the C interface; not to be released.
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

/// Named values over time: immutable, shared by copies, usable from any thread.
class Curves {
 public:
  /// Loads curves from the bytes of a file, which may be freed afterwards: see fascia_curves_load.
  /// `frames_per_second` replaces the file's own rate unless it is 0. Throws Error if the bytes are not a
  /// curves file.
  static Curves load(std::span<const std::uint8_t> bytes, double frames_per_second = 0.0) {
    auto options = sized<fascia_curves_options>();
    options.frames_per_second = frames_per_second;
    fascia_curves* handle = nullptr;
    check(fascia_curves_load_as(bytes.data(), bytes.size(), &options, &handle));
    return Curves(handle);
  }
  /// The names, the duration and notes on the file.
  fascia_curves_info info() const {
    auto info = sized<fascia_curves_info>();
    check(fascia_curves_get_info(handle(), &info));
    return info;
  }
  /// The curves in the C interface; not to be released.
  const fascia_curves* handle() const { return handle_.get(); }

 private:
  explicit Curves(fascia_curves* handle) : handle_(handle, fascia_curves_release) {}
  std::shared_ptr<fascia_curves> handle_;
};

/// One instance of a rig; movable, not copyable. For one thread at a time.
class Face {
 public:
  /// Creates a face at rest: see fascia_face_create.
  explicit Face(const Asset& asset, const fascia_face_options& options = fascia_default_face_options())
      : asset_(asset) {
    fascia_face* handle = nullptr;
    check(fascia_face_create(asset.handle(), &options, &handle));
    handle_.reset(handle);
    channel_count_ = asset.channels().count;
  }

  /// The rig of the face.
  const Asset& asset() const { return asset_; }

  /// The face's own channel values, which may be read and written; valid during its lifetime.
  std::span<float> values() { return {fascia_face_values(handle()), channel_count_}; }
  /// The channel values used by the last pose, step or reset; valid during the face's lifetime.
  std::span<const float> effective_values() const {
    return {fascia_face_effective_values(handle()), channel_count_};
  }
  /// Sets a channel or a member ("arkit:jawOpen") by name: see fascia_face_set. Throws Error if the rig has
  /// neither.
  void set(const std::string& name, float value) { check(fascia_face_set(handle(), name.c_str(), value)); }
  /// Sets a member of a set by their indices (see Asset::set).
  void set_member(std::uint32_t set, std::uint32_t member, float value) {
    check(fascia_face_set_member(handle(), set, member, value));
  }
  /// The value last set by that name. Throws Error if the rig has no such channel or member.
  float get(const std::string& name) const {
    float value = 0.0F;
    check(fascia_face_get(handle(), name.c_str(), &value));
    return value;
  }
  /// Sets every channel to its rest value and every member to 0.
  void clear() { check(fascia_face_clear(handle())); }

  /// Adds layer `index` (1 to 7), or changes how it is combined: see fascia_face_set_layer. `mask` has a
  /// weight for each channel, or is empty.
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
  /// A layer's own values; empty if there is no such layer. Valid during the face's lifetime.
  std::span<float> layer_values(std::uint32_t layer) {
    float* const values = fascia_face_layer_values(handle(), layer);
    return {values, values == nullptr ? 0 : channel_count_};
  }
  /// Adds the curves' values at `seconds`, times `weight`, to the input of the next pose or step: see
  /// fascia_curves_apply. Throws Error if there is no such layer.
  void apply(const Curves& curves, double seconds, float weight = 1.0F, std::uint32_t layer = 0) {
    check(fascia_curves_apply_to_layer(curves.handle(), seconds, weight, handle(), layer));
  }
  /// Rotates both eyes toward a point, metres in the head's frame, to the extent of `weight` (0 to 1), from
  /// the next pose or step on.
  void look_at(const Vector3& point, float weight = 1.0F) {
    check(fascia_face_look_at(handle(), point.data(), weight));
  }
  /// Ends the effect of look_at.
  void look_nowhere() { check(fascia_face_look_at(handle(), nullptr, 0.0F)); }
  /// Changes the factor applied to all inputs to `share` (0, at rest, to 1) over `seconds` of steps.
  void blend(float share, float seconds) { check(fascia_face_blend(handle(), share, seconds)); }

  /// Solves for the static equilibrium at the current values.
  void pose() { check(fascia_face_pose(handle())); }
  /// Advances the simulation by `seconds` (0 to 1). False if it was reset to rest (FASCIA_ERROR_DIVERGED).
  bool step(float seconds) {
    const fascia_result result = fascia_face_step(handle(), seconds);
    if (result == FASCIA_ERROR_DIVERGED) return false;
    check(result);
    return true;
  }
  /// Removes all motion and resets the tissue to rest on the jaw: after a cut or a teleport.
  void reset() { check(fascia_face_reset(handle())); }
  /// Sets the pose of the head in the world, metres, from the head's frame: see fascia_face_move_head.
  /// `inertia_scale` 1 is physical, 0 none.
  void move_head(const Matrix4& place, float inertia_scale = 1.0F) {
    check(fascia_face_move_head(handle(), place.data(), inertia_scale));
  }
  /// Switches to another level of detail (-1 the finest), blending the vertices over `seconds` of steps.
  void set_level(std::int32_t level, float seconds = 0.25F) {
    check(fascia_face_set_level(handle(), level, seconds));
  }
  /// The current level of detail.
  std::int32_t level() const { return fascia_face_level(handle()); }

  /// The complete state on which the next steps depend: see fascia_face_save. Throws Error with Bullet.
  std::vector<std::uint8_t> save() {
    std::size_t size = 0;
    check(fascia_face_save(handle(), nullptr, 0, &size));
    std::vector<std::uint8_t> bytes(size);
    check(fascia_face_save(handle(), bytes.data(), bytes.size(), &size));
    return bytes;
  }
  /// Restores a saved state. Throws Error if the bytes are damaged or of another kind of face.
  void restore(std::span<const std::uint8_t> bytes) {
    check(fascia_face_restore(handle(), bytes.data(), bytes.size()));
  }

  /// Vertex positions of a mesh in the face's space. Like the two following, a view of the face's memory,
  /// valid during its lifetime, whose contents change with each pose or step.
  std::span<const Vector3> positions(std::uint32_t mesh) {
    return view<Vector3>(fascia_face_positions, mesh);
  }
  /// Unit vertex normals; call it again after a pose or step.
  std::span<const Vector3> normals(std::uint32_t mesh) { return view<Vector3>(fascia_face_normals, mesh); }
  /// Unit tangents with their handedness, empty if the mesh has none; call it again after a pose or step.
  std::span<const Vector4> tangents(std::uint32_t mesh) { return view<Vector4>(fascia_face_tangents, mesh); }
  /// Compression of the skin at each vertex: see fascia_face_compression. Valid until the next call of this
  /// function, for any mesh.
  std::span<const Vector3> compression(std::uint32_t mesh) {
    return view<Vector3>(fascia_face_compression, mesh);
  }
  /// Pose of the mandible: a rigid transform in metres.
  Matrix4 jaw() const {
    Matrix4 matrix{};
    check(fascia_face_jaw(handle(), matrix.data()));
    return matrix;
  }

  /// The face in the C interface; not to be released.
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

/// Activations and head pose from a stream of landmarks; movable, not copyable. For one thread at a time.
class Fit {
 public:
  /// Points of a detector's landmark set, "ibug68" or "mediapipe478".
  Fit(const Asset& asset, const std::string& set,
      const fascia_fit_options& options = fascia_default_fit_options()) {
    auto landmarks = sized<fascia_fit_landmarks>();
    landmarks.set = set.c_str();
    make(asset, landmarks, options);
  }
  /// Landmarks of the rig by name, one per point of a frame; null for a point that is not used.
  Fit(const Asset& asset, std::span<const char* const> names,
      const fascia_fit_options& options = fascia_default_fit_options()) {
    auto landmarks = sized<fascia_fit_landmarks>();
    landmarks.names = names.data();
    landmarks.count = static_cast<std::uint32_t>(names.size());
    make(asset, landmarks, options);
  }

  /// Points on the skin, one per point of a frame.
  Fit(const Asset& asset, std::span<const fascia_fit_place> places,
      const fascia_fit_options& options = fascia_default_fit_options()) {
    auto landmarks = sized<fascia_fit_landmarks>();
    landmarks.places = places.data();
    landmarks.count = static_cast<std::uint32_t>(places.size());
    make(asset, landmarks, options);
  }

  /// The sizes of frames and results.
  fascia_fit_info info() const {
    auto info = sized<fascia_fit_info>();
    check(fascia_fit_get_info(handle(), &info));
    return info;
  }
  /// Calibrates with a frame of the same face at rest: see fascia_fit_set_neutral. `weights` has one for each
  /// point, or is empty.
  void set_neutral(std::span<const float> points, std::span<const float> weights = {}) {
    check_sizes(points, weights);
    check(fascia_fit_set_neutral(handle(), points.data(), weights.empty() ? nullptr : weights.data()));
  }
  /// Fits the next frame: see fascia_fit_push. The result is valid until the next call.
  fascia_fit_result push(std::span<const float> points, std::span<const float> weights = {}) {
    check_sizes(points, weights);
    auto result = sized<fascia_fit_result>();
    check(fascia_fit_push(handle(), points.data(), weights.empty() ? nullptr : weights.data(), &result));
    return result;
  }
  /// Resets the tracking, as after a cut; the calibration is kept.
  void reset() { check(fascia_fit_reset(handle())); }

  /// The fit in the C interface; not to be released.
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
