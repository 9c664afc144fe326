#include "formats/write.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <nlohmann/json.hpp>

#include "formats/files.h"
#include "geometry/error.h"
#include "geometry/text.h"
#include "gltf/edit/edit.h"
#include "gltf/read/container.h"

namespace fascia::formats {

namespace {

Bounds bounds_of(const Drawing& drawing) {
  Bounds box;
  const auto add = [&](const std::vector<Vec3>& points) {
    for (const Vec3& p : points) {
      box.lower = box.lower.cwiseMin(p);
      box.upper = box.upper.cwiseMax(p);
    }
  };
  for (const NamedSurface& surface : drawing.surfaces)
    add(surface.mesh.vertices);
  for (const NamedLines& bundle : drawing.lines)
    for (const auto& line : bundle.lines)
      add(line);
  return box;
}

/// True when single precision would lose the shape of what lies in `box`.
bool is_far_off(const Bounds& box) {
  return box.upper[0] >= box.lower[0] && box.centre().norm() > 16.0 * box.size().norm();
}

/// Coordinates as text: nine digits, the most that single precision has, and more of what lies far off.
class Digits {
 public:
  explicit Digits(const Drawing& drawing) {
    const Bounds box = bounds_of(drawing);
    if (is_far_off(box))
      digits_ = std::min(17, 10 + static_cast<int>(std::log10(box.centre().norm() / box.size().norm())));
  }

  bool are_single() const { return digits_ == 9; }

  std::string point(const Vec3& p) const {
    char text[96];
    std::snprintf(text, sizeof text, "%.*g %.*g %.*g", digits_, p[0], digits_, p[1], digits_, p[2]);
    return text;
  }

 private:
  int digits_ = 9;
};

std::string obj_text(const Drawing& drawing) {
  const Digits digits(drawing);
  std::string text;
  size_t base = 1;
  for (const NamedSurface& surface : drawing.surfaces) {
    text += "o " + surface.name + "\n";
    for (const Vec3& p : surface.mesh.vertices)
      text += "v " + digits.point(p) + "\n";
    for (const Triangle& t : surface.mesh.triangles)
      text += "f " + std::to_string(base + static_cast<size_t>(t[0])) + " " +
              std::to_string(base + static_cast<size_t>(t[1])) + " " +
              std::to_string(base + static_cast<size_t>(t[2])) + "\n";
    base += surface.mesh.vertices.size();
  }
  for (const NamedLines& bundle : drawing.lines) {
    text += "g " + bundle.name + "\n";
    for (const auto& line : bundle.lines) {
      for (const Vec3& p : line)
        text += "v " + digits.point(p) + "\n";
      text += "l";
      for (size_t i = 0; i < line.size(); ++i)
        text += " " + std::to_string(base + i);
      text += "\n";
      base += line.size();
    }
  }
  return text;
}

std::string ply_text(const Drawing& drawing) {
  const Digits digits(drawing);
  std::string points, faces, edges;
  size_t vertices = 0, face_count = 0, edge_count = 0;
  for (const NamedSurface& surface : drawing.surfaces) {
    for (const Vec3& p : surface.mesh.vertices)
      points += digits.point(p) + "\n";
    for (const Triangle& t : surface.mesh.triangles)
      faces += "3 " + std::to_string(vertices + static_cast<size_t>(t[0])) + " " +
               std::to_string(vertices + static_cast<size_t>(t[1])) + " " +
               std::to_string(vertices + static_cast<size_t>(t[2])) + "\n";
    face_count += surface.mesh.triangles.size();
    vertices += surface.mesh.vertices.size();
  }
  std::string comments;
  for (size_t b = 0; b < drawing.lines.size(); ++b) {
    comments += "comment muscle " + std::to_string(b) + " " + drawing.lines[b].name + "\n";
    for (const auto& line : drawing.lines[b].lines) {
      for (const Vec3& p : line)
        points += digits.point(p) + "\n";
      for (size_t i = 0; i + 1 < line.size(); ++i, ++edge_count)
        edges += std::to_string(vertices + i) + " " + std::to_string(vertices + i + 1) + " " +
                 std::to_string(b) + "\n";
      vertices += line.size();
    }
  }
  std::string header = "ply\nformat ascii 1.0\n" + comments + "element vertex " + std::to_string(vertices);
  for (const char* axis : {"x", "y", "z"})
    header += std::string("\nproperty ") + (digits.are_single() ? "float " : "double ") + axis;
  header += "\nelement face " + std::to_string(face_count) + "\nproperty list uchar int vertex_indices\n";
  if (edge_count)
    header += "element edge " + std::to_string(edge_count) +
              "\nproperty int vertex1\nproperty int vertex2\nproperty int muscle\n";
  return header + "end_header\n" + points + faces + edges;
}

std::vector<uint8_t> stl_bytes(const Drawing& drawing) {
  uint32_t count = 0;
  for (const NamedSurface& surface : drawing.surfaces)
    count += static_cast<uint32_t>(surface.mesh.triangles.size());
  std::vector<uint8_t> bytes(84, 0);
  std::memcpy(&bytes[80], &count, 4);
  for (const NamedSurface& surface : drawing.surfaces)
    for (int t = 0; t < surface.mesh.triangle_count(); ++t) {
      float facet[12];
      const Vec3 normal = triangle_normal(surface.mesh, t);
      for (int k = 0; k < 3; ++k) {
        facet[k] = static_cast<float>(normal[k]);
        for (int c = 0; c < 3; ++c)
          facet[3 + 3 * c + k] = static_cast<float>(surface.mesh.vertices[static_cast<size_t>(
              surface.mesh.triangles[static_cast<size_t>(t)][static_cast<size_t>(c)])][k]);
      }
      const auto* raw = reinterpret_cast<const uint8_t*>(facet);
      bytes.insert(bytes.end(), raw, raw + sizeof facet);
      bytes.insert(bytes.end(), 2, 0);
    }
  return bytes;
}

/// Builds a glTF document of meshes of one colour each.
class GltfWriter {
 public:
  explicit GltfWriter(const Vec3& offset) : offset_(offset) {}

  void add_surface(const NamedSurface& surface) {
    Json attributes = {{"POSITION", add_points(surface.mesh.vertices)}};
    std::vector<gltf::Vec3f> normals;
    for (const Vec3& n : vertex_normals(surface.mesh))
      normals.push_back((n.squaredNorm() > 0 ? n : Vec3(Vec3::UnitZ())).cast<float>());
    attributes["NORMAL"] = data_.add_floats(flat(normals), 3, false, gltf::vertex_target);
    std::vector<uint32_t> corners;
    for (const Triangle& t : surface.mesh.triangles)
      corners.insert(corners.end(), t.begin(), t.end());
    Json primitive = {
        {"attributes", attributes}, {"indices", data_.add_indices(corners)}, {"material", materials()}};
    add_mesh(surface.name, surface.colour, Json::array({primitive}));
  }

  void add_lines(const NamedLines& bundle) {
    Json primitives = Json::array();
    for (const auto& line : bundle.lines)
      if (line.size() > 1)
        primitives.push_back(
            {{"attributes", {{"POSITION", add_points(line)}}}, {"mode", 3}, {"material", materials()}});
    if (!primitives.empty()) add_mesh(bundle.name, bundle.colour, primitives);
  }

  std::vector<uint8_t> bytes() {
    for (size_t n = 0; n < json_["nodes"].size(); ++n)
      json_["scenes"][0]["nodes"].push_back(n);
    json_["buffers"] = Json::array({{{"byteLength", bin_.size()}}});
    return gltf::glb_bytes(gltf::text_of(json_), bin_);
  }

 private:
  using Json = gltf::Json;

  static std::span<const float> flat(const std::vector<gltf::Vec3f>& points) {
    return {reinterpret_cast<const float*>(points.data()), 3 * points.size()};
  }

  size_t materials() const { return json_.contains("materials") ? json_["materials"].size() : 0; }

  size_t add_points(const std::vector<Vec3>& points) {
    std::vector<gltf::Vec3f> values;
    for (const Vec3& p : points)
      values.push_back((p - offset_).cast<float>());
    return data_.add_floats(flat(values), 3, true, gltf::vertex_target);
  }

  void add_mesh(const std::string& name, const Vec3& colour, const Json& primitives) {
    json_["materials"].push_back({{"name", name},
                                  {"pbrMetallicRoughness",
                                   {{"baseColorFactor", {colour[0], colour[1], colour[2], 1.0}},
                                    {"metallicFactor", 0.0},
                                    {"roughnessFactor", 0.7}}}});
    json_["meshes"].push_back({{"name", name}, {"primitives", primitives}});
    Json node = {{"name", name}, {"mesh", json_["meshes"].size() - 1}};
    if (!offset_.isZero(0)) node["translation"] = {offset_[0], offset_[1], offset_[2]};
    json_["nodes"].push_back(std::move(node));
  }

  Json json_ = {{"asset", {{"version", "2.0"}, {"generator", "fascia"}}},
                {"scene", 0},
                {"scenes", Json::array({{{"nodes", Json::array()}}})},
                {"nodes", Json::array()}};
  Vec3 offset_;  ///< where the meshes' coordinates begin
  std::vector<uint8_t> bin_;
  gltf::Appendix data_{json_, bin_};
};

std::vector<uint8_t> glb_of(const Drawing& drawing) {
  const Bounds box = bounds_of(drawing);
  GltfWriter writer(is_far_off(box) ? box.centre() : Vec3(Vec3::Zero()));
  for (const NamedSurface& surface : drawing.surfaces)
    if (!surface.mesh.empty()) writer.add_surface(surface);
  for (const NamedLines& bundle : drawing.lines)
    writer.add_lines(bundle);
  return writer.bytes();
}

}  // namespace

void write(const std::filesystem::path& path, const Drawing& drawing) {
  const std::string extension = extension_of(path);
  if (extension == ".obj") {
    write_text(path, obj_text(drawing));
  } else if (extension == ".ply") {
    write_text(path, ply_text(drawing));
  } else if (extension == ".stl") {
    if (!drawing.lines.empty())
      throw Error("'" + path.string() + "': STL cannot hold fibres; write OBJ, PLY or GLB");
    if (is_far_off(bounds_of(drawing)))
      throw Error("'" + path.string() +
                  "': STL holds single precision, too coarse so far from the origin; write PLY, OBJ "
                  "or GLB");
    const std::vector<uint8_t> bytes = stl_bytes(drawing);
    write_bytes(path, bytes.data(), bytes.size());
  } else if (extension == ".glb") {
    const std::vector<uint8_t> bytes = glb_of(drawing);
    write_bytes(path, bytes.data(), bytes.size());
  } else {
    throw Error("'" + path.string() +
                "': its extension is none that is written here; use .obj, .ply, .stl or .glb");
  }
}

}  // namespace fascia::formats
