#include <cstring>
#include <sstream>

#include "formats/detail.h"

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
  fail(scene, "its PLY header names the unknown type '" + type + "'");
}

Header read_header(const Scene& scene) {
  Header header;
  const std::string text(scene.bytes.begin(),
                         scene.bytes.begin() + std::min<size_t>(scene.bytes.size(), 65536));
  const size_t end = text.find("end_header");
  if (end == std::string::npos) fail(scene, "its PLY header has no end: the file is truncated");
  header.size = text.find('\n', end);
  if (header.size == std::string::npos) fail(scene, "it ends with its PLY header: the file is truncated");
  ++header.size;
  std::istringstream lines(text.substr(0, end));
  for (std::string line; std::getline(lines, line);) {
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
        fail(scene, "its PLY format '" + word + "' is unknown");
    } else if (word == "element") {
      Element element;
      if (!(words >> element.name >> element.count)) fail(scene, "its PLY header has a broken element line");
      header.elements.push_back(element);
    } else if (word == "property") {
      Property property;
      words >> property.type;
      if (property.type == "list") words >> property.count_type >> property.type;
      words >> property.name;
      if (header.elements.empty() || property.name.empty())
        fail(scene, "its PLY header has a broken property line");
      size_of(scene, property.type);
      header.elements.back().properties.push_back(property);
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
    char* end = nullptr;
    const double value = std::strtod(word.c_str(), &end);
    if (*end != 0) fail(scene_, "'" + word + "' stands where a number should");
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

void read_vertices(const Scene& scene, const Element& element, Body& body, SceneMesh& mesh) {
  for (const char* axis : {"x", "y", "z"}) {
    bool found = false;
    for (const Property& property : element.properties)
      found |= property.name == axis;
    if (!found) fail(scene, std::string("its PLY vertices have no '") + axis + "'");
  }
  for (size_t i = 0; i < element.count; ++i) {
    Vec3 p = Vec3::Zero();
    for (const Property& property : element.properties) {
      if (!property.count_type.empty()) {
        for (double n = body.next(property.count_type); n > 0; --n)
          body.next(property.type);
        continue;
      }
      const double value = body.next(property.type);
      if (property.name.size() == 1 && property.name[0] >= 'x' && property.name[0] <= 'z')
        p[property.name[0] - 'x'] = value;
    }
    mesh.positions.push_back(p);
  }
}

void read_faces(const Scene& scene, const Element& element, Body& body, SceneMesh& mesh) {
  for (size_t i = 0; i < element.count; ++i)
    for (const Property& property : element.properties) {
      if (property.count_type.empty()) {
        body.next(property.type);
        continue;
      }
      const double corners = body.next(property.count_type);
      if (!(corners >= 0) || corners > static_cast<double>(body.left()))
        fail(scene, "face " + std::to_string(i) + " has an impossible corner count");
      std::vector<int> polygon;
      for (int k = 0; k < static_cast<int>(corners); ++k) {
        const double corner = body.next(property.type);
        if (!(corner >= 0) || corner >= static_cast<double>(mesh.positions.size()))
          fail(scene, "face " + std::to_string(i) + " names a vertex that is not there");
        polygon.push_back(static_cast<int>(corner));
      }
      if (property.name == "vertex_indices" || property.name == "vertex_index") {
        triangulate(mesh.positions, polygon, mesh.triangles);
        mesh.polygons.push_back(std::move(polygon));
      }
    }
}

}  // namespace

void read_ply(Scene& scene) {
  const Header header = read_header(scene);
  Body body(scene, header);
  SceneMesh mesh;
  mesh.name = scene.path.stem().string();
  for (const Element& element : header.elements) {
    if (element.name == "vertex") {
      read_vertices(scene, element, body, mesh);
    } else if (element.name == "face") {
      read_faces(scene, element, body, mesh);
    } else {
      for (size_t i = 0; i < element.count; ++i)
        for (const Property& property : element.properties) {
          double values = property.count_type.empty() ? 1 : body.next(property.count_type);
          for (; values > 0; --values)
            body.next(property.type);
        }
    }
  }
  scene.meshes.push_back(std::move(mesh));
}

}  // namespace fascia::formats::detail
