#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <tuple>
#include <vector>

#include "gltf/edit/document.h"
#include "gltf/edit/room.h"

namespace fascia::gltf {

using Vec3f = Eigen::Vector3f;

/// `target` of a buffer view that holds vertex attributes, or indices.
inline constexpr int vertex_target = 34962, index_target = 34963;

/// Accessors, buffer views and bytes appended to a glTF file; nothing that was there moves. What is appended
/// twice with the same content is stored once, so that data shared in the source stay shared. Room that was
/// given back is used before the file grows.
class Appendix {
 public:
  /// Everything goes behind what `root` and `bin` hold already; both must outlive this.
  Appendix(Json& root, std::vector<uint8_t>& bin) : root_(root), bin_(bin) {}

  /// A buffer view over `bytes`, aligned to eight; returns its index. `target` 0: none; `stride` 0: its
  /// elements lie one after the other.
  std::size_t add_view(std::span<const uint8_t> bytes, int target = 0, std::size_t stride = 0);

  /// An accessor given as JSON; returns its index.
  std::size_t add_accessor(Json accessor);

  /// An accessor over floats, `components` (1 to 4) an element, with its bounds where `bounds` asks for them
  /// (POSITION and the input of an animation need them); returns its index.
  std::size_t add_floats(std::span<const float> numbers, std::size_t components, bool bounds = true,
                         int target = 0);

  /// An accessor over whole numbers, in the smallest component type that holds them all, with bounds.
  std::size_t add_whole(std::span<const uint32_t> numbers, std::size_t components);

  /// Triangle indices, as a primitive's `indices`, in the smallest type that holds them.
  std::size_t add_indices(std::span<const uint32_t> corners);

  /// An accessor over vectors of which many may be zero: sparse where that is smaller. Where all are zero it
  /// is sparse with a single zero in it, since accessors without any data are not read everywhere.
  std::size_t add_vectors(std::span<const Vec3f> vectors, bool bounds);

  /// Gives back the room of an accessor of the file that nothing refers to any more: the bytes, views and the
  /// accessor's own number are used for what is added next. Nothing happens while something refers to it.
  void give_back(std::size_t accessor);

 private:
  std::size_t place_for(std::size_t size);
  std::size_t free_entry(std::vector<std::size_t>& free, const Json& list);
  std::size_t add_sparse(std::span<const Vec3f> vectors, const std::vector<uint32_t>& moved, bool bounds);

  Json& root_;
  std::vector<uint8_t>& bin_;
  std::multimap<uint64_t, std::size_t> views_;    ///< hash of the content -> view
  std::map<std::string, std::size_t> accessors_;  ///< JSON -> accessor
  std::vector<ByteRange> free_bytes_;
  std::vector<std::size_t> free_views_, free_accessors_;
};

}  // namespace fascia::gltf
