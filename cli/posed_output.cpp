#include "cli/posed_output.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "builder/rigging/gltf_source.h"
#include "cli/gltf_edit.h"
#include "formats/obj_lines.h"
#include "formats/scene.h"
#include "formats/write.h"
#include "geometry/error.h"
#include "geometry/json.h"
#include "geometry/text.h"
#include "rig/read/read.h"
#include "rig/write/write.h"

namespace fascia::cli {

namespace {

std::vector<Vec3> points_of(std::span<const float> flat, const Vec3& offset) {
  std::vector<Vec3> points;
  for (size_t i = 0; i + 2 < flat.size(); i += 3)
    points.push_back(Vec3(flat[i], flat[i + 1], flat[i + 2]) + offset);
  return points;
}

/// Decimals that keep a ten-millionth of the size of what is written.
int decimals_for(const formats::Scene& scene) {
  Bounds box;
  for (const formats::SceneMesh& mesh : scene.meshes)
    for (const Vec3& p : mesh.positions) {
      box.lower = box.lower.cwiseMin(p);
      box.upper = box.upper.cwiseMax(p);
    }
  return std::clamp(static_cast<int>(std::ceil(7.0 - std::log10(box.size().maxCoeff()))), 0, 15);
}

/// The `v` line of each vertex of each mesh: as the rig's notes have it, else as the file is read.
std::vector<std::vector<int>> source_vertices(const rig::SourceRecord& source, const formats::Scene& scene) {
  std::vector<std::vector<int>> lines;
  if (!source.json.empty()) {
    const auto notes = parse_json<nlohmann::json>(source.json, "the rig's record of its OBJ");
    if (notes.is_object() && notes.contains("sourceVertices")) try {
        return notes["sourceVertices"].get<std::vector<std::vector<int>>>();
      } catch (const nlohmann::json::exception&) {
        throw Error("the rig's record of its OBJ is damaged: build it again");
      }
  }
  for (const formats::SceneMesh& mesh : scene.meshes)
    lines.push_back(mesh.source_vertices);
  return lines;
}

std::string obj_like_source(const rig::SourceRecord& source, const Face& face) {
  const formats::Scene scene = formats::read("source.obj", source.bytes);
  const std::vector<std::vector<int>> lines = source_vertices(source, scene);
  std::map<int, Vec3> places, moved;
  for (const formats::SceneMesh& mesh : scene.meshes)
    for (size_t v = 0; v < mesh.positions.size(); ++v)
      places[mesh.source_vertices[v]] = mesh.positions[v];
  for (size_t m = 0; m < face.meshes().size(); ++m) {
    const FaceMesh& mesh = face.meshes()[m];
    if (mesh.mesh >= lines.size())
      throw Error("the rig's record of its OBJ does not fit its meshes: build it again");
    const std::vector<int>& line_of = lines[mesh.mesh];
    const std::vector<Vec3> posed = points_of(face.positions(m), Vec3::Zero()),
                            rest = points_of(face.rest(m), Vec3::Zero());
    for (size_t v = 0; v < std::min(posed.size(), line_of.size()); ++v) {
      const auto original = places.find(line_of[v]);
      if (posed[v] != rest[v] && original != places.end())
        moved[line_of[v]] = original->second + scene.offset + posed[v] - rest[v];
    }
  }
  return formats::with_vertices({reinterpret_cast<const char*>(source.bytes.data()), source.bytes.size()},
                                moved, decimals_for(scene));
}

}  // namespace

void write_posed_glb(const std::filesystem::path& rig, const Face& face,
                     const std::filesystem::path& output) {
  const std::vector<uint8_t> bytes = formats::read_bytes(rig);
  GltfEdit edit(rig::original(rig::glb_source(bytes, rig.string())));
  std::vector<gltf::PosedPrimitive> meshes;
  for (size_t m = 0; m < face.meshes().size(); ++m)
    meshes.push_back({face.meshes()[m].mesh, face.meshes()[m].primitive, face.positions(m)});
  gltf::set_pose(edit, meshes);
  const GltfEdit::Parts posed = edit.parts();
  formats::write_parts(output, {posed.before, posed.binary, posed.after});
}

void write_posed_mesh(const std::filesystem::path& rig, const Face& face,
                      const std::filesystem::path& output) {
  const rig::RigFile file = rig::read(formats::read_bytes(rig), rig.string());
  if (file.source.format == "obj" && extension_of(output) == ".obj") {
    formats::write_text(output, obj_like_source(file.source, face));
    return;
  }
  const Vec3 offset = rigging::input_offset(file.source);
  formats::Drawing drawing;
  for (size_t m = 0; m < face.meshes().size(); ++m)
    drawing.surfaces.push_back(
        {face.meshes()[m].name, {points_of(face.positions(m), offset), face.meshes()[m].triangles}});
  formats::write(output, drawing);
}

}  // namespace fascia::cli
