#include "builder/prepare/prepare.h"

#include "builder/prepare/computing_skin.h"
#include "builder/prepare/frame.h"
#include "builder/prepare/parts.h"
#include "builder/spatial/surface_query.h"
#include "geometry/error.h"
#include "geometry/nearest_names.h"

namespace fascia::prepare {

namespace {

/// Landmarks drawn by hand lie a little off the surface; far off, they belong to another mesh.
Landmarks onto_skin(const formats::Scene& scene, const spatial::SurfaceQuery& surface,
                    const Landmarks& landmarks, const std::set<std::string>& rough,
                    const Landmarks& reference, std::vector<std::string>& warnings) {
  Landmarks projected;
  std::vector<std::string> names;
  for (const auto& [name, p] : reference)
    names.push_back(name);
  for (const auto& [name, p] : landmarks) {
    const spatial::ClosestPoint hit = surface.nearest_place(p);
    projected[name] = hit.position;
    if (rough.count(name)) continue;
    const double off_mm = 1e3 * hit.distance;
    const std::string where = "landmark '" + name + "' lies " +
                              std::to_string(static_cast<int>(off_mm + 0.5)) + " mm from the skin of '" +
                              scene.path.string() + "'";
    if (off_mm > 20.0 && !reference.count(name))
      throw Error(where + ", and its name is not known here" + did_you_mean(name, names) +
                  ": take it out or name it anew");
    if (off_mm > 20.0)
      throw Error(where + ": place it on the skin, or check that landmarks and head are in the same axes");
    if (off_mm > 8.0) warnings.push_back(where + "; its nearest skin point is used");
  }
  return projected;
}

}  // namespace

PreparedHead prepare(const formats::Scene& scene, const formats::LandmarkFile& given,
                     const Landmarks& reference, const PrepareOptions& options) {
  Frame frame = find_frame(scene, given, reference, options);
  PreparedHead head;
  head.input_to_metres = frame.input_to_metres;
  head.units = frame.units;
  head.warnings = std::move(frame.warnings);
  Landmarks landmarks;
  for (const auto& [name, p] : frame.landmarks)
    landmarks[name] = transform_point(head.input_to_metres, p);

  const WeldedScene welded = weld_scene(scene, head.input_to_metres);
  const Parts parts = recognise_parts(scene, welded, landmarks, options);
  warn_of_other_heads(scene, welded, parts, head.warnings);
  warn_of_specks(scene, welded, parts, head.warnings);
  head.eye_left = parts.eye_left;
  head.eye_right = parts.eye_right;

  std::vector<Part> vertex_part(welded.surface.vertices.size(), Part::other);
  std::vector<bool> is_skin(welded.surface.triangles.size(), false);
  for (size_t t = 0; t < welded.surface.triangles.size(); ++t) {
    const Part part = parts.component_parts[static_cast<size_t>(welded.component[t])];
    is_skin[t] = part == Part::skin;
    for (int v : welded.surface.triangles[t])
      vertex_part[static_cast<size_t>(v)] = part;
  }
  warn_of_collapsed(scene, welded, vertex_part, head.warnings);
  ComputingSkin skin = computing_skin(scene, welded, is_skin, head.warnings);
  head.skin = std::move(skin.mesh);
  for (size_t m = 0; m < scene.meshes.size(); ++m) {
    PreparedMesh mesh;
    mesh.name = scene.meshes[m].name;
    mesh.triangles = scene.meshes[m].triangles;
    for (size_t v = 0; v < scene.meshes[m].positions.size(); ++v) {
      const size_t at = static_cast<size_t>(welded.vertex_map[m][v]);
      mesh.positions.push_back(transform_point(head.input_to_metres, scene.meshes[m].positions[v]));
      mesh.parts.push_back(vertex_part[at]);
      mesh.skin_vertices.push_back(skin.vertex[at]);
    }
    head.meshes.push_back(std::move(mesh));
  }
  head.surface.emplace(head.skin);
  head.landmarks =
      onto_skin(scene, *head.surface, landmarks, options.rough_landmarks, reference, head.warnings);
  return head;
}

void move(PreparedHead& head, const Mat3& rotation, const Vec3& translation) {
  Mat4 map = Mat4::Identity();
  map.topLeftCorner<3, 3>() = rotation;
  map.topRightCorner<3, 1>() = translation;
  for (PreparedMesh& mesh : head.meshes)
    for (Vec3& p : mesh.positions)
      p = rotation * p + translation;
  for (Vec3& p : head.skin.vertices)
    p = rotation * p + translation;
  if (head.surface) head.surface.emplace(head.skin);
  for (auto& [name, p] : head.landmarks)
    p = rotation * p + translation;
  for (std::optional<Eyeball>* eye : {&head.eye_left, &head.eye_right})
    if (*eye) {
      (*eye)->centre = rotation * (*eye)->centre + translation;
      (*eye)->gaze = rotation * (*eye)->gaze;
    }
  head.input_to_metres = map * head.input_to_metres;
}

}  // namespace fascia::prepare
