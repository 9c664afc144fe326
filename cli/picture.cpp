#include "cli/picture.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <sstream>

#include "builder/spatial/surface_query.h"
#include "geometry/error.h"

namespace fascia::cli {

namespace {

const Vec3 skin(0.82, 0.62, 0.53), mucosa(0.48, 0.20, 0.19);  // sRGB

/// -1 where most of the surface faces what it surrounds, else 1.
double outer_side(const TriangleMesh& mesh) {
  const std::vector<Vec3> areas = vertex_area_vectors(mesh.vertices, mesh.triangles);
  const Vec3 centre = bounds(mesh.vertices).centre();
  double outward = 0.0;
  for (size_t v = 0; v < areas.size(); ++v)
    outward += areas[v].dot(mesh.vertices[v] - centre);
  return outward < 0.0 ? -1.0 : 1.0;
}

/// Skin, and mucosa where at rest the skin itself closes in on all sides: mouth, nostrils, behind the lids.
std::vector<Vec3> skin_colours(std::span<const float> rest, const std::vector<Triangle>& triangles) {
  TriangleMesh mesh;
  for (size_t i = 0; i + 2 < rest.size(); i += 3)
    mesh.vertices.emplace_back(rest[i], rest[i + 1], rest[i + 2]);
  mesh.triangles = triangles;
  const std::vector<Vec3> normals = vertex_normals(mesh);
  const double side = outer_side(mesh);
  const spatial::SurfaceQuery surface(mesh);
  const double reach = 0.06, start = 0.0003;  // metres: across a mouth, off the surface itself
  std::vector<Vec3> colours(mesh.vertices.size(), skin);
  for (size_t v = 0; v < colours.size(); ++v) {
    const Vec3 n = side * normals[v];
    if (n.squaredNorm() < 0.5) continue;
    const Vec3 across = n.unitOrthogonal(), along = n.cross(across);
    int open = 0;
    for (const Vec3& d : {n, Vec3(n + across), Vec3(n - across), Vec3(n + along), Vec3(n - along)})
      open += !surface.first_hit(mesh.vertices[v] + start * n, d.normalized(), reach);
    if (open == 0) colours[v] = mucosa;
  }
  return colours;
}

view::FaceScene make_scene(const Face& face, const rig::Rig& rig) {
  view::Appearance appearance = view::Appearance::read(face.file(), face.path());
  std::vector<view::FacePart> parts;
  for (size_t m = 0; m < face.meshes().size(); ++m) {
    const FaceMesh& mesh = face.meshes()[m];
    view::FacePart part{mesh.mesh, mesh.primitive, mesh.part, mesh.triangles, {}, {}};
    const std::span<const float> rest = face.rest(m);
    for (size_t i = 0; i + 2 < rest.size(); i += 3)
      part.rest.emplace_back(rest[i], rest[i + 1], rest[i + 2]);
    if (mesh.part == "skin" && !appearance.of(mesh.mesh, mesh.primitive).has_material)
      part.colours = skin_colours(rest, mesh.triangles);
    parts.push_back(std::move(part));
  }
  return view::FaceScene(rig, std::move(parts), std::move(appearance));
}

std::string known_layers() {
  std::string names;
  for (const std::string& name : view::FaceScene::layer_names())
    names += (names.empty() ? "" : ", ") + name;
  return names;
}

}  // namespace

std::set<std::string> layers_from(const std::string& list) {
  std::set<std::string> layers;
  std::istringstream words(list);
  for (std::string word; std::getline(words, word, ',');) {
    if (!view::FaceScene::layer_names().count(word))
      throw Error("layer '" + word + "' is unknown: use " + known_layers());
    layers.insert(word);
  }
  if (layers.empty()) throw Error("no layer to draw: use " + known_layers());
  return layers;
}

std::vector<std::pair<std::string, std::vector<std::vector<Vec3>>>> all_fibres(const Face& face,
                                                                               const rig::Rig& rig) {
  auto all = face.fibres();
  std::set<std::string> known;
  for (const auto& [name, lines] : all)
    known.insert(name);
  const Mat4 jaw = face.jaw();
  for (const rig::Muscle& muscle : rig.muscles) {
    if (known.count(muscle.name)) continue;
    const double begin = muscle.origin == rig::FibreEnd::mandible ? 1.0 : 0.0,
                 end = muscle.insertion == rig::FibreEnd::mandible ? 1.0 : 0.0;
    std::vector<std::vector<Vec3>> lines;
    for (size_t f = 0; f + 1 < muscle.fibre_offsets.size(); ++f) {
      lines.emplace_back();
      const size_t first = muscle.fibre_offsets[f], last = muscle.fibre_offsets[f + 1];
      for (size_t k = first; k < last; ++k) {
        const Vec3 rest = muscle.points[k].cast<double>();
        const double share = last - first > 1 ? double(k - first) / double(last - first - 1) : 0.0;
        lines.back().push_back(rest + (begin + share * (end - begin)) * (transform_point(jaw, rest) - rest));
      }
    }
    all.emplace_back(muscle.name, std::move(lines));
  }
  return all;
}

Bounds face_box(const rig::Rig& rig) {
  std::vector<Vec3> points;
  for (const auto& landmark : rig.skull.landmarks)
    points.push_back(landmark.skin.cast<double>());
  for (const auto& p : rig.skull.cranium.positions)
    points.push_back(p.cast<double>());
  for (const auto& p : rig.skull.mandible.positions)
    points.push_back(p.cast<double>());
  Bounds box = bounds(points);
  const Vec3 margin(0.01, 0.012, 0.01);
  box.lower -= margin;
  box.upper += margin;
  return box;
}

view::DrawList draw_face(const Face& face, const rig::Rig& rig, const view::FaceView& what) {
  const auto& scene = face.kept<view::FaceScene>([&] { return make_scene(face, rig); });
  view::FaceState state;
  for (size_t m = 0; m < face.meshes().size(); ++m)
    state.positions.push_back(face.positions(m));
  state.jaw = face.jaw();
  if (what.layers.count("muscles")) {
    state.fibres = all_fibres(face, rig);
    state.activations = face.effective_values();
  }
  if (what.layers.count("fat") || what.layers.count("lattice") || what.layers.count("smas"))
    state.lattice = face.lattice();
  return scene.list(state, what);
}

view::DrawList draw_face(const Face& face, const rig::Rig& rig, const std::set<std::string>& layers,
                         const std::vector<std::string>& muscles) {
  view::FaceView what;
  what.layers = layers;
  what.muscles = muscles;
  return draw_face(face, rig, what);
}

}  // namespace fascia::cli
