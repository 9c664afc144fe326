#include "cli/posed_output.h"

#include <sstream>

#include "cli/gltf_edit.h"
#include "formats/scene.h"
#include "formats/write.h"
#include "geometry/error.h"
#include "rig/read/read.h"
#include "rig/write/write.h"

namespace fascia::cli {

namespace {

std::vector<Vec3> points_of(std::span<const float> flat) {
  std::vector<Vec3> points;
  for (size_t i = 0; i + 2 < flat.size(); i += 3)
    points.emplace_back(flat[i], flat[i + 1], flat[i + 2]);
  return points;
}

/// The OBJ text with the `v` lines in `moved` (by number, from 0) put in new places.
std::string patched_obj(const std::vector<uint8_t>& bytes, const std::map<int, Vec3>& moved) {
  std::istringstream lines(std::string(bytes.begin(), bytes.end()));
  std::string text, line;
  int vertex = 0;
  while (std::getline(lines, line)) {
    const size_t start = line.find_first_not_of(" \t");
    const bool is_vertex = start != std::string::npos && line[start] == 'v' && start + 1 < line.size() &&
                           (line[start + 1] == ' ' || line[start + 1] == '\t');
    if (is_vertex) {
      if (const auto at = moved.find(vertex); at != moved.end()) {
        // Whatever follows the coordinates (weights, colours, a carriage return) stays.
        size_t rest = start + 1;
        for (int k = 0; k < 3; ++k) {
          rest = line.find_first_not_of(" \t", rest);
          rest = rest == std::string::npos ? line.size() : line.find_first_of(" \t\r", rest);
          if (rest == std::string::npos) rest = line.size();
        }
        char place[96];
        std::snprintf(place, sizeof place, "v %.7g %.7g %.7g", at->second[0], at->second[1], at->second[2]);
        line = place + line.substr(rest);
      }
      ++vertex;
    }
    text += line;
    if (!lines.eof()) text += '\n';
  }
  return text;
}

std::string obj_like_source(const rig::SourceRecord& source, const Face& face) {
  const formats::Scene scene = formats::read("source.obj", source.bytes);
  std::map<int, Vec3> moved;
  for (size_t m = 0; m < face.meshes().size(); ++m) {
    const FaceMesh& mesh = face.meshes()[m];
    if (mesh.mesh >= scene.meshes.size())
      throw Error("the rig's record of its OBJ does not fit its meshes: build it again");
    const formats::SceneMesh& original = scene.meshes[mesh.mesh];
    const std::vector<Vec3> posed = points_of(face.positions(m));
    for (size_t v = 0; v < posed.size() && v < original.positions.size(); ++v) {
      const bool stays =
          posed[v] == original.positions[v].cast<float>().cast<double>() ||
          (posed[v] - original.positions[v]).norm() < 1e-6 * (1.0 + original.positions[v].norm());
      if (!stays) moved[original.source_vertices[v]] = posed[v];
    }
  }
  return patched_obj(source.bytes, moved);
}

}  // namespace

void write_posed_glb(const std::filesystem::path& rig, const Face& face,
                     const std::filesystem::path& output) {
  const std::vector<uint8_t> bytes = formats::read_bytes(rig);
  GltfEdit edit(rig::original(rig::glb_source(bytes, rig.string())));
  for (size_t m = 0; m < face.meshes().size(); ++m)
    set_pose(edit, {face.meshes()[m].mesh, face.meshes()[m].primitive, face.positions(m), face.normals(m)});
  const std::vector<uint8_t> posed = edit.bytes();
  formats::write_bytes(output, posed.data(), posed.size());
}

void write_posed_mesh(const std::filesystem::path& rig, const Face& face,
                      const std::filesystem::path& output) {
  const rig::RigFile file = rig::read(formats::read_bytes(rig), rig.string());
  if (file.source.format == "obj" && output.extension() == ".obj") {
    formats::write_text(output, obj_like_source(file.source, face));
    return;
  }
  formats::Drawing drawing;
  for (size_t m = 0; m < face.meshes().size(); ++m)
    drawing.surfaces.push_back(
        {face.meshes()[m].name, {points_of(face.positions(m)), face.meshes()[m].triangles}});
  formats::write(output, drawing);
}

}  // namespace fascia::cli
