#include "gltf/read/accessors.h"

#include <cstring>

#include "geometry/error.h"

namespace fascia::gltf {
namespace {

std::size_t size_of_component(int type) {
  switch (type) {
    case TINYGLTF_COMPONENT_TYPE_BYTE:
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
      return 1;
    case TINYGLTF_COMPONENT_TYPE_SHORT:
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
      return 2;
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT:
    case TINYGLTF_COMPONENT_TYPE_FLOAT:
      return 4;
    default:
      return 0;
  }
}

std::size_t components_of(int type) {
  switch (type) {
    case TINYGLTF_TYPE_SCALAR:
      return 1;
    case TINYGLTF_TYPE_VEC2:
      return 2;
    case TINYGLTF_TYPE_VEC3:
      return 3;
    case TINYGLTF_TYPE_VEC4:
      return 4;
    case TINYGLTF_TYPE_MAT4:
      return 16;
    default:
      return 0;
  }
}

/// `size` bytes from `offset` on within buffer view `index`; throws when they are not all there.
const uint8_t* view_bytes(const tinygltf::Model& model, int index, std::size_t offset, std::size_t size,
                          const std::string& path) {
  if (index < 0 || static_cast<std::size_t>(index) >= model.bufferViews.size())
    throw Error(path + ": buffer view " + std::to_string(index) + " does not exist");
  const tinygltf::BufferView& view = model.bufferViews[static_cast<std::size_t>(index)];
  if (view.buffer < 0 || static_cast<std::size_t>(view.buffer) >= model.buffers.size())
    throw Error(path + ": buffer " + std::to_string(view.buffer) + " does not exist");
  const auto& data = model.buffers[static_cast<std::size_t>(view.buffer)].data;
  if (view.byteOffset > data.size() || view.byteLength > data.size() - view.byteOffset)
    throw Error(path + ": buffer view " + std::to_string(index) + " reaches beyond its buffer");
  if (offset > view.byteLength || size > view.byteLength - offset)
    throw Error(path + ": the accessor reaches beyond buffer view " + std::to_string(index));
  return data.data() + view.byteOffset + offset;
}

const tinygltf::Accessor& accessor_at(const tinygltf::Model& model, int index, const std::string& path) {
  if (index < 0 || static_cast<std::size_t>(index) >= model.accessors.size())
    throw Error(path + ": accessor " + std::to_string(index) + " does not exist");
  return model.accessors[static_cast<std::size_t>(index)];
}

uint32_t load_unsigned(const uint8_t* at, std::size_t size) {
  uint32_t value = 0;
  std::memcpy(&value, at, size);
  return value;
}

float load_component(const uint8_t* at, int type, bool normalized) {
  switch (type) {
    case TINYGLTF_COMPONENT_TYPE_BYTE: {
      int8_t value;
      std::memcpy(&value, at, 1);
      return normalized ? std::max(static_cast<float>(value) / 127.0F, -1.0F) : static_cast<float>(value);
    }
    case TINYGLTF_COMPONENT_TYPE_SHORT: {
      int16_t value;
      std::memcpy(&value, at, 2);
      return normalized ? std::max(static_cast<float>(value) / 32767.0F, -1.0F) : static_cast<float>(value);
    }
    case TINYGLTF_COMPONENT_TYPE_FLOAT: {
      float value;
      std::memcpy(&value, at, 4);
      return value;
    }
    default: {
      const std::size_t size = size_of_component(type);
      const auto value = static_cast<float>(load_unsigned(at, size));
      return normalized ? value / (size == 1 ? 255.0F : 65535.0F) : value;
    }
  }
}

/// Elements laid end to end as they are in the file, sparse values applied.
std::vector<uint8_t> packed_elements(const tinygltf::Model& model, int index, const std::string& path) {
  const AccessorView view = accessor_view(model, index, path);
  const std::size_t size = view.element_size();
  // Without a buffer view nothing bounds the count but sense.
  if (view.data == nullptr && view.count > (std::size_t{1} << 28) / size)
    throw Error(path + ": accessor " + std::to_string(index) + " has an absurd length");
  std::vector<uint8_t> bytes(view.count * size);
  if (view.data != nullptr)
    for (std::size_t i = 0; i < view.count; ++i)
      std::memcpy(bytes.data() + i * size, view.data + i * view.stride, size);
  const auto& sparse = accessor_at(model, index, path).sparse;
  if (!sparse.isSparse) return bytes;
  const std::size_t index_size = size_of_component(sparse.indices.componentType);
  const auto changes = static_cast<std::size_t>(sparse.count);
  if (index_size == 0 || sparse.count < 0 || changes > view.count || sparse.indices.byteOffset < 0 ||
      sparse.values.byteOffset < 0)
    throw Error(path + ": accessor " + std::to_string(index) + " has a malformed sparse part");
  const uint8_t* indices =
      view_bytes(model, sparse.indices.bufferView, static_cast<std::size_t>(sparse.indices.byteOffset),
                 changes * index_size, path);
  const uint8_t* values =
      view_bytes(model, sparse.values.bufferView, static_cast<std::size_t>(sparse.values.byteOffset),
                 changes * size, path);
  for (std::size_t i = 0; i < changes; ++i) {
    const std::size_t target = load_unsigned(indices + i * index_size, index_size);
    if (target >= view.count) throw Error(path + ": a sparse index passes the accessor's end");
    std::memcpy(bytes.data() + target * size, values + i * size, size);
  }
  return bytes;
}

/// True when the elements lie in the file as `packed_elements` would give them.
bool end_to_end(const tinygltf::Model& model, int index, const AccessorView& view) {
  return view.data != nullptr && view.stride == view.element_size() &&
         !model.accessors[static_cast<std::size_t>(index)].sparse.isSparse;
}

uint64_t hash_words(const uint8_t* bytes, std::size_t size) {
  uint64_t hash = 0xcbf29ce484222325ULL;
  for (std::size_t i = 0; i < size; i += 4) {
    hash ^= load_unsigned(bytes + i, 4);
    hash *= 0x100000001b3ULL;
  }
  return hash;
}

std::vector<uint32_t> decode_indices(const tinygltf::Model& model, int index, std::size_t vertex_count,
                                     const std::string& path) {
  const AccessorView view = accessor_view(model, index, path);
  const bool is_index =
      view.components == 1 && (view.component_type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE ||
                               view.component_type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT ||
                               view.component_type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT);
  if (!is_index || view.data == nullptr)
    throw Error(path + ": the index accessor is not a list of whole numbers");
  std::vector<uint32_t> indices(view.count);
  for (std::size_t i = 0; i < view.count; ++i) {
    indices[i] = load_unsigned(view.data + i * view.stride, view.component_size());
    if (indices[i] >= vertex_count)
      throw Error(path + ": index " + std::to_string(indices[i]) + " passes the " +
                  std::to_string(vertex_count) + " vertices (triangle " + std::to_string(i / 3) +
                  "); export the mesh again");
  }
  return indices;
}

}  // namespace

std::size_t AccessorView::component_size() const {
  return size_of_component(component_type);
}

AccessorView accessor_view(const tinygltf::Model& model, int index, const std::string& path) {
  const tinygltf::Accessor& accessor = accessor_at(model, index, path);
  AccessorView view;
  view.count = accessor.count;
  view.component_type = accessor.componentType;
  view.components = components_of(accessor.type);
  view.normalized = accessor.normalized;
  if (view.element_size() == 0)
    throw Error(path + ": accessor " + std::to_string(index) + " has an unknown element or component type");
  view.stride = view.element_size();
  if (accessor.bufferView < 0) return view;
  const uint8_t* start = view_bytes(model, accessor.bufferView, 0, 0, path);
  const tinygltf::BufferView& buffer_view = model.bufferViews[static_cast<std::size_t>(accessor.bufferView)];
  if (buffer_view.byteStride != 0) view.stride = buffer_view.byteStride;
  if (view.stride < view.element_size() || view.stride > 65535)
    throw Error(path + ": accessor " + std::to_string(index) + " has an impossible stride");
  const std::size_t available = buffer_view.byteLength;
  const std::size_t last = view.count == 0 ? 0 : (view.count - 1);
  if (accessor.byteOffset > available || last > available / view.stride ||
      (view.count > 0 && last * view.stride + view.element_size() > available - accessor.byteOffset))
    throw Error(path + ": accessor " + std::to_string(index) + " reaches beyond buffer view " +
                std::to_string(accessor.bufferView));
  view.data = start + accessor.byteOffset;
  return view;
}

std::vector<float> decode_floats(const tinygltf::Model& model, int index, const std::string& path) {
  const AccessorView view = accessor_view(model, index, path);
  if (view.component_type == TINYGLTF_COMPONENT_TYPE_FLOAT && end_to_end(model, index, view)) {
    std::vector<float> direct(view.count * view.components);
    if (!direct.empty()) std::memcpy(direct.data(), view.data, direct.size() * sizeof(float));
    return direct;
  }
  const std::vector<uint8_t> bytes = packed_elements(model, index, path);
  std::vector<float> values(view.count * view.components);
  if (view.component_type == TINYGLTF_COMPONENT_TYPE_FLOAT) {
    if (!values.empty()) std::memcpy(values.data(), bytes.data(), bytes.size());
    return values;
  }
  const std::size_t size = view.component_size();
  for (std::size_t i = 0; i < values.size(); ++i)
    values[i] = load_component(bytes.data() + i * size, view.component_type, view.normalized);
  return values;
}

std::vector<Triangle> decode_triangles(const tinygltf::Model& model, const tinygltf::Primitive& primitive,
                                       std::size_t vertex_count, const std::string& path) {
  const int mode = primitive.mode < 0 ? TINYGLTF_MODE_TRIANGLES : primitive.mode;
  if (mode < TINYGLTF_MODE_TRIANGLES) return {};
  std::vector<uint32_t> corners;
  if (primitive.indices >= 0) {
    corners = decode_indices(model, primitive.indices, vertex_count, path);
  } else {
    corners.resize(vertex_count);
    for (std::size_t i = 0; i < vertex_count; ++i)
      corners[i] = static_cast<uint32_t>(i);
  }
  std::vector<Triangle> triangles;
  if (mode == TINYGLTF_MODE_TRIANGLES) {
    for (std::size_t i = 0; i + 2 < corners.size(); i += 3)
      triangles.push_back({corners[i], corners[i + 1], corners[i + 2]});
    return triangles;
  }
  for (std::size_t i = 2; i < corners.size(); ++i) {
    if (mode == TINYGLTF_MODE_TRIANGLE_FAN)
      triangles.push_back({corners[0], corners[i - 1], corners[i]});
    else if (i % 2 == 0)
      triangles.push_back({corners[i - 2], corners[i - 1], corners[i]});
    else
      triangles.push_back({corners[i - 1], corners[i - 2], corners[i]});
  }
  return triangles;
}

uint64_t attribute_hash(const tinygltf::Model& model, int index, const std::string& path) {
  const AccessorView view = accessor_view(model, index, path);
  const std::size_t size = view.count * view.element_size();
  if (end_to_end(model, index, view) && size % 4 == 0) return hash_words(view.data, size);
  std::vector<uint8_t> bytes = packed_elements(model, index, path);
  bytes.resize((bytes.size() + 3) / 4 * 4, 0);
  return hash_words(bytes.data(), bytes.size());
}

}  // namespace fascia::gltf
