#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "gltf/read/document.h"
#include "rig/model/rig.h"
#include "rig/read/read.h"

namespace fascia::rig {

/// A glTF file to carry a rig: its JSON text and binary chunk as they came.
struct GltfSource : gltf::Document {
  /// Bytes of a file the JSON names beside itself, by URI (not data URIs, percent-decoded), or nothing when
  /// it is not there. Buffers must be there; images that are not keep their URI.
  std::function<std::optional<std::vector<uint8_t>>(const std::string& uri)> resolve;
  /// What the head was before it became glTF, when it was something else.
  SourceRecord record;
};

/// The two chunks of a GLB file as a source. Throws fascia::Error naming `name`.
GltfSource glb_source(std::span<const uint8_t> bytes, const std::string& name = "head");

/// The source made self-contained: every buffer, by URI or data URI, joined into the one binary chunk (its
/// bytes first), images taken in where they resolve. Everything else stays as it came. Throws fascia::Error
/// when the JSON is malformed, a buffer is missing, or a buffer is compressed in a way that has no plain
/// copy.
GltfSource embed(const GltfSource& source);

/// Fingerprint of a primitive: what `read` checks (rig/spec/FASCIA_tissue says how it is computed).
struct Fingerprint {
  uint32_t vertex_count = 0;
  uint64_t position_hash = 0;
};

/// Fingerprint of primitive `primitive` of mesh `mesh` of `source`. Throws fascia::Error when it has none.
Fingerprint fingerprint(const GltfSource& source, uint32_t mesh, uint32_t primitive);

/// A rig file: `source` with `rig` appended as the five FASCIA extensions.
///
/// The source's JSON keeps its properties and their order, its binary chunk its bytes; no scene, node or mesh
/// is added. A rig that is already in the source is replaced. Bindings' hashes are computed here; a vertex
/// count that is not 0 must fit. Throws fascia::Error when the rig is inconsistent (the message names the
/// property) or the source is unfit.
std::vector<uint8_t> write(const GltfSource& source, const Rig& rig);

/// The head again, without the rig: the source as `write` took it, after embedding. What other tools have
/// appended since stays; what only the rig used goes where nothing else comes after it.
GltfSource original(const GltfSource& rig_file);

}  // namespace fascia::rig
