#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "builder/tissue/actuators.h"
#include "builder/tissue/margin.h"

namespace fascia::tissue {
namespace {

double smoothstep(double low, double high, double x) {
  const double t = std::clamp((x - low) / (high - low), 0.0, 1.0);
  return t * t * (3.0 - 2.0 * t);
}

/// An eye's own axes: `lateral` from canthus to canthus (to the subject's left), `front` out of the fissure.
struct EyeFrame {
  Vec3 centre, lateral, front, up;
  double radius, inner, outer;  // inner, outer: where along `lateral` the canthi lie
  double elevation(const Vec3& p) const {
    const Vec3 arm = p - centre;
    return std::atan2(arm.dot(up), arm.dot(front));
  }
};

EyeFrame frame_of(const TissueInputs& inputs, bool left) {
  const rig::Eye eye = eye_of(inputs, left);
  const std::string side = left ? "_left" : "_right";
  const Vec3 a = landmark(inputs, "endocanthion" + side), b = landmark(inputs, "exocanthion" + side);
  EyeFrame f;
  f.centre = eye.centre.cast<double>();
  f.radius = static_cast<double>(eye.radius);
  f.lateral = (left ? b - a : a - b).normalized();
  f.front = 0.5 * (a + b) - f.centre;
  f.front = (f.front - f.front.dot(f.lateral) * f.lateral).normalized();
  f.up = f.front.cross(f.lateral);
  const double s = (a - f.centre).dot(f.lateral), t = (b - f.centre).dot(f.lateral);
  f.inner = std::min(s, t);
  f.outer = std::max(s, t);
  return f;
}

void carry(rig::TissueLevel& level, int channel, size_t node, const EyeFrame& f, const Vec3& axis, double angle, double stiffness,
           double reverse_share = 1.0) {
  level.carrier_channel.push_back(static_cast<uint32_t>(channel));
  level.carrier_node.push_back(static_cast<uint32_t>(node));
  level.carrier_origin.push_back(f.centre.cast<float>());
  level.carrier_axis.push_back(axis.cast<float>());
  level.carrier_angle.push_back(static_cast<float>(angle));
  level.carrier_reverse.push_back(static_cast<float>(-reverse_share * angle));
  level.carrier_stiffness.push_back(0.0F);
  level.carrier_drive.push_back(static_cast<float>(stiffness));
}

/// Half an eye's lids: nodes near the fissure, and what each channel does to them.
void add_eye(const TissueInputs& inputs, const TissueOptions& options, const FaceRegion& region, const Columns& c, bool left, rig::TissueLevel& level) {
  const EyeFrame f = frame_of(inputs, left);
  const std::string side = left ? "_left" : "_right";
  const auto opening = static_cast<size_t>(left ? Opening::eye_left : Opening::eye_right);
  const auto n = static_cast<size_t>(c.count());
  const auto place_of = [&](const Vec3& p) { return ((p - f.centre).dot(f.lateral) - f.inner) / (f.outer - f.inner); };

  // The canthi's own elevation divides upper lid from lower.
  const Vec3 canthi[] = {landmark(inputs, "endocanthion" + side), landmark(inputs, "exocanthion" + side)};
  const auto middle = [&](double place) {
    const double a = f.elevation(canthi[0]), b = f.elevation(canthi[1]);
    const double t = left ? place : 1.0 - place;
    return a + std::clamp(t, 0.0, 1.0) * (b - a);
  };
  Margin upper, lower;
  for (const MarginPlace& p : margin_places(region, left ? Opening::eye_left : Opening::eye_right)) {
    const double place = place_of(p.position), elevation = f.elevation(p.position);
    (elevation > middle(place) ? upper : lower).add(place, {elevation, 0.0});
  }
  std::vector<size_t> near;
  for (size_t v = 0; v < n; ++v)
    if (c.opening_distance[opening][v] < 0.016 && !c.rim[v]) near.push_back(v);
  const int close = channel_index(inputs.channels, "lid_upper" + side);
  const int raise = channel_index(inputs.channels, "lid_lower" + side);
  const int draw_upper = channel_index(inputs.channels, "orbicularis_oculi_pretarsal_upper" + side);
  const int draw_lower = channel_index(inputs.channels, "orbicularis_oculi_pretarsal_lower" + side);
  const int yaw = channel_index(inputs.channels, "eye_yaw" + side);
  const int pitch = channel_index(inputs.channels, "eye_pitch" + side);
  level.globe_centre.push_back(f.centre.cast<float>());
  level.globe_radius.push_back(static_cast<float>(f.radius));
  for (const size_t v : near) {
    const Vec3& p = c.mesh.vertices[v];
    const double place = place_of(p), elevation = f.elevation(p), distance = c.opening_distance[opening][v];
    const bool is_upper = elevation > middle(place);
    // The plate goes as one, full at the edge and in the lining; none beyond the canthi. Above it the skin folds in at
    // the crease, where the levator's aponeurosis holds it.
    const double across = smoothstep(-0.18, 0.02, place) * (1.0 - smoothstep(0.98, 1.18, place));
    const double reach = !c.outer[v] ? 1.0 - 0.5 * smoothstep(0.001, 0.006, distance)
                         : is_upper  ? 1.0 - smoothstep(0.002, 0.009, distance)
                                     : 1.0 - smoothstep(0.004, 0.013, distance);
    const double fade = reach * across;
    const double held = std::max(fade, c.outer[v] && is_upper ? across * (1.0 - smoothstep(0.010, 0.015, distance)) : 0.0);
    const auto globe = static_cast<uint32_t>(level.globe_centre.size() - 1);
    for (const size_t node : {v, n + v}) {
      level.globe_contact_node.push_back(static_cast<uint32_t>(node));
      level.globe_contact_globe.push_back(globe);
    }
    if (held < 0.01) continue;
    const double gap = std::max(0.0, upper.at(place).x() - lower.at(place).x());
    for (const size_t node : {v, n + v}) {
      const double stiffness = options.material.lid_hold * c.area[v] * held;
      // A positive turn about the leftward axis lowers what lies in front.
      const double drive = options.material.lid_drive * stiffness;
      const size_t before = level.carrier_node.size();
      if (is_upper && close >= 0) carry(level, close, node, f, f.lateral, gap * fade, drive, 0.26);  // the levator lifts it some 3 mm above rest
      if (!is_upper && raise >= 0) carry(level, raise, node, f, f.lateral, -0.22 * gap * fade, drive);
      if (pitch >= 0) carry(level, pitch, node, f, f.lateral, (is_upper ? -0.75 : -0.4) * fade, drive);
      // Horner's part of the pretarsal muscle draws the plates, the lower one most, towards the nose.
      const int draw = is_upper ? draw_upper : draw_lower;
      if (draw >= 0) carry(level, draw, node, f, f.up, (left ? -1.0 : 1.0) * (is_upper ? 0.10 : 0.30) * fade, stiffness);
      // The cornea's bulge takes both lids a little way sideways.
      if (yaw >= 0) carry(level, yaw, node, f, f.up, 0.18 * fade, stiffness);
      // One of a node's carriers holds it, however many move it.
      if (level.carrier_node.size() > before) level.carrier_stiffness[before] = static_cast<float>(stiffness);
    }
  }
}

}  // namespace

void add_lids(const TissueInputs& inputs, const TissueOptions& options, const FaceRegion& region, const Columns& columns, rig::TissueLevel& level) {
  for (const bool left : {true, false}) add_eye(inputs, options, region, columns, left, level);
}

}  // namespace fascia::tissue
