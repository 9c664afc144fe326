/// \file
/// Fascia's runtime for C++20: errors, the log, the allocator, rigs and curves. Included by
/// fascia/fascia.hpp.
#ifndef FASCIA_ASSET_HPP
#define FASCIA_ASSET_HPP

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "fascia/fascia.h"
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

/// Sets the function that is told of each failure, on the thread where it occurs; an empty one for none. What
/// it throws is lost. Not synchronised: see fascia_set_log.
inline void set_log(std::function<void(fascia_result, std::string_view)> log) {
  static std::function<void(fascia_result, std::string_view)> kept;
  fascia_set_log(nullptr, nullptr);
  kept = std::move(log);
  if (!kept) return;
  fascia_set_log(
      [](void* user, fascia_result result, const char* message) {
        try {
          (*static_cast<decltype(kept)*>(user))(result, message);
        } catch (...) {  // must not pass through C
        }
      },
      &kept);
}

/// Makes the library use the host's allocator, which is copied; null selects malloc again. Throws Error while
/// anything of the library exists: see fascia_set_allocator.
inline void set_allocator(const fascia_allocator* allocator) {
  check(fascia_set_allocator(allocator));
}

using Vector2 = std::array<float, 2>;   ///< a texture coordinate
using Vector3 = std::array<float, 3>;   ///< x, y, z
using Vector4 = std::array<float, 4>;   ///< a tangent: x, y, z and the handedness; a quaternion
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

  /// Indices of a set's member: see Asset::find_member.
  struct Member {
    std::uint32_t set = 0;     ///< for Asset::set
    std::uint32_t member = 0;  ///< in its members
  };
  /// Indices of a member by its name, "arkit:jawOpen" or "jawOpen". Throws Error if no set has it.
  Member find_member(const std::string& name) const {
    Member found;
    check(fascia_asset_find_member(handle(), name.c_str(), &found.set, &found.member));
    return found;
  }
  /// Texture coordinates of a mesh, one for each vertex, in the asset's memory; empty if the file has none.
  std::span<const Vector2> texcoords(std::uint32_t mesh) const {
    auto vectors = sized<fascia_vectors>();
    check(fascia_asset_texcoords(handle(), mesh, &vectors));
    return {reinterpret_cast<const Vector2*>(vectors.data), vectors.count};
  }
  /// A surface of the anatomy at rest, in the asset's memory: see fascia_asset_surface. Throws Error for any
  /// other name.
  fascia_surface surface(const std::string& name) const {
    auto surface = sized<fascia_surface>();
    check(fascia_asset_surface(handle(), name.c_str(), &surface));
    return surface;
  }
  /// The muscle fibres of a level at rest, in the asset's memory. Throws Error if there is no such level.
  fascia_fibres fibres(std::uint32_t level) const {
    auto fibres = sized<fascia_fibres>();
    check(fascia_asset_fibres(handle(), level, &fibres));
    return fibres;
  }
  /// The lattice of a level at rest, in the asset's memory. Throws Error if there is no such level.
  fascia_lattice lattice(std::uint32_t level) const {
    auto lattice = sized<fascia_lattice>();
    check(fascia_asset_lattice(handle(), level, &lattice));
    return lattice;
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
  /// For each curve 1 if the asset has a channel or member of its name, else 0.
  std::vector<std::uint8_t> match(const Asset& asset) const {
    std::vector<std::uint8_t> matched(info().count);
    std::uint32_t count = 0;
    check(fascia_curves_match(handle(), asset.handle(), &count, matched.data()));
    return matched;
  }
  /// Rotation of the head at `seconds`, a quaternion (x, y, z, w): see fascia_curves_head.
  Vector4 head(double seconds) const {
    Vector4 quaternion{};
    check(fascia_curves_head(handle(), seconds, quaternion.data()));
    return quaternion;
  }
  /// The curves in the C interface; not to be released.
  const fascia_curves* handle() const { return handle_.get(); }

 private:
  explicit Curves(fascia_curves* handle) : handle_(handle, fascia_curves_release) {}
  std::shared_ptr<fascia_curves> handle_;
};

}  // namespace fascia::api

#endif
