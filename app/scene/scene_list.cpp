#include "app/scene/scene_list.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>

namespace fascia::app {

namespace {

const Vec3 skin_colour(0.86, 0.69, 0.59), bone_colour(0.90, 0.86, 0.75), tooth_colour(0.95, 0.94, 0.90),
    mucosa_colour(0.72, 0.38, 0.36), hair_colour(0.20, 0.15, 0.12), smas_colour(0.86, 0.62, 0.52);

std::vector<Vec3> points_of(const std::vector<float>& flat) {
  std::vector<Vec3> points;
  points.reserve(flat.size() / 3);
  for (size_t i = 0; i + 2 < flat.size(); i += 3)
    points.emplace_back(flat[i], flat[i + 1], flat[i + 2]);
  return points;
}

bool starts_with(const std::string& text, const char* start) {
  return text.rfind(start, 0) == 0;
}

bool is_eye(const std::string& part) {
  return part == "eye_left" || part == "eye_right";
}

/// Cards that only their textures' transparency makes thin; plain, they would hide the face.
bool is_card(const std::string& part) {
  return part == "eye_surround" || part == "lashes" || part == "hair";
}

void set_look(view::DrawSurface& surface, const std::string& part) {
  if (is_eye(part)) {
    surface.shading = view::Shading::eye;
  } else if (starts_with(part, "teeth")) {
    surface.shading = view::Shading::tooth;
    surface.colour = tooth_colour;
  } else if (starts_with(part, "gums") || part == "tongue" || part == "mouth_interior") {
    surface.shading = view::Shading::mucosa;
    surface.colour = mucosa_colour;
  } else if (part == "brows") {
    surface.shading = view::Shading::hair;
    surface.colour = hair_colour;
  } else {
    surface.shading = view::Shading::skin;
    surface.colour = skin_colour;
  }
}

void add_surface(view::DrawList& list, const FaceSurface& from, const Mat4& place, view::Shading shading,
                 const Vec3& colour, double opacity) {
  if (from.triangles.empty()) return;
  view::DrawSurface surface;
  surface.positions.reserve(from.positions.size());
  for (const Vec3& p : from.positions)
    surface.positions.push_back(transform_point(place, p));
  surface.triangles = from.triangles;
  surface.shading = shading;
  surface.colour = colour;
  surface.opacity = opacity;
  list.surfaces.push_back(std::move(surface));
}

/// The frame's directions for the iris: the third axis is the gaze.
std::vector<Vec3> eye_coordinates(const FacePart& part, const rig::Eye& eye) {
  const Vec3 gaze = eye.gaze.cast<double>(), centre = eye.centre.cast<double>();
  const Vec3 across = Vec3::UnitY().cross(gaze).normalized(), up = gaze.cross(across);
  std::vector<Vec3> coordinates;
  for (const Vec3& p : points_of(part.rest)) {
    const Vec3 d = (p - centre).normalized();
    coordinates.emplace_back(d.dot(across), d.dot(up), d.dot(gaze));
  }
  return coordinates;
}

}  // namespace

Vec3 heat_colour(double share) {
  static const std::array<Vec3, 6> stops = {Vec3(0.23, 0.20, 0.42), Vec3(0.42, 0.20, 0.56), Vec3(0.74, 0.22, 0.45),
                                            Vec3(0.93, 0.41, 0.24), Vec3(0.99, 0.68, 0.22), Vec3(0.98, 0.97, 0.65)};
  const double at = std::clamp(std::isfinite(share) ? share : 0.0, 0.0, 1.0) * (stops.size() - 1);
  const auto low = std::min(static_cast<size_t>(at), stops.size() - 2);
  return stops[low] + (at - static_cast<double>(low)) * (stops[low + 1] - stops[low]);
}

Vec3 muscle_colour(double activation) {
  const Vec3 slack(0.56, 0.20, 0.18), tight(1.0, 0.42, 0.25);
  return slack + std::clamp(activation, 0.0, 1.0) * (tight - slack);
}

SceneStore::SceneStore(const FaceAsset& asset, const rig::Rig& rig) : asset_(asset) {
  for (const FacePart& part : asset.parts) {
    const rig::Eye& eye = part.part == "eye_left" ? rig.skull.eye_left : rig.skull.eye_right;
    eye_coordinates_.push_back(is_eye(part.part) && eye.radius > 0.0F ? eye_coordinates(part, eye)
                                                                     : std::vector<Vec3>());
  }
}

void SceneStore::add_part(view::DrawList& list, size_t part, const FaceFrame& frame,
                          const SceneOptions& options) const {
  const FacePart& source = asset_.parts[part];
  if (is_card(source.part)) return;
  view::DrawSurface surface;
  set_look(surface, source.part);
  surface.positions = points_of(frame.positions[part]);
  surface.normals = points_of(frame.normals[part]);
  surface.triangles = source.triangles;
  surface.eye_coordinates = eye_coordinates_[part];
  const bool is_skin = surface.shading == view::Shading::skin;
  if (is_skin && options.distances && (*options.distances)[part].size() == surface.positions.size()) {
    surface.shading = view::Shading::data;
    for (const float distance : (*options.distances)[part])
      surface.vertex_colours.push_back(heat_colour(static_cast<double>(distance) / options.scale));
  } else if (is_skin && options.layers.strain && part < frame.compression.size()) {
    const double most = 0.3;  // share of the length
    surface.shading = view::Shading::data;
    for (const Vec3& compression : points_of(frame.compression[part]))
      surface.vertex_colours.push_back(heat_colour(compression.norm() / most));
  } else if (is_skin && options.layers.skin_opacity < 0.999) {
    surface.opacity = options.layers.skin_opacity;
    surface.is_two_sided = false;
  }
  list.surfaces.push_back(std::move(surface));
}

void SceneStore::add_muscles(view::DrawList& list, const FaceFrame& frame, const SceneOptions& options) const {
  std::map<std::string, std::pair<view::DrawLines, double>> muscles;
  for (size_t f = 0; f + 1 < asset_.fibre_offsets.size(); ++f) {
    const std::string& name = asset_.fibre_muscles[f];
    if (options.hidden_muscles.count(name)) continue;
    const uint32_t channel = asset_.fibre_channels[f];
    auto& [lines, activation] = muscles[name];
    activation = channel < frame.values.size() ? static_cast<double>(frame.values[channel]) : 0.0;
    lines.lines.emplace_back();
    for (size_t k = asset_.fibre_offsets[f]; k < asset_.fibre_offsets[f + 1]; ++k)
      lines.lines.back().push_back(
          Eigen::Map<const Eigen::Vector3f>(frame.fibre_points.data() + 3 * k).cast<double>());
  }
  for (auto& [name, muscle] : muscles) {
    const bool is_selected = name == options.selected_muscle;
    muscle.first.colour = is_selected ? Vec3(1.0, 0.85, 0.35) : muscle_colour(muscle.second);
    muscle.first.width = is_selected ? 5.0 : 3.0 + 2.0 * std::clamp(muscle.second, 0.0, 1.0);
    list.lines.push_back(std::move(muscle.first));
  }
}

view::DrawList SceneStore::list(const FaceFrame& frame, const SceneOptions& options) const {
  view::DrawList list;
  const Mat4 still = Mat4::Identity(), jaw = frame.jaw.cast<double>();
  const Layers& layers = options.layers;
  for (size_t part = 0; part < asset_.parts.size(); ++part) {
    const std::string& kind = asset_.parts[part].part;
    if (layers.skin || is_eye(kind)) add_part(list, part, frame, options);
  }
  if (layers.skull) {
    add_surface(list, asset_.cranium, still, view::Shading::bone, bone_colour, 1.0);
    add_surface(list, asset_.mandible, jaw, view::Shading::bone, bone_colour, 1.0);
    add_surface(list, asset_.teeth_upper, still, view::Shading::tooth, tooth_colour, 1.0);
    add_surface(list, asset_.teeth_lower, jaw, view::Shading::tooth, tooth_colour, 1.0);
  }
  if (layers.smas)
    add_surface(list, asset_.smas, still, view::Shading::mucosa, smas_colour,
                layers.muscles || layers.skull ? 0.5 : 1.0);
  if (layers.muscles) add_muscles(list, frame, options);
  return list;
}

std::vector<std::vector<float>> distances_between(const FaceFrame& frame,
                                                  const std::vector<std::vector<float>>& reference) {
  std::vector<std::vector<float>> distances(frame.positions.size());
  for (size_t part = 0; part < std::min(frame.positions.size(), reference.size()); ++part) {
    const std::vector<float>&a = frame.positions[part], &b = reference[part];
    if (a.size() != b.size()) continue;
    for (size_t i = 0; i + 2 < a.size(); i += 3)
      distances[part].push_back(std::hypot(a[i] - b[i], a[i + 1] - b[i + 1], a[i + 2] - b[i + 2]));
  }
  return distances;
}

}  // namespace fascia::app
