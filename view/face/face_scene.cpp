#include "view/face/face_scene.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "geometry/error.h"
#include "view/face/fibre_tubes.h"
#include "view/face/points.h"
#include "view/smooth_normals.h"

namespace fascia::view {

namespace {

const Vec3 skin_colour(0.82, 0.62, 0.53), mucosa_colour(0.66, 0.33, 0.32), tooth_colour(0.91, 0.88, 0.80),
    bone_colour(0.86, 0.80, 0.68), mandible_colour(0.84, 0.78, 0.67), hair_colour(0.16, 0.11, 0.08),
    sclera_colour(0.90, 0.87, 0.84), fascia_colour(0.85, 0.68, 0.60), ligament_colour(0.93, 0.90, 0.82);

bool begins(const std::string& text, const char* with) {
  return text.rfind(with, 0) == 0;
}

bool is_eyeball(const std::string& part) {
  return part == "eye_left" || part == "eye_right";
}

struct Substance {
  Shading shading;
  Vec3 colour;
};

Substance substance_of(const std::string& part) {
  if (part == "skin") return {Shading::skin, skin_colour};
  if (is_eyeball(part)) return {Shading::eye, sclera_colour};
  if (begins(part, "teeth")) return {Shading::tooth, tooth_colour};
  if (begins(part, "gums") || part == "tongue" || part == "mouth_interior")
    return {Shading::mucosa, mucosa_colour};
  if (part == "lashes" || part == "brows" || part == "hair") return {Shading::hair, hair_colour};
  return {Shading::plain, Vec3(0.72, 0.70, 0.68)};
}

/// Cards that only their textures' transparency makes thin: drawn plain they would hide the face.
bool is_card(const std::string& part) {
  return part == "eye_surround" || part == "lashes" || part == "hair";
}

/// Whether the part's triangles are as thin as hairs: the cards of a texture are broad.
bool has_strands(const FacePart& part) {
  constexpr double broad = 5e-4;  // metres
  std::vector<double> heights;
  for (const Triangle& t : part.triangles)
    heights.push_back(triangle_height(part.rest[static_cast<size_t>(t[0])],
                                      part.rest[static_cast<size_t>(t[1])],
                                      part.rest[static_cast<size_t>(t[2])]));
  if (heights.empty()) return false;
  const auto middle = heights.begin() + static_cast<std::ptrdiff_t>(heights.size() / 2);
  std::nth_element(heights.begin(), middle, heights.end());
  return *middle < broad;
}

bool is_drawn(const std::string& part, const std::set<std::string>& layers) {
  const bool has_skin = layers.count("skin") || layers.count("strain");
  if (is_eyeball(part)) return layers.count("eyes") || has_skin;
  if (begins(part, "teeth")) return has_skin || layers.count("teeth");
  return has_skin;
}

/// What of the head's own parts is drawn where its skin is glass: what lines the mouth would hide the teeth
/// and the bone that carries them.
bool shows_through_glass(const std::string& part) {
  return !is_card(part) && part != "brows" && part != "other" && part != "mouth_interior" &&
         !begins(part, "gums");
}

bool has_depth(const std::set<std::string>& layers) {
  return layers.count("skull") || layers.count("smas") || layers.count("muscles") || layers.count("teeth") ||
         layers.count("ligaments") || layers.count("fat") || layers.count("lattice");
}

/// Directions from the eyeball's centre, the gaze along +Z and the head's up as +Y as far as it may be.
std::vector<Vec3> coordinates_in(const rig::Eye& eye, const std::vector<Vec3>& rest) {
  if (!(eye.radius > 0.0F)) return {};
  const Vec3 gaze = eye.gaze.cast<double>().normalized(), across = Vec3::UnitY().cross(gaze).normalized();
  Mat3 frame;
  frame.row(0) = across;
  frame.row(1) = gaze.cross(across);
  frame.row(2) = gaze;
  std::vector<Vec3> all;
  for (const Vec3& p : rest)
    all.push_back(frame * (p - eye.centre.cast<double>()));
  return all;
}

void add_surface(DrawList& list, const rig::Surface& from, Shading shading, const Vec3& colour,
                 const Mat4& place) {
  if (from.triangles.empty()) return;
  DrawSurface surface;
  for (const auto& p : from.positions)
    surface.positions.push_back(transform_point(place, p.cast<double>()));
  for (const auto& t : from.triangles)
    surface.triangles.push_back({static_cast<int>(t[0]), static_cast<int>(t[1]), static_cast<int>(t[2])});
  surface.shading = shading;
  surface.colour = colour;
  list.surfaces.push_back(std::move(surface));
}

/// A sphere about `centre`, appended with a colour a vertex.
void add_ball(const Vec3& centre, double radius, const Vec3& colour, DrawSurface& surface) {
  const int rows = 6, columns = 10, first = static_cast<int>(surface.positions.size());
  for (int r = 0; r <= rows; ++r)
    for (int c = 0; c < columns; ++c) {
      const double down = EIGEN_PI * r / rows, around = 2.0 * EIGEN_PI * c / columns;
      const Vec3 out(std::sin(down) * std::sin(around), std::cos(down), std::sin(down) * std::cos(around));
      surface.positions.push_back(centre + radius * out);
      surface.normals.push_back(out);
      surface.vertex_colours.push_back(colour);
    }
  for (int r = 0; r < rows; ++r)
    for (int c = 0; c < columns; ++c) {
      const int here = first + r * columns + c, next = first + r * columns + (c + 1) % columns;
      surface.triangles.push_back({here, here + columns, next + columns});
      surface.triangles.push_back({here, next + columns, next});
    }
}

void apply(const PrimitiveLook& look, DrawSurface& surface) {
  const size_t count = surface.positions.size();
  if (look.uvs.size() == count) {
    surface.uvs = look.uvs;
    surface.colour_map = look.colour_map;
    surface.normal_map = look.normal_map;
    surface.surface_map = look.surface_map;
  }
  surface.normal_strength = look.normal_strength;
  if (look.has_material || surface.colour_map) surface.colour = look.colour;
  if (look.colours.size() == count) surface.vertex_colours = look.colours;
  surface.glow = look.glow;
  if (surface.colour_map) {
    surface.alpha_cutoff = look.alpha_cutoff;
    surface.is_blended = look.is_blended && surface.shading != Shading::skin;
  }
  if (look.is_blended) surface.opacity = look.opacity;
  if (surface.shading == Shading::plain) {
    surface.roughness = look.roughness;
    surface.metalness = look.metalness;
  } else if (surface.surface_map) {
    surface.roughness = look.roughness;
  }
}

}  // namespace

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

void add_ligaments(const std::vector<MovingAnatomy::Band>& ligaments, DrawList& list) {
  DrawSurface bands;
  bands.shading = Shading::bone;
  FibreTubeOptions options;
  options.flesh = ligament_colour;
  options.has_tendons = false;
  options.thinnest = options.thickest = 0.0005;
  std::vector<std::vector<Vec3>> lines;
  for (const MovingAnatomy::Band& ends : ligaments)
    lines.push_back({ends[0], ends[1]});
  add_fibre_tubes(lines, options, bands);
  if (!bands.triangles.empty()) list.surfaces.push_back(std::move(bands));
}

const std::set<std::string>& FaceScene::layer_names() {
  static const std::set<std::string> names = {"skin",    "eyes",      "teeth",   "skull",     "fat",   "smas",
                                              "muscles", "ligaments", "lattice", "landmarks", "strain"};
  return names;
}

FaceScene::FaceScene(const rig::Rig& rig, std::vector<FacePart> parts, Appearance appearance)
    : rig_(&rig), parts_(std::move(parts)), appearance_(std::move(appearance)) {
  for (const FacePart& part : parts_) {
    has_strands_.push_back(is_card(part.part) && has_strands(part));
    seams_.push_back(std::make_shared<const std::vector<int>>(seams_of(part.rest)));
    eye_coordinates_.push_back(
        is_eyeball(part.part)
            ? coordinates_in(part.part == "eye_left" ? rig.skull.eye_left : rig.skull.eye_right, part.rest)
            : std::vector<Vec3>());
  }
  std::vector<std::vector<Vec3>> rest;
  std::vector<std::vector<Triangle>> triangles;
  for (size_t m = 0; m < parts_.size(); ++m) {
    if (parts_[m].part != "skin") continue;
    skin_parts_.push_back(m);
    rest.push_back(parts_[m].rest);
    triangles.push_back(parts_[m].triangles);
  }
  skin_normals_.emplace(rest, triangles);
  std::vector<Vec3> skin;
  for (const std::vector<Vec3>& part : rest)
    skin.insert(skin.end(), part.begin(), part.end());
  moving_.emplace(rig, std::move(skin));
}

DrawList FaceScene::list(const FaceState& state, const FaceView& view) const {
  if (state.positions.size() != parts_.size())
    throw Error("a face to draw has " + std::to_string(state.positions.size()) + " parts of " +
                std::to_string(parts_.size()));
  DrawList list;
  add_parts(state, view, list);
  add_bones(state, view, list);
  add_muscles(state, view, list);
  if (view.layers.count("fat"))
    if (DrawSurface fat = fat_surface(state.lattice); !fat.triangles.empty())
      list.surfaces.push_back(std::move(fat));
  if (view.layers.count("lattice")) add_lattice(state.lattice, list);
  if (view.layers.count("ligaments"))
    add_ligaments(moving_->ligaments(points_of(state.positions, skin_parts_), state.jaw), list);
  if (view.layers.count("landmarks")) add_landmarks(state, list);
  return list;
}

std::vector<std::vector<Vec3>> FaceScene::skin_normals(
    const std::vector<std::vector<Vec3>>& positions) const {
  std::vector<std::vector<Vec3>> skin, normals(parts_.size());
  for (const size_t m : skin_parts_)
    skin.push_back(positions[m]);
  std::vector<std::vector<Vec3>> found = skin_normals_->of(skin);
  for (size_t k = 0; k < skin_parts_.size(); ++k)
    normals[skin_parts_[k]] = std::move(found[k]);
  return normals;
}

void FaceScene::add_parts(const FaceState& state, const FaceView& view, DrawList& list) const {
  std::vector<std::vector<Vec3>> positions;
  for (size_t m = 0; m < parts_.size(); ++m) {
    positions.push_back(points_of(state.positions[m]));
    if (positions[m].size() != parts_[m].rest.size()) throw Error("a face to draw does not fit its rig");
  }
  std::vector<std::vector<Vec3>> normals = skin_normals(positions);
  const bool is_glass = has_depth(view.layers) && !view.reveal,
             shows_strain = view.layers.count("strain") > 0;
  for (size_t m = 0; m < parts_.size(); ++m) {
    const FacePart& part = parts_[m];
    if (!is_drawn(part.part, view.layers) || part.triangles.empty()) continue;
    const PrimitiveLook& look = appearance_.of(part.mesh, part.primitive);
    // An eyeball of one colour all over would have no iris, a card of one colour would hide what lies behind
    // it.
    const bool needs_map = is_eyeball(part.part) || is_card(part.part);
    const bool has_look = needs_map ? look.colour_map != nullptr : look.has_material;
    const bool is_painted = view.has_textures && (has_look || look.colours.size() == part.rest.size());
    if (is_card(part.part) && !is_painted && !has_strands_[m]) continue;
    if (is_glass && !shows_through_glass(part.part)) continue;
    DrawSurface surface;
    surface.positions = positions[m];
    surface.normals = std::move(normals[m]);
    surface.triangles = part.triangles;
    surface.seams = seams_[m];
    surface.is_fine = has_strands_[m];
    const Substance substance = substance_of(part.part);
    surface.shading = substance.shading;
    surface.colour = substance.colour;
    if (part.colours.size() == part.rest.size() && !is_painted) surface.vertex_colours = part.colours;
    if (is_painted) apply(look, surface);
    if (!surface.colour_map && surface.vertex_colours.empty()) surface.eye_coordinates = eye_coordinates_[m];
    const bool is_skin = part.part == "skin";
    if (is_skin && shows_strain) {
      const std::vector<double> strain = areal_strain(part.rest, surface.positions, part.triangles);
      surface.shading = Shading::data;
      surface.colour_map = nullptr;
      surface.vertex_colours.clear();
      for (double value : strain)
        surface.vertex_colours.push_back(heat_colour(view.scale, 100.0 * value));
    } else if (is_skin && is_glass) {
      surface.shading = Shading::xray;
      surface.colour_map = nullptr;
      surface.vertex_colours.clear();
      surface.colour = Vec3(0.80, 0.66, 0.60);
      surface.opacity = 0.62;
      surface.is_two_sided = false;
    }
    if (view.reveal && !is_eyeball(part.part) && !begins(part.part, "teeth")) surface.cut = view.reveal;
    list.surfaces.push_back(std::move(surface));
  }
}

void FaceScene::add_bones(const FaceState& state, const FaceView& view, DrawList& list) const {
  const Mat4 still = Mat4::Identity();
  const rig::Skull& skull = rig_->skull;
  if (view.layers.count("skull")) {
    add_surface(list, skull.cranium, Shading::bone, bone_colour, still);
    add_surface(list, skull.mandible, Shading::bone, mandible_colour, state.jaw);
    const auto has_teeth = [&](const char* name) {
      return is_drawn(name, view.layers) &&
             std::any_of(parts_.begin(), parts_.end(), [&](const FacePart& p) { return p.part == name; });
    };
    if (!has_teeth("teeth_upper")) add_surface(list, skull.teeth_upper, Shading::tooth, tooth_colour, still);
    if (!has_teeth("teeth_lower"))
      add_surface(list, skull.teeth_lower, Shading::tooth, tooth_colour, state.jaw);
  }
  if (view.layers.count("smas")) {
    rig::Surface fascia;
    for (const Vec3& p : moving_->smas(state.lattice))
      fascia.positions.push_back(p.cast<float>());
    fascia.triangles = rig_->smas.surface.triangles;
    add_surface(list, fascia, Shading::muscle, fascia_colour, still);
    if (!list.surfaces.empty() && (view.layers.count("muscles") || view.layers.count("skull")))
      list.surfaces.back().opacity = 0.55;
  }
}

void FaceScene::add_muscles(const FaceState& state, const FaceView& view, DrawList& list) const {
  if (!view.layers.count("muscles")) return;
  DrawSurface flesh;
  flesh.shading = Shading::muscle;
  // Fibres that cross the border would stick out of the skin's half.
  if (view.reveal && view.layers.count("skin")) flesh.cut = -*view.reveal;
  for (const auto& [name, lines] : state.fibres) {
    if (!view.muscles.empty() &&
        std::find(view.muscles.begin(), view.muscles.end(), name) == view.muscles.end())
      continue;
    FibreTubeOptions options;
    if (view.tells_muscles_apart) options.flesh = options.tendon = muscle_colour(name);
    const auto found = state.activations.find(name);
    const double pull = found == state.activations.end() ? 0.0 : std::clamp(found->second, 0.0, 1.0);
    if (pull > 0.01) {
      DrawSurface working;
      working.shading = Shading::muscle;
      working.cut = flesh.cut;
      options.flesh += pull * (Vec3(0.98, 0.34, 0.16) - options.flesh);
      add_fibre_tubes(lines, options, working);
      working.glow = pull * Vec3(0.62, 0.20, 0.06);
      list.surfaces.push_back(std::move(working));
    } else {
      add_fibre_tubes(lines, options, flesh);
    }
  }
  if (!flesh.triangles.empty()) list.surfaces.push_back(std::move(flesh));
}

/// A ball at each point on the skin, green where it is certain and red where it is not, and a line to
/// its partner on the bone.
void FaceScene::add_landmarks(const FaceState& state, DrawList& list) const {
  const double radius = 0.0016;  // m
  DrawSurface balls;
  balls.shading = Shading::data;
  DrawLines depths{{}, Vec3(0.55, 0.75, 0.85), 2.0, false};
  const Vec3 sure(0.36, 0.74, 0.42), doubtful(0.90, 0.33, 0.26);
  const std::vector<MovingAnatomy::Band> places =
      moving_->landmarks(points_of(state.positions, skin_parts_), state.jaw);
  for (size_t i = 0; i < places.size(); ++i) {
    const rig::Landmark& landmark = rig_->skull.landmarks[i];
    const Vec3& centre = places[i][1];
    const double certainty = std::clamp(2.0 * static_cast<double>(landmark.confidence) - 1.0, 0.0, 1.0);
    add_ball(centre, radius, doubtful + certainty * (sure - doubtful), balls);
    depths.lines.push_back({centre, places[i][0]});
  }
  if (!balls.triangles.empty()) list.surfaces.push_back(std::move(balls));
  list.lines.push_back(std::move(depths));
}

}  // namespace fascia::view
