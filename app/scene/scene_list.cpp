#include "app/scene/scene_list.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <memory>

#include "view/face/fibre_tubes.h"
#include "view/face/lattice_layers.h"
#include "view/face/points.h"
#include "view/smooth_normals.h"

namespace fascia::app {

using view::points_of;

namespace {

const Vec3 skin_colour(0.86, 0.69, 0.59), bone_colour(0.90, 0.86, 0.75), tooth_colour(0.95, 0.94, 0.90),
    mucosa_colour(0.72, 0.38, 0.36), hair_colour(0.20, 0.15, 0.12), smas_colour(0.86, 0.62, 0.52),
    selected_colour(1.0, 0.85, 0.35);

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

/// What is neither eye, mouth, hair nor card.
bool is_skin(const std::string& part) {
  return !is_eye(part) && !is_card(part) && part != "brows" && part != "tongue" && part != "mouth_interior" &&
         !starts_with(part, "teeth") && !starts_with(part, "gums");
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
  static const std::array<Vec3, 6> stops = {Vec3(0.23, 0.20, 0.42), Vec3(0.42, 0.20, 0.56),
                                            Vec3(0.74, 0.22, 0.45), Vec3(0.93, 0.41, 0.24),
                                            Vec3(0.99, 0.68, 0.22), Vec3(0.98, 0.97, 0.65)};
  const double at = std::clamp(std::isfinite(share) ? share : 0.0, 0.0, 1.0) * (stops.size() - 1);
  const auto low = std::min(static_cast<size_t>(at), stops.size() - 2);
  return stops[low] + (at - static_cast<double>(low)) * (stops[low + 1] - stops[low]);
}

Vec3 muscle_colour(double activation) {
  const Vec3 slack(0.56, 0.20, 0.18), tight(1.0, 0.42, 0.25);
  return slack + std::clamp(activation, 0.0, 1.0) * (tight - slack);
}

SceneStore::SceneStore(const FaceAsset& asset, const rig::Rig& rig, const view::Appearance* appearance)
    : asset_(asset) {
  if (appearance && std::any_of(asset.parts.begin(), asset.parts.end(), [&](const FacePart& part) {
        return appearance->of(part.mesh, part.primitive).has_material;
      })) {
    std::vector<view::FacePart> parts;
    for (const FacePart& part : asset.parts)
      parts.push_back({part.mesh, part.primitive, part.part, part.triangles, points_of(part.rest), {}});
    painted_.emplace(rig, std::move(parts), *appearance);
  }
  std::vector<Vec3> rest;
  for (size_t p = 0; p < asset.parts.size(); ++p) {
    const FacePart& part = asset.parts[p];
    const rig::Eye& eye = part.part == "eye_left" ? rig.skull.eye_left : rig.skull.eye_right;
    eye_coordinates_.push_back(is_eye(part.part) && eye.radius > 0.0F ? eye_coordinates(part, eye)
                                                                      : std::vector<Vec3>());
    if (!is_skin(part.part)) continue;
    skin_parts_.push_back(p);
    const int first = static_cast<int>(rest.size());
    for (const Triangle& t : part.triangles)
      skin_triangles_.push_back({t[0] + first, t[1] + first, t[2] + first});
    const std::vector<Vec3> points = points_of(part.rest);
    rest.insert(rest.end(), points.begin(), points.end());
  }
  skin_seams_ = std::make_shared<const std::vector<int>>(view::seams_of(rest));
  moving_.emplace(rig, std::move(rest));
}

/// Colours of data take the place of the head's own, and skin of glass has none.
bool SceneStore::is_painted(const SceneOptions& options) const {
  const Layers& layers = options.layers;
  return painted_ && layers.has_textures && layers.skin && !layers.strain && !options.distances &&
         layers.skin_opacity >= 0.999;
}

void SceneStore::add_painted(view::DrawList& list, const FaceFrame& frame) const {
  view::FaceState state;
  for (const std::vector<float>& positions : frame.positions)
    state.positions.emplace_back(positions);
  list = painted_->list(state, view::FaceView());
}

void SceneStore::add_skin(view::DrawList& list, const FaceFrame& frame, const SceneOptions& options) const {
  view::DrawSurface surface;
  set_look(surface, "skin");
  surface.triangles = skin_triangles_;
  surface.seams = skin_seams_;
  const bool has_heat = options.distances != nullptr, has_strain = !has_heat && options.layers.strain;
  const double strongest = 0.3;  // compression, share of the length
  for (const size_t part : skin_parts_) {
    const std::vector<Vec3> points = points_of(frame.positions[part]);
    surface.positions.insert(surface.positions.end(), points.begin(), points.end());
    if (!has_heat && !has_strain) continue;
    surface.shading = view::Shading::data;
    for (size_t v = 0; v < points.size(); ++v) {
      double share = 0.0;
      if (has_heat && v < (*options.distances)[part].size())
        share = static_cast<double>((*options.distances)[part][v]) / options.scale;
      if (has_strain && part < frame.compression.size() && 3 * v + 2 < frame.compression[part].size())
        share = static_cast<double>(
                    Eigen::Map<const Eigen::Vector3f>(frame.compression[part].data() + 3 * v).norm()) /
                strongest;
      surface.vertex_colours.push_back(heat_colour(share));
    }
  }
  if (!has_heat && !has_strain && options.layers.skin_opacity < 0.999) {
    surface.shading = view::Shading::xray;
    surface.opacity = std::sqrt(options.layers.skin_opacity);
    surface.is_two_sided = false;
  }
  list.surfaces.push_back(std::move(surface));
}

void SceneStore::add_part(view::DrawList& list, size_t part, const FaceFrame& frame) const {
  const FacePart& source = asset_.parts[part];
  view::DrawSurface surface;
  set_look(surface, source.part);
  surface.positions = points_of(frame.positions[part]);
  surface.normals = points_of(frame.normals[part]);
  surface.triangles = source.triangles;
  surface.eye_coordinates = eye_coordinates_[part];
  list.surfaces.push_back(std::move(surface));
}

std::map<std::string, SceneStore::ContractingMuscle> SceneStore::muscles_of(
    const FaceFrame& frame, const SceneOptions& options) const {
  std::map<std::string, ContractingMuscle> muscles;
  for (size_t f = 0; f + 1 < asset_.fibre_offsets.size(); ++f) {
    const std::string& name = asset_.fibre_muscles[f];
    if (options.hidden_muscles.count(name)) continue;
    const uint32_t channel = asset_.fibre_channels[f];
    ContractingMuscle& muscle = muscles[name];
    muscle.activation = channel < frame.values.size()
                            ? std::clamp(static_cast<double>(frame.values[channel]), 0.0, 1.0)
                            : 0.0;
    muscle.fibres.emplace_back();
    for (size_t k = asset_.fibre_offsets[f]; k < asset_.fibre_offsets[f + 1]; ++k)
      muscle.fibres.back().push_back(
          Eigen::Map<const Eigen::Vector3f>(frame.fibre_points.data() + 3 * k).cast<double>());
  }
  return muscles;
}

void SceneStore::add_fibre_lines(view::DrawList& list, const FaceFrame& frame,
                                 const SceneOptions& options) const {
  for (auto& [name, muscle] : muscles_of(frame, options)) {
    const bool is_selected = name == options.selected_muscle;
    view::DrawLines lines;
    lines.lines = std::move(muscle.fibres);
    lines.colour = is_selected ? selected_colour : muscle_colour(muscle.activation);
    lines.width = is_selected ? 5.0 : 3.0 + 2.0 * muscle.activation;
    list.lines.push_back(std::move(lines));
  }
}

void SceneStore::add_flesh(view::DrawList& list, const FaceFrame& frame, const SceneOptions& options) const {
  view::DrawSurface slack;
  slack.shading = view::Shading::muscle;
  for (const auto& [name, muscle] : muscles_of(frame, options)) {
    const bool is_selected = name == options.selected_muscle;
    view::FibreTubeOptions look;
    if (!is_selected && muscle.activation < 0.01) {
      view::add_fibre_tubes(muscle.fibres, look, slack);
      continue;
    }
    view::DrawSurface bright;
    bright.shading = view::Shading::muscle;
    if (is_selected) look.tendon = selected_colour;
    look.flesh += (is_selected ? 1.0 : muscle.activation) *
                  ((is_selected ? selected_colour : muscle_colour(1.0)) - look.flesh);
    view::add_fibre_tubes(muscle.fibres, look, bright);
    bright.glow = muscle.activation * Vec3(0.62, 0.20, 0.06);
    list.surfaces.push_back(std::move(bright));
  }
  if (!slack.triangles.empty()) list.surfaces.push_back(std::move(slack));
}

void SceneStore::add_lattice(view::DrawList& list, const FaceFrame& frame, const Layers& layers) const {
  if (!layers.fat && !layers.lattice) return;
  const view::Lattice lattice{asset_.lattice_columns, points_of(frame.nodes), asset_.lattice_prisms};
  if (layers.fat)
    if (view::DrawSurface fat = view::fat_surface(lattice); !fat.triangles.empty())
      list.surfaces.push_back(std::move(fat));
  if (layers.lattice) view::add_lattice(lattice, list);
}

void SceneStore::add_bones(view::DrawList& list, const FaceFrame& frame, const SkullShift* shift) const {
  const Mat4 still = Mat4::Identity(), jaw = frame.jaw.cast<double>();
  const auto add = [&](FaceSurface bone, std::vector<Vec3> SkullShift::*by, const Mat4& place,
                       view::Shading shading, const Vec3& colour) {
    if (shift && (shift->*by).size() == bone.positions.size())
      for (size_t v = 0; v < bone.positions.size(); ++v)
        bone.positions[v] += (shift->*by)[v];
    add_surface(list, bone, place, shading, colour, 1.0);
  };
  add(asset_.cranium, &SkullShift::cranium, still, view::Shading::bone, bone_colour);
  add(asset_.mandible, &SkullShift::mandible, jaw, view::Shading::bone, bone_colour);
  add(asset_.teeth_upper, &SkullShift::teeth_upper, still, view::Shading::tooth, tooth_colour);
  add(asset_.teeth_lower, &SkullShift::teeth_lower, jaw, view::Shading::tooth, tooth_colour);
}

/// The SMAS and its ligaments, as far as the face has carried them.
void SceneStore::add_sheets(view::DrawList& list, const FaceFrame& frame, const Layers& layers) const {
  if (layers.smas) {
    FaceSurface smas = asset_.smas;
    std::vector<Vec3> moved =
        moving_->smas({asset_.lattice_columns, points_of(frame.nodes), asset_.lattice_prisms});
    if (moved.size() == smas.positions.size()) smas.positions = std::move(moved);
    add_surface(list, smas, Mat4::Identity(), view::Shading::mucosa, smas_colour,
                layers.muscles || layers.skull ? 0.5 : 1.0);
  }
  if (layers.ligaments)
    view::add_ligaments(moving_->ligaments(points_of(frame.positions, skin_parts_), frame.jaw.cast<double>()),
                        list);
}

view::DrawList SceneStore::list(const FaceFrame& frame, const SceneOptions& options) const {
  view::DrawList list;
  const Layers& layers = options.layers;
  const bool is_own = is_painted(options);
  if (is_own) add_painted(list, frame);
  for (size_t part = 0; part < asset_.parts.size() && !is_own; ++part) {
    const std::string& kind = asset_.parts[part].part;
    if (is_skin(kind) || is_card(kind)) continue;
    // What lines the mouth would hide the teeth and the bone behind glass.
    const bool is_lining = starts_with(kind, "gums") || kind == "mouth_interior";
    if (is_lining && layers.has_depth() && layers.skin_opacity < 0.999) continue;
    if (layers.skin || is_eye(kind)) add_part(list, part, frame);
  }
  if (layers.skin && !is_own && !skin_parts_.empty()) add_skin(list, frame, options);
  if (layers.skull) add_bones(list, frame, options.skull_shift);
  add_sheets(list, frame, layers);
  if (layers.muscles && options.has_round_fibres) add_flesh(list, frame, options);
  if (layers.muscles && !options.has_round_fibres) add_fibre_lines(list, frame, options);
  add_lattice(list, frame, layers);
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
