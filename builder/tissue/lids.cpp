#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <optional>

#include "builder/tissue/actuators.h"
#include "builder/tissue/lids.h"

namespace fascia::tissue {
namespace {

// Correction of the discretisation: a coarse lattice closes less for the same angle, so that this is added to
// the closing per metre of column spacing beyond that of the medium level.
constexpr double closing_per_spacing = 60.0, medium_spacing = 0.002;
// Radians that the upper lid of a head with closed eyes is lifted: a fissure of some 9 mm before a globe of
// 12 (Farkas 1994).
constexpr double open_height = 0.75;
// Number of spheres of growing radius that stand for the cornea, for columns in front of deeper and deeper
// skin.
constexpr uint32_t cornea_spheres = 5;

void carry(rig::TissueLevel& level, int channel, size_t node, const Fissure& f, const Vec3& axis,
           double angle, double stiffness, double reverse) {
  level.carrier_channel.push_back(static_cast<uint32_t>(channel));
  level.carrier_node.push_back(static_cast<uint32_t>(node));
  level.carrier_origin.push_back(f.centre.cast<float>());
  level.carrier_axis.push_back(axis.cast<float>());
  level.carrier_angle.push_back(static_cast<float>(angle));
  level.carrier_reverse.push_back(static_cast<float>(reverse));
  level.carrier_stiffness.push_back(0.0F);
  level.carrier_drive.push_back(static_cast<float>(stiffness));
}

/// Distance of the cornea's apex from the centre of the eye of a side, at least the eye's radius: a ball
/// without a bulge is its own cornea. Nothing if the head has no eyeball.
std::optional<double> apex_of(const TissueInputs& inputs, bool left, const Fissure& f) {
  std::optional<double> apex;
  for (const PartMesh& part : inputs.parts)
    if (part.part == (left ? "eye_left" : "eye_right"))
      for (const Vec3& p : part.vertices) {
        const double distance = (p - f.centre).norm();
        if (distance < inputs.mechanics.lids.cornea_apex_limit * f.radius)
          apex = std::max(apex.value_or(f.radius), distance);
      }
  return apex;
}

/// Clearance over a ball of `radius` for the skin between columns near an opening: several times the sagitta
/// of a chord as long as their spacing, because triangles span more than that, plus `clearance` for the
/// compliance of contact and smoothing.
double chord_clearance(const Columns& c, const std::vector<double>& opening, double radius,
                       double clearance) {
  double area = 0.0;
  int count = 0;
  for (size_t v = 0; v < opening.size(); ++v) {
    if (!(opening[v] < 0.008)) continue;
    area += c.area[v];
    ++count;
  }
  return clearance + 5.0 * area / std::max(1, count) / (8.0 * radius);
}

/// How much deeper than a column, toward the eye's centre, the skin around it lies, metres: lids rotate about
/// that centre, so that skin in the crease comes closer to the cornea than the column by this distance.
std::vector<double> sunken_skin(const FaceRegion& region, const Columns& c, const std::vector<double>& near,
                                const std::vector<double>& opening, const Fissure& f, double reach) {
  std::vector<double> sunken(near.size(), 0.0);
  for (size_t v = 0; v < region.mesh.vertices.size(); ++v) {
    if (!region.outer[v] || !(opening[v] < reach)) continue;
    const Vec3& p = region.mesh.vertices[v];
    for (size_t k = 0; k < near.size(); ++k) {
      if (!(near[k] < reach) || !c.outer[k]) continue;
      const Vec3& column = c.mesh.vertices[k];
      if ((p - column).squaredNorm() > c.area[k]) continue;
      sunken[k] = std::max(sunken[k], (column - f.centre).norm() - (p - f.centre).norm());
    }
  }
  return sunken;
}

/// An eye's lids: nodes near the fissure, and what each channel does to them.
void add_eye(const TissueInputs& inputs, const FaceRegion& region, const Columns& c, bool left,
             rig::TissueLevel& level) {
  const anatomy::mechanics::Lids& m = inputs.mechanics.lids;
  const Fissure f(inputs, region, left);
  const std::string side = left ? "_left" : "_right";
  const auto& opening =
      c.opening_distance[static_cast<size_t>(left ? Opening::eye_left : Opening::eye_right)];
  const auto n = static_cast<size_t>(c.count());
  const int close = channel_index(inputs.channels, "lid_upper" + side);
  const int raise = channel_index(inputs.channels, "lid_lower" + side);
  const int draw_upper = channel_index(inputs.channels, "orbicularis_oculi_pretarsal_upper" + side);
  const int draw_lower = channel_index(inputs.channels, "orbicularis_oculi_pretarsal_lower" + side);
  const int yaw = channel_index(inputs.channels, "eye_yaw" + side);
  const int pitch = channel_index(inputs.channels, "eye_pitch" + side);
  const bool is_closed = f.is_closed();
  level.globe_centre.push_back(f.centre.cast<float>());
  level.globe_radius.push_back(static_cast<float>(f.radius));
  const double bulge = m.cornea_radius_share * f.radius;
  const std::optional<double> apex = apex_of(inputs, left, f);
  const double clearance = chord_clearance(c, opening, bulge, m.cornea_clearance);
  const double growth = m.cornea_crease_depth / (cornea_spheres - 1);
  const auto first = static_cast<uint32_t>(level.globe_centre.size());
  for (uint32_t step = 0; apex && step < cornea_spheres; ++step) {
    level.globe_centre.push_back((f.centre + (*apex - bulge) * f.front).cast<float>());
    level.globe_radius.push_back(static_cast<float>(bulge + clearance + step * growth));
  }
  const auto& skin_opening =
      region.opening_distance[static_cast<size_t>(left ? Opening::eye_left : Opening::eye_right)];
  const std::vector<double> sunken = sunken_skin(region, c, opening, skin_opening, f, m.cornea_crease_reach);
  for (size_t v = 0; v < n; ++v) {
    if (!(opening[v] < m.reach) || c.rim[v]) continue;
    const Vec3& p = c.mesh.vertices[v];
    const double place = f.place(p), distance = opening[v];
    const bool is_upper = f.is_upper(region, c.source[v], p);
    // The plate moves rigidly, fully at the edge and in the lining, not beyond the canthi. Above it the skin
    // folds at the crease, where the levator's aponeurosis holds it.
    const double across = m.canthal_fade.rise(place) * m.canthal_fade.rise(1.0 - place);
    const double fade =
        (c.outer[v] ? (is_upper ? m.upper_plate : m.lower_plate).fall(distance) : 1.0) * across;
    const double unfolding = closing_share(inputs, c, f, v);
    const double held = std::max(fade, c.outer[v] && is_upper ? across * m.crease.fall(distance) : 0.0);
    const auto step = std::min<uint32_t>(cornea_spheres - 1, static_cast<uint32_t>(sunken[v] / growth + 0.5));
    for (const size_t node : {v, n + v}) {
      level.globe_contact_node.push_back(static_cast<uint32_t>(node));
      level.globe_contact_globe.push_back(first - 1);
      if (!apex) continue;
      level.globe_contact_node.push_back(static_cast<uint32_t>(node));
      level.globe_contact_globe.push_back(first + step);
    }
    if (held < 0.01) continue;
    const double gap = f.gap(place);
    for (const size_t node : {v, n + v}) {
      const double stiffness = m.hold * c.area[v] * held;
      // A positive turn about the leftward axis lowers what lies in front.
      const size_t before = level.carrier_node.size();
      const auto turn = [&](int channel, const Vec3& axis, double angle, double reverse) {
        if (channel >= 0) carry(level, channel, node, f, axis, angle, stiffness, reverse);
      };
      const double coarse = std::max(0.0, std::sqrt(c.area[v]) - medium_spacing);
      const double to_inner = (left ? -1.0 : 1.0) * (2.0 * place - 1.0);  // 1 at the inner canthus, -1 outer
      const double lid = is_closed
                             ? 0.0
                             : (m.closing + closing_per_spacing * coarse) * gap +
                                   m.canthal_turn * std::max(to_inner, -m.canthal_outer_share * to_inner);
      const double lift =
          is_closed ? open_height * std::sin(EIGEN_PI * std::clamp(place, 0.0, 1.0)) : m.opening * lid;
      if (is_upper)
        turn(close, f.lateral, lid * unfolding, -lift * fade);
      else
        turn(raise, f.lateral, -m.raising * gap * fade, m.raising * gap * fade);
      const double up = is_upper ? m.upper_follows_up : m.lower_follows_up;
      const double down = is_upper ? m.upper_follows_down : m.lower_follows_down;
      turn(pitch, f.lateral, -up * fade, down * fade);
      // Horner's part of the pretarsal muscle draws the plates, the lower one most, towards the nose.
      const double drawn = (left ? -1.0 : 1.0) * (is_upper ? m.upper_drawn : m.lower_drawn) * fade;
      turn(is_upper ? draw_upper : draw_lower, f.up, drawn, -drawn);
      // The cornea's bulge takes both lids a little way sideways.
      turn(yaw, f.up, m.follows_yaw * fade, -m.follows_yaw * fade);
      // The hold stiffness is applied once per node, however many carriers move it.
      if (level.carrier_node.size() > before) level.carrier_stiffness[before] = static_cast<float>(stiffness);
    }
  }
}

}  // namespace

double closing_share(const TissueInputs& inputs, const Columns& c, const Fissure& f, size_t v) {
  const anatomy::mechanics::Lids& m = inputs.mechanics.lids;
  const double place = f.place(c.mesh.vertices[v]);
  const double distance = std::min(c.opening_distance[static_cast<size_t>(Opening::eye_left)][v],
                                   c.opening_distance[static_cast<size_t>(Opening::eye_right)][v]);
  // Skin that follows the lid unfolds from the crease, so that it moves less than the edge.
  return (c.outer[v] ? m.unfolding.fall(distance) : 1.0) * m.canthal_fade.rise(place) *
         m.canthal_fade.rise(1.0 - place);
}

void add_lids(const TissueInputs& inputs, const FaceRegion& region, const Columns& columns,
              rig::TissueLevel& level) {
  for (const bool left : {true, false})
    add_eye(inputs, region, columns, left, level);
}

}  // namespace fascia::tissue
