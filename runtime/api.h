#pragma once

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "runtime/face.h"

// What the sources of the C interface have in common.
namespace fascia::runtime {

inline Face& checked(const fascia_face* face) {
  require(face != nullptr, "the face is null");
  return *face->face;
}

inline const Asset& checked(const fascia_asset* asset) {
  require(asset != nullptr, "the asset is null");
  return *asset->asset;
}

inline void check_index(uint32_t index, std::size_t count, const char* what) {
  if (index >= count)
    throw Failure(FASCIA_ERROR_ARGUMENT, std::string("there is no ") + what + " " + std::to_string(index) +
                                             ": there are " + std::to_string(count));
}

/// The face, which has a mesh of that number.
inline Face& with_mesh(const fascia_face* handle, uint32_t mesh) {
  Face& face = checked(handle);
  if (mesh >= face.mesh_count())
    throw Failure(FASCIA_ERROR_ARGUMENT, "there is no mesh " + std::to_string(mesh) + ": the rig moves " +
                                             std::to_string(face.mesh_count()));
  return face;
}

/// The face, which has a layer of that number.
inline Face& with_layer(const fascia_face* handle, uint32_t layer) {
  Face& face = checked(handle);
  if (!face.mixer().has_layer(layer))
    throw Failure(FASCIA_ERROR_ARGUMENT,
                  "the face has no layer " + std::to_string(layer) + ": fascia_face_set_layer makes it");
  return face;
}

/// Calls `use` with each thing that `name` drives in the face's rig. Allocates only for names in other
/// spellings than the rig's. Throws Failure when nothing is driven.
template <class Use>
void for_each_named(const Face& face, const char* name, Use use) {
  require(name != nullptr, "the name is null");
  if (const auto target = face.asset().find(name)) return use(Driven{*target, 1.0F, false});
  const std::vector<Driven> driven = face.asset().resolve(name);
  if (driven.empty())
    throw Failure(FASCIA_ERROR_NAME, "the rig has no channel or member \"" + std::string(name) +
                                         "\"; fascia_asset_get_channels and fascia_asset_get_set list them");
  for (const Driven& each : driven)
    use(each);
}

/// Copies as much of the caller's structure as it has.
template <class Struct>
Struct taken(const Struct* given, Struct chosen) {
  if (given == nullptr) return chosen;
  require(given->struct_size >= 2 * sizeof(uint32_t),
          "struct_size is not set: it must be sizeof the structure");
  std::memcpy(static_cast<void*>(&chosen), given, std::min<std::size_t>(given->struct_size, sizeof chosen));
  return chosen;
}

template <class Vector>
void hand_out_vectors(const std::vector<Vector>& vectors, fascia_vectors* to) {
  hand_out(fascia_vectors{0, static_cast<uint32_t>(vectors.size()), static_cast<uint32_t>(sizeof(Vector)), 0,
                          vectors.empty() ? nullptr : vectors.front().data()},
           to);
}

/// Bytes from one vertex to the next: more is a negative number of a host's.
constexpr std::size_t widest_stride = std::size_t{1} << 20;

/// Copies vectors to the host's memory.
template <class Vector>
void write_out(const std::vector<Vector>& vectors, void* to, std::size_t stride, std::size_t capacity) {
  require(to != nullptr && stride >= sizeof(Vector) && stride <= widest_stride,
          "the memory is null, or the stride too small or more than a megabyte");
  require(capacity >= vectors.size(), "the memory holds fewer vertices than the mesh has");
  for (std::size_t v = 0; v < vectors.size(); ++v)
    std::memcpy(static_cast<char*>(to) + v * stride, vectors[v].data(), sizeof(Vector));
}

}  // namespace fascia::runtime
