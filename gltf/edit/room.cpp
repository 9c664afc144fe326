#include "gltf/edit/room.h"

#include <algorithm>
#include <set>

#include "gltf/edit/element.h"
#include "gltf/tinygltf/tinygltf.h"

namespace fascia::gltf {
namespace {

std::size_t uses_in(const Json& attributes, std::size_t accessor) {
  std::size_t uses = 0;
  for (const Json& attribute : attributes)
    if (attribute == accessor) ++uses;
  return uses;
}

std::size_t uses_in_mesh(const Json& mesh, std::size_t accessor) {
  std::size_t uses = 0;
  for (const Json& primitive : mesh.value("primitives", Json::array())) {
    uses += uses_in(primitive.value("attributes", Json::object()), accessor);
    if (primitive.contains("indices") && primitive["indices"] == accessor) ++uses;
    for (const Json& target : primitive.value("targets", Json::array()))
      uses += uses_in(target, accessor);
  }
  return uses;
}

/// All whole numbers in extensions that may hold indices of accessors or views; those of our own rig hold
/// none of what the file had before.
void add_numbers(const Json& value, std::set<std::size_t>& numbers) {
  if (value.is_number_unsigned()) numbers.insert(value.get<std::size_t>());
  if (!value.is_structured()) return;
  for (const auto& [key, entry] : value.items())
    if (!key.starts_with("FASCIA_")) add_numbers(entry, numbers);
}

std::set<std::size_t> numbers_in_extensions(const Json& root) {
  std::set<std::size_t> numbers;
  const auto add = [&](const Json& object) {
    if (object.contains("extensions")) add_numbers(object["extensions"], numbers);
  };
  add(root);
  for (const Json& node : root.value("nodes", Json::array()))
    add(node);
  for (const Json& mesh : root.value("meshes", Json::array())) {
    add(mesh);
    for (const Json& primitive : mesh.value("primitives", Json::array()))
      add(primitive);
  }
  return numbers;
}

/// Numbers in an element, at most: columns of matrices of small numbers are padded.
std::size_t most_components(const std::string& type) {
  constexpr std::size_t largest = 16;
  const std::size_t count = components_of(type);
  return count > 0 ? count : largest;
}

ByteRange bytes_of_view(const Json& root, std::size_t view) {
  const Json& entry = root.at("bufferViews").at(view);
  const std::size_t begin = entry.value("byteOffset", std::size_t{0});
  return {begin, begin + entry.value("byteLength", std::size_t{0})};
}

/// One of the up to three places an accessor reads: elements of `size` bytes in a view.
struct Piece {
  std::size_t view = 0;
  ByteRange bytes;
};

Piece piece(const Json& root, const Json& place, std::size_t count, std::size_t size) {
  const std::size_t view = place.at("bufferView");
  const ByteRange whole = bytes_of_view(root, view);
  const std::size_t stride = root["bufferViews"][view].value("byteStride", size);
  const std::size_t begin = whole.begin + place.value("byteOffset", std::size_t{0});
  const std::size_t length = count > 0 ? (count - 1) * stride + size : 0;
  return {view, {std::min(begin, whole.end), std::min(begin + length, whole.end)}};
}

std::vector<Piece> pieces_of(const Json& root, std::size_t accessor) {
  const Json& entry = root.at("accessors").at(accessor);
  const std::size_t size =
      bytes_of(entry.value("componentType", 0)) * most_components(entry.value("type", std::string()));
  std::vector<Piece> pieces;
  if (entry.contains("bufferView"))
    pieces.push_back(piece(root, entry, entry.value("count", std::size_t{0}), size));
  if (entry.contains("sparse")) {
    const Json& sparse = entry["sparse"];
    const std::size_t count = sparse.at("count");
    const Json& indices = sparse.at("indices");
    pieces.push_back(piece(root, indices, count, bytes_of(indices.value("componentType", 0))));
    pieces.push_back(piece(root, sparse.at("values"), count, size));
  }
  return pieces;
}

/// What all but `accessor` read.
struct Others {
  std::vector<ByteRange> bytes;
  std::set<std::size_t> views;
};

Others others(const Json& root, std::size_t accessor, const std::vector<Piece>& pieces) {
  Others result;
  std::set<std::size_t> own;
  for (const Piece& piece : pieces)
    own.insert(piece.view);
  for (std::size_t a = 0; a < root["accessors"].size(); ++a)
    if (a != accessor)
      for (const Piece& piece : pieces_of(root, a)) {
        result.bytes.push_back(piece.bytes);
        result.views.insert(piece.view);
      }
  const std::size_t count = root.value("bufferViews", Json::array()).size();
  for (const std::size_t number : numbers_in_extensions(root))
    if (number < count && result.views.insert(number).second)
      result.bytes.push_back(bytes_of_view(root, number));
  for (const Json& image : root.value("images", Json::array()))
    if (image.contains("bufferView") && image["bufferView"] < count) {
      result.views.insert(image["bufferView"].get<std::size_t>());
      result.bytes.push_back(bytes_of_view(root, image["bufferView"]));
    }
  for (std::size_t view = 0; view < count; ++view)
    if (!own.contains(view) && !result.views.contains(view))
      result.bytes.push_back(bytes_of_view(root, view));
  return result;
}

/// Adds a range to others that do not meet one another: those it meets become one with it.
void add_range(ByteRange range, std::vector<ByteRange>& ranges) {
  for (auto other = ranges.begin(); other != ranges.end();) {
    if (!other->meets(range)) {
      ++other;
      continue;
    }
    range = {std::min(range.begin, other->begin), std::max(range.end, other->end)};
    other = ranges.erase(other);
  }
  if (range.size() > 0) ranges.push_back(range);
}

}  // namespace

std::size_t uses_of(const Json& root, std::size_t accessor) {
  std::size_t uses = 0;
  for (const Json& mesh : root.value("meshes", Json::array()))
    uses += uses_in_mesh(mesh, accessor);
  for (const Json& skin : root.value("skins", Json::array()))
    if (skin.contains("inverseBindMatrices") && skin["inverseBindMatrices"] == accessor) ++uses;
  for (const Json& animation : root.value("animations", Json::array()))
    for (const Json& sampler : animation.value("samplers", Json::array()))
      for (const char* end : {"input", "output"})
        if (sampler.contains(end) && sampler[end] == accessor) ++uses;
  return uses + numbers_in_extensions(root).count(accessor);
}

OwnRoom own_room(const Json& root, std::size_t accessor) {
  const std::vector<Piece> pieces = pieces_of(root, accessor);
  const Others other = others(root, accessor, pieces);
  OwnRoom own;
  for (const Piece& piece : pieces) {
    if (std::none_of(other.bytes.begin(), other.bytes.end(),
                     [&](const ByteRange& bytes) { return bytes.meets(piece.bytes); }))
      add_range(piece.bytes, own.bytes);
    if (!other.views.contains(piece.view) &&
        std::find(own.views.begin(), own.views.end(), piece.view) == own.views.end())
      own.views.push_back(piece.view);
  }
  return own;
}

}  // namespace fascia::gltf
