#include <array>
#include <charconv>
#include <cstring>
#include <sstream>

#include "formats/detail.h"
#include "gltf/read/text.h"

namespace fascia::formats::detail {

namespace {

enum class Encoding { ascii, little_endian, big_endian };

struct Property {
  std::string name, type, count_type;  // count_type is empty for a scalar
};

struct Element {
  std::string name;
  size_t count = 0;
  std::vector<Property> properties;
};

struct Header {
  Encoding encoding = Encoding::ascii;
  std::vector<Element> elements;
  size_t size = 0;  // bytes up to and with the end_header line
};

size_t size_of(const Scene& scene, const std::string& type) {
  if (type == "char" || type == "uchar" || type == "int8" || type == "uint8") return 1;
  if (type == "short" || type == "ushort" || type == "int16" || type == "uint16") return 2;
  if (type == "int" || type == "uint" || type == "float" || type == "int32" || type == "uint32" ||
      type == "float32")
    return 4;
  if (type == "double" || type == "float64") return 8;
  fail(scene, "its PLY header names the unknown type '" + gltf::as_utf8(type) + "'");
}

/// The header's lines, ended by LF, CR or both, and where the body begins.
std::vector<std::string> header_lines(const Scene& scene, size_t& body) {
  const std::vector<uint8_t>& bytes = scene.bytes;
  std::vector<std::string> lines(1);
  bool crlf = false;
  for (size_t i = 0; i < bytes.size() && i < (size_t{1} << 20); ++i) {
    const char c = static_cast<char>(bytes[i]);
    if (c != '\n' && c != '\r') {
      lines.back().push_back(c);
      continue;
    }
    const bool both = c == '\r' && i + 1 < bytes.size() && bytes[i + 1] == '\n';
    // After a lone CR a byte of the body may look like LF: the first line tells which it is.
    if (lines.size() == 1) crlf = both;
    if (both && crlf) ++i;
    if (lines.back().rfind("end_header", 0) == 0) {
      body = i + 1;
      return lines;
    }
    lines.emplace_back();
  }
  fail(scene, "its PLY header has no end: the file is truncated");
}

void read_property(const Scene& scene, std::istringstream& words, Header& header) {
  Property property;
  words >> property.type;
  if (property.type == "list") {
    words >> property.count_type >> property.type;
    size_of(scene, property.count_type);
  }
  words >> property.name;
  if (header.elements.empty() || property.name.empty())
    fail(scene, "its PLY header has a broken property line");
  size_of(scene, property.type);
  header.elements.back().properties.push_back(property);
}

Header read_header(const Scene& scene) {
  Header header;
  for (const std::string& line : header_lines(scene, header.size)) {
    std::istringstream words(line);
    std::string word;
    words >> word;
    if (word == "format") {
      words >> word;
      if (word == "binary_little_endian")
        header.encoding = Encoding::little_endian;
      else if (word == "binary_big_endian")
        header.encoding = Encoding::big_endian;
      else if (word != "ascii")
        fail(scene, "its PLY format '" + gltf::as_utf8(word) + "' is unknown");
    } else if (word == "element") {
      Element element;
      if (!(words >> element.name >> element.count)) fail(scene, "its PLY header has a broken element line");
      header.elements.push_back(element);
    } else if (word == "property") {
      read_property(scene, words, header);
    }
  }
  return header;
}

/// Reads one number after the other from the body, in the file's encoding.
class Body {
 public:
  Body(const Scene& scene, const Header& header)
      : scene_(scene), encoding_(header.encoding), at_(header.size) {}

  double next(const std::string& type) {
    return encoding_ == Encoding::ascii ? next_word() : next_binary(type);
  }

  size_t left() const { return scene_.bytes.size() - at_; }

 private:
  double next_word() {
    const std::vector<uint8_t>& bytes = scene_.bytes;
    while (at_ < bytes.size() && std::isspace(bytes[at_]))
      ++at_;
    std::string word;
    while (at_ < bytes.size() && !std::isspace(bytes[at_]))
      word.push_back(static_cast<char>(bytes[at_++]));
    if (word.empty()) fail(scene_, "it ends before its last element: the file is truncated");
    double value = 0.0;
    const char* begin = word.c_str() + (word[0] == '+' ? 1 : 0);
    const auto parsed = std::from_chars(begin, word.c_str() + word.size(), value);
    if (parsed.ec != std::errc() || *parsed.ptr != 0)
      fail(scene_, "'" + gltf::as_utf8(word.substr(0, 40)) + "' stands where a number should");
    return value;
  }

  double next_binary(const std::string& type) {
    const size_t size = size_of(scene_, type);
    if (left() < size) fail(scene_, "it ends before its last element: the file is truncated");
    uint8_t raw[8];
    for (size_t i = 0; i < size; ++i)
      raw[i] = scene_.bytes[at_ + (encoding_ == Encoding::little_endian ? i : size - 1 - i)];
    at_ += size;
    return decode(type, raw);
  }

  template <class T>
  static double as(const uint8_t* raw) {
    T value;
    std::memcpy(&value, raw, sizeof value);
    return static_cast<double>(value);
  }

  static double decode(const std::string& type, const uint8_t* raw) {
    if (type == "char" || type == "int8") return as<int8_t>(raw);
    if (type == "uchar" || type == "uint8") return as<uint8_t>(raw);
    if (type == "short" || type == "int16") return as<int16_t>(raw);
    if (type == "ushort" || type == "uint16") return as<uint16_t>(raw);
    if (type == "int" || type == "int32") return as<int32_t>(raw);
    if (type == "uint" || type == "uint32") return as<uint32_t>(raw);
    if (type == "float" || type == "float32") return as<float>(raw);
    return as<double>(raw);
  }

  const Scene& scene_;
  Encoding encoding_;
  size_t at_;
};

/// Numbers of one element, its scalars by property and its lists.
struct Row {
  std::vector<double> scalars;
  std::vector<std::vector<double>> lists;
};

void read_row(const Scene& scene, const Element& element, Body& body, Row& row) {
  row.scalars.assign(element.properties.size(), 0.0);
  row.lists.assign(element.properties.size(), {});
  for (size_t p = 0; p < element.properties.size(); ++p) {
    const Property& property = element.properties[p];
    if (property.count_type.empty()) {
      row.scalars[p] = body.next(property.type);
      continue;
    }
    const double count = body.next(property.count_type);
    if (!(count >= 0) || count > static_cast<double>(body.left()))
      fail(scene, "element '" + gltf::as_utf8(element.name) + "' has an impossible list length");
    for (size_t k = 0; k < static_cast<size_t>(count); ++k)
      row.lists[p].push_back(body.next(property.type));
  }
}

int property_of(const Element& element, std::initializer_list<const char*> names) {
  for (const char* name : names)
    for (size_t p = 0; p < element.properties.size(); ++p)
      if (element.properties[p].name == name) return static_cast<int>(p);
  return -1;
}

void read_vertices(const Scene& scene, const Element& element, Body& body, SceneMesh& mesh) {
  std::array<int, 3> axes;
  for (size_t k = 0; k < 3; ++k) {
    const std::string name(1, static_cast<char>('x' + k));
    axes[k] = property_of(element, {name.c_str()});
    if (axes[k] < 0) fail(scene, "its PLY vertices have no '" + name + "'");
  }
  const int u = property_of(element, {"s", "u", "texture_u"}),
            v = property_of(element, {"t", "v", "texture_v"});
  Row row;
  for (size_t i = 0; i < element.count; ++i) {
    read_row(scene, element, body, row);
    const auto at = [&](int property) { return row.scalars[static_cast<size_t>(property)]; };
    mesh.positions.emplace_back(at(axes[0]), at(axes[1]), at(axes[2]));
    if (u >= 0 && v >= 0) mesh.uvs.emplace_back(at(u), 1.0 - at(v));
  }
}

void read_faces(const Scene& scene, const Element& element, Body& body, SceneMesh& mesh) {
  const int corners = property_of(element, {"vertex_indices", "vertex_index"});
  Row row;
  for (size_t i = 0; i < element.count && !element.properties.empty(); ++i) {
    read_row(scene, element, body, row);
    if (corners < 0) continue;
    std::vector<int> polygon;
    for (const double corner : row.lists[static_cast<size_t>(corners)]) {
      if (!(corner >= 0) || corner > 2147483647.0)
        fail(scene, "face " + std::to_string(i) + " names a vertex that is not there");
      polygon.push_back(static_cast<int>(corner));
    }
    mesh.polygons.push_back(std::move(polygon));
  }
}

/// Strips of triangles, one after the other with -1 between them (Stanford's range data repository).
void read_strips(const Scene& scene, const Element& element, Body& body, SceneMesh& mesh) {
  const int corners = property_of(element, {"vertex_indices", "vertex_index"});
  Row row;
  for (size_t i = 0; i < element.count && !element.properties.empty(); ++i) {
    read_row(scene, element, body, row);
    std::vector<int> strip;
    for (const double corner :
         corners < 0 ? std::vector<double>() : row.lists[static_cast<size_t>(corners)]) {
      if (corner < 0) strip.clear();
      if (corner < 0) continue;
      if (!(corner <= 2147483647.0)) fail(scene, "a strip names a vertex that is not there");
      strip.push_back(static_cast<int>(corner));
      const size_t n = strip.size();
      if (n < 3) continue;
      const int a = strip[n - 3], b = strip[n - 2], c = strip[n - 1];
      if (a == b || b == c || c == a) continue;  // stitching
      mesh.polygons.push_back(n % 2 ? std::vector<int>{a, b, c} : std::vector<int>{b, a, c});
    }
  }
}

void pass_over(const Scene& scene, const Element& element, Body& body) {
  Row row;
  for (size_t i = 0; i < element.count && !element.properties.empty(); ++i)
    read_row(scene, element, body, row);
}

/// Faces may come before the vertices, so that corners are checked at the end.
void triangulate_faces(const Scene& scene, SceneMesh& mesh) {
  for (size_t i = 0; i < mesh.polygons.size(); ++i) {
    for (const int corner : mesh.polygons[i])
      if (corner >= static_cast<int>(mesh.positions.size()))
        fail(scene, "face " + std::to_string(i) + " names a vertex that is not there");
    triangulate(mesh.positions, mesh.polygons[i], mesh.triangles);
  }
}

}  // namespace

void read_ply(Scene& scene) {
  const Header header = read_header(scene);
  Body body(scene, header);
  SceneMesh mesh;
  mesh.name = gltf::as_utf8(scene.path.stem().string());
  for (const Element& element : header.elements) {
    if (element.name == "vertex")
      read_vertices(scene, element, body, mesh);
    else if (element.name == "face")
      read_faces(scene, element, body, mesh);
    else if (element.name == "tristrips")
      read_strips(scene, element, body, mesh);
    else
      pass_over(scene, element, body);
  }
  triangulate_faces(scene, mesh);
  scene.meshes.push_back(std::move(mesh));
}

}  // namespace fascia::formats::detail
