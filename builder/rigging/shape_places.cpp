#include "builder/rigging/shape_places.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>

#include "formats/morph_shapes.h"
#include "geometry/error.h"

namespace fascia::rigging {

namespace {

enum Place { eye_left, eye_right, corner_left, corner_right, place_count };

/// How a shape's name ends, in lower case and letters alone.
struct Ending {
  std::string_view name;
  Place place;
};
constexpr Ending endings[] = {
    {"blinkleft", eye_left},      {"blinkl", eye_left},         {"eyecloseleft", eye_left},
    {"eyeclosel", eye_left},      {"eyesclosedl", eye_left},    {"blinkright", eye_right},
    {"blinkr", eye_right},        {"eyecloseright", eye_right}, {"eyecloser", eye_right},
    {"eyesclosedr", eye_right},   {"smileleft", corner_left},   {"smilel", corner_left},
    {"smileright", corner_right}, {"smiler", corner_right},
};

std::optional<Place> place_of(const std::string& name) {
  std::string plain;
  for (const char c : name)
    if (std::isalpha(static_cast<unsigned char>(c)))
      plain += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  for (const Ending& ending : endings)
    if (plain.ends_with(ending.name)) return ending.place;
  return std::nullopt;
}

/// A mean of places, and the mesh that weighs most in it.
struct Mean {
  Vec3 sum = Vec3::Zero();
  double weight = 0.0, most = 0.0;
  std::string mesh;

  void add(const formats::SceneMesh& part, const std::vector<Vec3>& displacements, int power) {
    double here = 0.0;
    for (size_t v = 0; v < displacements.size(); ++v) {
      const double w = std::pow((part.to_file.topLeftCorner<3, 3>() * displacements[v]).norm(), power);
      if (!std::isfinite(w)) return;
      sum += w * part.positions[v];
      here += w;
    }
    weight += here;
    if (here > most) {
      most = here;
      mesh = part.name;
    }
  }
};

/// The generic head's own places.
std::optional<std::array<Vec3, place_count>> generic_places(const anatomy::GenericAnatomy& anatomy) {
  const auto skin = [&](const char* name) -> std::optional<Vec3> {
    const anatomy::Landmark* landmark = anatomy.landmark(name);
    return landmark ? landmark->skin : std::nullopt;
  };
  std::array<Vec3, place_count> places;
  for (const bool is_left : {true, false}) {
    const auto outer = skin(is_left ? "exocanthion_left" : "exocanthion_right"),
               inner = skin(is_left ? "endocanthion_left" : "endocanthion_right"),
               corner = skin(is_left ? "cheilion_left" : "cheilion_right");
    if (!outer || !inner || !corner) return std::nullopt;
    places[is_left ? eye_left : eye_right] = 0.5 * (*outer + *inner);
    places[is_left ? corner_left : corner_right] = *corner;
  }
  return places;
}

/// Eyes and corners apart, and the mouth about as far from the eyes as they are from each other.
bool can_be_a_face(const std::array<Vec3, place_count>& places) {
  const double eyes = (places[eye_left] - places[eye_right]).norm(),
               corners = (places[corner_left] - places[corner_right]).norm(),
               down =
                   0.5 *
                   (places[eye_left] + places[eye_right] - places[corner_left] - places[corner_right]).norm();
  return eyes > 0.0 && corners > 0.15 * eyes && corners < 5.0 * eyes && down > 0.2 * eyes &&
         down < 5.0 * eyes;
}

/// The middle of the surface near the places, as far as a head reaches.
Vec3 middle_of_head(const formats::Scene& scene, const std::array<Vec3, place_count>& places) {
  const Vec3 face = 0.25 * (places[0] + places[1] + places[2] + places[3]);
  const double reach = 3.0 * (places[eye_left] - places[eye_right]).norm();
  Vec3 sum = Vec3::Zero();
  double total = 0.0;
  for (const formats::SceneMesh& mesh : scene.meshes)
    for (const Triangle& t : mesh.triangles) {
      const Vec3 &a = mesh.positions[static_cast<size_t>(t[0])],
                 &b = mesh.positions[static_cast<size_t>(t[1])],
                 &c = mesh.positions[static_cast<size_t>(t[2])], middle = (a + b + c) / 3.0;
      const double area = (b - a).cross(c - a).norm();
      if (!((middle - face).norm() < reach) || !std::isfinite(area)) continue;
      sum += area * middle;
      total += area;
    }
  return total > 0.0 ? Vec3(sum / total) : face;
}

/// Whether left is called right, as in a head that was mirrored, or whose sides are the viewer's: the face
/// would then look into the head.
bool are_sides_swapped(const formats::Scene& scene, const std::array<Vec3, place_count>& places) {
  const Vec3 left = places[eye_left] - places[eye_right],
             up = places[eye_left] + places[eye_right] - places[corner_left] - places[corner_right];
  const Vec3 face = 0.25 * (places[0] + places[1] + places[2] + places[3]);
  return left.cross(up).dot(face - middle_of_head(scene, places)) < 0.0;
}

}  // namespace

bool ShapePlaces::agree(const landmarks::Placement& placement) const {
  const double eyes = (anchors[eye_left].target - anchors[eye_right].target).norm();
  return std::all_of(anchors.begin(), anchors.end(), [&](const landmarks::Anchor& anchor) {
    return (placement(anchor.generic) - anchor.target).norm() < eyes / 3.0;
  });
}

std::optional<ShapePlaces> places_by_shapes(const formats::Scene& scene,
                                            const anatomy::GenericAnatomy& anatomy) {
  const auto generic = generic_places(anatomy);
  if (!generic) return std::nullopt;
  std::array<Mean, place_count> means;
  try {
    for (const formats::Shape& shape :
         formats::morph_shapes(scene, [](const std::string& name) { return place_of(name).has_value(); }))
      for (const formats::ShapePart& part : shape.parts)
        for (const formats::SceneMesh& mesh : scene.meshes) {
          if (mesh.mesh != part.mesh || mesh.primitive != part.primitive ||
              mesh.positions.size() != part.displacements.size())
            continue;
          const Place place = *place_of(shape.name);
          // The lids close as one; a smile takes the cheek along, and its corner goes farthest.
          means[place].add(mesh, part.displacements, place == eye_left || place == eye_right ? 2 : 6);
        }
  } catch (const Error&) {
    return std::nullopt;  // the builder does without; what writes the head again says what is wrong with it
  }
  std::array<Vec3, place_count> places;
  ShapePlaces result;
  for (size_t k = 0; k < place_count; ++k) {
    if (!(means[k].weight > 0.0)) return std::nullopt;
    places[k] = means[k].sum / means[k].weight;
  }
  if (!can_be_a_face(places)) return std::nullopt;
  if (are_sides_swapped(scene, places)) {
    std::swap(places[eye_left], places[eye_right]);
    std::swap(places[corner_left], places[corner_right]);
  }
  for (size_t k = 0; k < place_count; ++k)
    result.anchors.push_back({(*generic)[k], places[k], 1.0});
  result.mesh = means[eye_left].mesh;
  return result;
}

}  // namespace fascia::rigging
