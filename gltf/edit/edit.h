#pragma once

#include <memory>

#include "gltf/edit/appendix.h"
#include "gltf/read/model.h"

namespace fascia::gltf {

/// Edits of a glTF file that preserve everything else: data are appended, never moved.
class Edit {
 public:
  /// `document` must be self-contained. Throws fascia::Error when its JSON is malformed.
  explicit Edit(Document document);
  Edit(const Edit&) = delete;
  Edit& operator=(const Edit&) = delete;

  Appendix& data() { return appendix_; }

  /// Appends an accessor of `values` (float, `width` numbers each) and returns its index. `bounds` adds
  /// min and max, which POSITION and animation inputs need.
  size_t add_floats(std::span<const float> values, int width, bool bounds, int target = 0) {
    return appendix_.add_floats(values, static_cast<std::size_t>(width), bounds, target);
  }

  /// Makes room for so many more bytes of data, which then need not be moved as they become more.
  void expect(std::size_t bytes) { bin_.reserve(bin_.size() + bytes); }

  /// A primitive's JSON. Throws when it is not there.
  Json& primitive(uint32_t mesh, uint32_t index);

  /// Nodes that show `mesh`.
  std::vector<std::size_t> nodes_of(uint32_t mesh) const;

  /// The file as tinygltf read it at the first call; what has been appended since is not in it.
  const tinygltf::Model& model();

  /// Bytes of the binary chunk, with what has been appended so far.
  std::span<const uint8_t> binary() const { return bin_; }

  /// The file as its two chunks.
  Document document() const;

  /// The file as GLB.
  std::vector<uint8_t> bytes() const;

  /// The same in three parts, one after the other, of which the large one is not copied: `binary` is good
  /// until the next change.
  struct Parts {
    std::vector<uint8_t> before;
    std::span<const uint8_t> binary;
    std::vector<uint8_t> after;
    std::size_t size() const { return before.size() + binary.size() + after.size(); }
  };
  Parts parts();

  Json json;

 private:
  std::vector<uint8_t> bin_;
  Appendix appendix_;
  std::shared_ptr<const tinygltf::Model> model_;
};

}  // namespace fascia::gltf
