#include "formats/write.h"

#include <algorithm>
#include <cstring>
#include <nlohmann/json.hpp>

#include "formats/gltf_document.h"
#include "geometry/error.h"

namespace fascia::formats {

namespace {

std::string number(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.9g", value);
  return text;
}

std::string point_text(const Vec3& p) {
  return number(p[0]) + " " + number(p[1]) + " " + number(p[2]);
}

std::string obj_text(const Drawing& drawing) {
  std::string text;
  size_t base = 1;
  for (const NamedSurface& surface : drawing.surfaces) {
    text += "o " + surface.name + "\n";
    for (const Vec3& p : surface.mesh.vertices)
      text += "v " + point_text(p) + "\n";
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
        text += "v " + point_text(p) + "\n";
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
  std::string points, faces, edges;
  size_t vertices = 0, face_count = 0, edge_count = 0;
  for (const NamedSurface& surface : drawing.surfaces) {
    for (const Vec3& p : surface.mesh.vertices)
      points += point_text(p) + "\n";
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
        points += point_text(p) + "\n";
      for (size_t i = 0; i + 1 < line.size(); ++i, ++edge_count)
        edges += std::to_string(vertices + i) + " " + std::to_string(vertices + i + 1) + " " +
                 std::to_string(b) + "\n";
      vertices += line.size();
    }
  }
  std::string header = "ply\nformat ascii 1.0\n" + comments + "element vertex " + std::to_string(vertices) +
                       "\nproperty float x\nproperty float y\nproperty float z\nelement face " +
                       std::to_string(face_count) + "\nproperty list uchar int vertex_indices\n";
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

/// Builds a glTF document of position-only meshes.
class GltfWriter {
 public:
  void add_surface(const NamedSurface& surface) {
    const size_t positions = add_points(surface.mesh.vertices);
    std::vector<uint32_t> indices;
    for (const Triangle& t : surface.mesh.triangles)
      for (int corner : t)
        indices.push_back(static_cast<uint32_t>(corner));
    const size_t order =
        add_accessor(indices.data(), indices.size() * 4, 34963, 5125, "SCALAR", indices.size());
    add_mesh(
        surface.name, surface.colour,
        {{{"attributes", {{"POSITION", positions}}}, {"indices", order}, {"material", materials_.size()}}});
  }

  void add_lines(const NamedLines& bundle) {
    nlohmann::ordered_json primitives = nlohmann::ordered_json::array();
    for (const auto& line : bundle.lines)
      if (line.size() > 1)
        primitives.push_back(
            {{"attributes", {{"POSITION", add_points(line)}}}, {"mode", 3}, {"material", materials_.size()}});
    if (!primitives.empty()) add_mesh(bundle.name, bundle.colour, primitives);
  }

  std::vector<uint8_t> bytes() {
    nlohmann::ordered_json json = {{"asset", {{"version", "2.0"}, {"generator", "fascia"}}}, {"scene", 0}};
    nlohmann::ordered_json roots = nlohmann::ordered_json::array();
    for (size_t n = 0; n < nodes_.size(); ++n)
      roots.push_back(n);
    json["scenes"] = nlohmann::ordered_json::array({{{"nodes", roots}}});
    json["nodes"] = nodes_;
    json["meshes"] = meshes_;
    json["materials"] = materials_;
    json["accessors"] = accessors_;
    json["bufferViews"] = views_;
    json["buffers"] = nlohmann::ordered_json::array({{{"byteLength", binary_.size()}}});
    return glb_bytes({json.dump(), binary_});
  }

 private:
  size_t add_accessor(const void* data, size_t size, int target, int component, const char* type,
                      size_t count) {
    binary_.resize((binary_.size() + 3) / 4 * 4);
    views_.push_back(
        {{"buffer", 0}, {"byteOffset", binary_.size()}, {"byteLength", size}, {"target", target}});
    const auto* raw = static_cast<const uint8_t*>(data);
    binary_.insert(binary_.end(), raw, raw + size);
    accessors_.push_back(
        {{"bufferView", views_.size() - 1}, {"componentType", component}, {"count", count}, {"type", type}});
    return accessors_.size() - 1;
  }

  size_t add_points(const std::vector<Vec3>& points) {
    std::vector<float> values;
    Eigen::Vector3f low = Eigen::Vector3f::Constant(3e38F), high = -low;
    for (const Vec3& p : points) {
      const Eigen::Vector3f q = p.cast<float>();
      values.insert(values.end(), q.data(), q.data() + 3);
      low = low.cwiseMin(q);
      high = high.cwiseMax(q);
    }
    const size_t index = add_accessor(values.data(), values.size() * 4, 34962, 5126, "VEC3", points.size());
    accessors_[index]["min"] = {low[0], low[1], low[2]};
    accessors_[index]["max"] = {high[0], high[1], high[2]};
    return index;
  }

  void add_mesh(const std::string& name, const Vec3& colour, const nlohmann::ordered_json& primitives) {
    materials_.push_back({{"name", name},
                          {"pbrMetallicRoughness",
                           {{"baseColorFactor", {colour[0], colour[1], colour[2], 1.0}},
                            {"metallicFactor", 0.0},
                            {"roughnessFactor", 0.7}}}});
    meshes_.push_back({{"name", name}, {"primitives", primitives}});
    nodes_.push_back({{"name", name}, {"mesh", meshes_.size() - 1}});
  }

  std::vector<uint8_t> binary_;
  nlohmann::ordered_json views_ = nlohmann::ordered_json::array(), accessors_ = views_, meshes_ = views_,
                         nodes_ = views_, materials_ = views_;
};

std::vector<uint8_t> glb_of(const Drawing& drawing) {
  GltfWriter writer;
  for (const NamedSurface& surface : drawing.surfaces)
    if (!surface.mesh.empty()) writer.add_surface(surface);
  for (const NamedLines& bundle : drawing.lines)
    writer.add_lines(bundle);
  return writer.bytes();
}

}  // namespace

void write(const std::filesystem::path& path, const Drawing& drawing) {
  const std::string extension = path.extension().string();
  if (extension == ".obj") {
    write_text(path, obj_text(drawing));
  } else if (extension == ".ply") {
    write_text(path, ply_text(drawing));
  } else if (extension == ".stl") {
    if (!drawing.lines.empty())
      throw Error("'" + path.string() + "': STL cannot hold fibres; write OBJ, PLY or GLB");
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
