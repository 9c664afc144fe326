#include "cli/picture.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <sstream>

#include "builder/spatial/surface_query.h"
#include "geometry/error.h"

namespace fascia::cli {

namespace {

const Vec3 skin_colour(0.86, 0.69, 0.59), bone_colour(0.90, 0.86, 0.75), tooth_colour(0.95, 0.94, 0.90);

TriangleMesh mesh_of(const rig::Surface& surface) {
  TriangleMesh mesh;
  for (const auto& p : surface.positions)
    mesh.vertices.push_back(p.cast<double>());
  for (const auto& t : surface.triangles)
    mesh.triangles.push_back({static_cast<int>(t[0]), static_cast<int>(t[1]), static_cast<int>(t[2])});
  return mesh;
}

void add_surface(view::DrawList& list, const TriangleMesh& mesh, const Vec3& colour, double opacity,
                 const Mat4& place) {
  if (mesh.empty()) return;
  view::DrawSurface surface;
  for (const Vec3& p : mesh.vertices)
    surface.positions.push_back(transform_point(place, p));
  surface.triangles = mesh.triangles;
  surface.colour = colour;
  surface.opacity = opacity;
  list.surfaces.push_back(std::move(surface));
}

/// White, iris and pupil by the angle to the gaze at rest.
std::vector<Vec3> eye_colours(std::span<const float> rest, const rig::Eye& eye) {
  std::vector<Vec3> colours;
  for (size_t i = 0; i + 2 < rest.size(); i += 3) {
    const rig::Vec3f p(rest[i], rest[i + 1], rest[i + 2]);
    const rig::Vec3f direction = (p - eye.centre).normalized();
    const double angle =
        std::acos(std::clamp(static_cast<double>(direction.dot(eye.gaze)), -1.0, 1.0)) * 180.0 / EIGEN_PI;
    colours.push_back(angle < 10.5   ? Vec3(0.03, 0.03, 0.03)
                      : angle < 27.0 ? Vec3(0.32, 0.42, 0.50)
                                     : Vec3(0.93, 0.92, 0.90));
  }
  return colours;
}

/// Skin, and mucosa where at rest the skin itself closes in on all sides: mouth, nostrils, behind the lids.
std::vector<Vec3> skin_colours(std::span<const float> rest, const std::vector<Triangle>& triangles) {
  TriangleMesh mesh;
  for (size_t i = 0; i + 2 < rest.size(); i += 3)
    mesh.vertices.emplace_back(rest[i], rest[i + 1], rest[i + 2]);
  mesh.triangles = triangles;
  const std::vector<Vec3> normals = vertex_normals(mesh);
  const spatial::SurfaceQuery surface(mesh);
  const double reach = 0.06, start = 0.0003;  // metres: across a mouth, off the surface itself
  std::vector<Vec3> colours(mesh.vertices.size(), skin_colour);
  for (size_t v = 0; v < colours.size(); ++v) {
    const Vec3& n = normals[v];
    if (n.squaredNorm() < 0.5) continue;
    const Vec3 across = n.unitOrthogonal(), along = n.cross(across);
    int open = 0;
    for (const Vec3& d : {n, Vec3(n + across), Vec3(n - across), Vec3(n + along), Vec3(n - along)})
      open += !surface.first_hit(mesh.vertices[v] + start * n, d.normalized(), reach);
    if (open == 0) colours[v] = Vec3(0.50, 0.22, 0.20);
  }
  return colours;
}

Vec3 part_colour(const std::string& part) {
  if (part.rfind("teeth", 0) == 0) return tooth_colour;
  if (part.rfind("gums", 0) == 0 || part == "tongue" || part == "mouth_interior")
    return Vec3(0.72, 0.38, 0.36);
  if (part == "lashes" || part == "brows" || part == "hair") return Vec3(0.20, 0.15, 0.12);
  return skin_colour;
}

/// Cards that only their textures' transparency makes thin; plain, they would hide the face.
bool is_transparent_part(const std::string& part) {
  return part == "eye_surround" || part == "lashes" || part == "hair";
}

bool is_drawn(const std::string& part, const std::set<std::string>& layers) {
  if (part.rfind("eye_l", 0) == 0 || part.rfind("eye_r", 0) == 0)
    return layers.count("eyes") || layers.count("skin");
  if (part.rfind("teeth", 0) == 0) return layers.count("skin") || layers.count("teeth");
  return layers.count("skin") > 0;
}

}  // namespace

std::set<std::string> layers_from(const std::string& list) {
  static const std::set<std::string> known = {"skin", "eyes",    "teeth",    "skull",
                                              "smas", "muscles", "landmarks"};
  std::set<std::string> layers;
  std::istringstream words(list);
  for (std::string word; std::getline(words, word, ',');) {
    if (!known.count(word))
      throw Error("layer '" + word + "' is unknown: use skin, eyes, teeth, skull, smas, muscles, landmarks");
    layers.insert(word);
  }
  if (layers.empty()) throw Error("no layer to draw: use skin, eyes, teeth, skull, smas, muscles, landmarks");
  return layers;
}

Vec3 muscle_colour(const std::string& name) {
  std::string whole = name.substr(0, name.find("_left"));
  whole = whole.substr(0, whole.find("_right"));
  uint32_t hash = 2166136261U;
  for (char c : whole)
    hash = (hash ^ static_cast<uint8_t>(c)) * 16777619U;
  const double hue = (hash % 3600) / 600.0, light = 0.75 + 0.2 * ((hash >> 16) % 100) / 100.0;
  const auto channel = [&](double offset) {
    const double at = std::fmod(hue + offset, 6.0);
    return light * (1.0 - 0.75 * std::clamp(std::min(at, 4.0 - at), 0.0, 1.0));
  };
  return Vec3(channel(5.0), channel(3.0), channel(1.0));
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

view::DrawList draw_face(const Face& face, const rig::Rig& rig, const std::set<std::string>& layers,
                         const std::vector<std::string>& muscles) {
  view::DrawList list;
  const bool has_depth =
      layers.count("skull") || layers.count("smas") || layers.count("muscles") || layers.count("teeth");
  const Mat4 still = Mat4::Identity(), jaw = face.jaw();
  for (size_t m = 0; m < face.meshes().size(); ++m) {
    const FaceMesh& mesh = face.meshes()[m];
    if (!is_drawn(mesh.part, layers) || is_transparent_part(mesh.part)) continue;
    view::DrawSurface surface;
    const auto flat = face.positions(m);
    for (size_t i = 0; i + 2 < flat.size(); i += 3)
      surface.positions.emplace_back(flat[i], flat[i + 1], flat[i + 2]);
    surface.triangles = mesh.triangles;
    surface.colour = part_colour(mesh.part);
    surface.shine = 0.12;
    if (mesh.part == "eye_left" || mesh.part == "eye_right") {
      const rig::Eye& eye = mesh.part == "eye_left" ? rig.skull.eye_left : rig.skull.eye_right;
      if (eye.radius > 0) {
        surface.vertex_colours = eye_colours(face.rest(m), eye);
        surface.shine = 0.6;
      }
    } else if (has_depth && mesh.part == "skin") {
      surface.opacity = 0.28;
      surface.is_two_sided = false;
    } else if (mesh.part == "skin") {
      surface.vertex_colours =
          face.skin_colours(m, [&] { return skin_colours(face.rest(m), mesh.triangles); });
    }
    list.surfaces.push_back(std::move(surface));
  }
  if (layers.count("skull")) {
    add_surface(list, mesh_of(rig.skull.cranium), bone_colour, 1.0, still);
    add_surface(list, mesh_of(rig.skull.mandible), Vec3(0.84, 0.82, 0.78), 1.0, jaw);
    add_surface(list, mesh_of(rig.skull.teeth_upper), tooth_colour, 1.0, still);
    add_surface(list, mesh_of(rig.skull.teeth_lower), tooth_colour, 1.0, jaw);
  }
  if (layers.count("smas"))
    add_surface(list, mesh_of(rig.smas.surface), Vec3(0.78, 0.45, 0.42),
                layers.count("muscles") || layers.count("skull") ? 0.55 : 1.0, still);
  if (layers.count("muscles"))
    for (auto& [name, lines] : all_fibres(face, rig))
      if (muscles.empty() || std::find(muscles.begin(), muscles.end(), name) != muscles.end())
        list.lines.push_back({std::move(lines), muscle_colour(name), 2.5});
  if (layers.count("landmarks"))
    for (const auto& landmark : rig.skull.landmarks) {
      const Vec3 skin = landmark.skin.cast<double>(), bone = landmark.bone.cast<double>();
      list.lines.push_back({{{skin, bone}}, Vec3(0.1, 0.8, 0.9), 3.0});
    }
  return list;
}

}  // namespace fascia::cli
