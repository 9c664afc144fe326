#include "sim/contact.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>

#include "sim/formulas/elements.h"

namespace fascia::sim {
namespace {

/// Puts neighbours next to one another: halves across the longest side, and halves again.
void order_in_space(std::span<uint32_t> list, const std::vector<Vec3>& places) {
  if (list.size() <= 8) return;
  Eigen::AlignedBox3d box;
  for (const uint32_t i : list)
    box.extend(places[i]);
  Eigen::Index axis = 0;
  box.sizes().maxCoeff(&axis);
  const auto middle = list.begin() + static_cast<std::ptrdiff_t>(list.size() / 2);
  std::nth_element(list.begin(), middle, list.end(), [&](uint32_t a, uint32_t b) {
    return places[a][axis] != places[b][axis] ? places[a][axis] < places[b][axis] : a < b;
  });
  order_in_space(list.first(list.size() / 2), places);
  order_in_space(list.subspan(list.size() / 2), places);
}

}  // namespace

DistanceField::DistanceField(const Lattice& lattice, size_t index)
    : size_(lattice.contact_field_size[index]),
      origin_(lattice.contact_field_origin[index].cast<double>()),
      spacing_(lattice.contact_field_spacing[index]),
      step_(lattice.contact_field_step[index]) {
  const auto count = [&](size_t f) {
    const auto& size = lattice.contact_field_size[f];
    return static_cast<size_t>(size[0]) * size[1] * size[2];
  };
  size_t first = 0;
  for (size_t f = 0; f < index; ++f)
    first += count(f);
  values_ = lattice.contact_field_values.subspan(first, count(index));
  steepness_ = largest_slope();
}

double DistanceField::largest_slope() const {
  // A B-spline's slope along an axis lies between the differences of neighbours along it.
  const size_t strides[3] = {1, size_[0], static_cast<size_t>(size_[0]) * size_[1]};
  double squared = 0.0;
  for (int axis = 0; axis < 3; ++axis) {
    const size_t stride = strides[axis], along = size_[static_cast<size_t>(axis)];
    int most = 0;
    for (size_t block = 0; block + stride * along <= values_.size(); block += stride * along)
      for (size_t i = block; i + stride < block + stride * along; ++i)
        most = std::max(most, std::abs(static_cast<int>(values_[i + stride]) - values_[i]));
    squared += static_cast<double>(most) * most;
  }
  return std::sqrt(squared) * step_ / spacing_;
}

double DistanceField::sample(const Vec3& point, Vec3& gradient) const {
  // Quadratic B-splines on the grid: the slope does not jump between cells, which solvers would stumble over.
  const Vec3 at = (point - origin_) / spacing_;
  gradient.setZero();
  size_t first[3];
  double weight[3][3], slope[3][3];
  for (int axis = 0; axis < 3; ++axis) {
    const double most = static_cast<double>(size_[static_cast<size_t>(axis)]) - 1.5;
    const bool is_inside =
        at[axis] > 0.5 && at[axis] < most;  // beyond, the field goes on as it ends: no jump at its border
    const double place = is_inside ? at[axis] : at[axis] >= most ? most : 0.5;
    const double middle = std::min(std::floor(place + 0.5), most - 0.5), t = place - middle;
    first[axis] = static_cast<size_t>(middle) - 1;
    weight[axis][0] = 0.5 * (0.5 - t) * (0.5 - t);
    weight[axis][1] = 0.75 - t * t;
    weight[axis][2] = 0.5 * (0.5 + t) * (0.5 + t);
    slope[axis][0] = is_inside ? t - 0.5 : 0.0;
    slope[axis][1] = is_inside ? -2.0 * t : 0.0;
    slope[axis][2] = is_inside ? t + 0.5 : 0.0;
  }
  const size_t row = size_[0], slice = row * size_[1];
  const uint8_t* corner = values_.data() + first[0] + row * first[1] + slice * first[2];
  double value = 0.0;
  for (size_t k = 0; k < 3; ++k)
    for (size_t j = 0; j < 3; ++j) {
      const uint8_t* v = corner + row * j + slice * k;
      const double along = weight[0][0] * v[0] + weight[0][1] * v[1] + weight[0][2] * v[2];
      const double change = slope[0][0] * v[0] + slope[0][1] * v[1] + slope[0][2] * v[2];
      value += weight[1][j] * weight[2][k] * along;
      gradient += Vec3(weight[1][j] * weight[2][k] * change, slope[1][j] * weight[2][k] * along,
                       weight[1][j] * slope[2][k] * along);
    }
  gradient *= step_ / spacing_;
  return step_ * (value - 128.0);
}

Contacts::Contacts(const Lattice& lattice, const std::vector<Vec3>& rest, const ContactOptions& options)
    : options_(options) {
  for (size_t c = 0; c < lattice.globe_contact_node.size(); ++c) {
    const uint32_t globe = lattice.globe_contact_globe[c], node = lattice.globe_contact_node[c];
    globe_nodes_.push_back(node);
    globe_centres_.push_back(lattice.globe_centre[globe].cast<double>());
    globe_radii_.push_back(
        std::min<double>(lattice.globe_radius[globe], (rest[node] - globe_centres_.back()).norm()));
  }
  for (size_t f = 0; f < lattice.contact_field_bone.size(); ++f)
    fields_.emplace_back(lattice, f);
  field_bones_.assign(lattice.contact_field_bone.begin(), lattice.contact_field_bone.end());
  for (size_t c = 0; c < lattice.contact_node.size(); ++c) {
    Vec3 gradient;
    const double distance = fields_[lattice.contact_field[c]].sample(rest[lattice.contact_node[c]], gradient);
    bone_nodes_.push_back(lattice.contact_node[c]);
    bone_fields_.push_back(lattice.contact_field[c]);
    bone_margins_.push_back(std::min(options.thickness, distance));
  }
  std::array<std::map<uint32_t, uint32_t>, 6> fans;  // node -> its place in the side's fans
  std::vector<uint32_t> facing(lattice.facing_prism.size());
  std::vector<Vec3> facing_places;
  for (uint32_t f = 0; f < facing.size(); ++f) {
    facing[f] = f;
    const auto& t = lattice.triangles[lattice.facing_prism[f]];
    facing_places.push_back((rest[t[0]] + rest[t[1]] + rest[t[2]]) / 3.0);
  }
  order_in_space(facing, facing_places);
  for (const uint32_t f : facing) {
    Side& side = sides_[lattice.facing_side[f]];
    auto& known = fans[lattice.facing_side[f]];
    const auto triangle = static_cast<uint32_t>(side.triangles.size());
    side.triangles.push_back(lattice.triangles[lattice.facing_prism[f]]);
    auto& corners = side.corners.emplace_back();
    for (size_t k = 0; k < 3; ++k) {
      const auto [fan, is_new] =
          known.try_emplace(side.triangles.back()[k], static_cast<uint32_t>(side.fans.size()));
      if (is_new) side.fans.emplace_back();
      side.fans[fan->second].push_back(triangle);
      corners[k] = fan->second;
    }
  }
  for (size_t s = 0; s < 6; ++s)
    for (const auto& [node, fan] : fans[s]) {
      if (fans[s ^ 1U].count(node) > 0) continue;  // in the corner, where both sides are one
      facing_nodes_.push_back(node);
      facing_sides_.push_back(static_cast<uint8_t>(s));
      facing_fans_.push_back(fan);
    }
  soft_nodes_ = globe_nodes_;
  for (const Side& side : sides_)
    for (const auto& t : side.triangles)
      soft_nodes_.insert(soft_nodes_.end(), t.begin(), t.end());
  std::sort(soft_nodes_.begin(), soft_nodes_.end());
  soft_nodes_.erase(std::unique(soft_nodes_.begin(), soft_nodes_.end()), soft_nodes_.end());
  for (const uint8_t side : facing_sides_)
    facing_margins_.push_back(side < 2 ? options.thickness : options.lid_thickness);
  FacingSearch search = make_search();
  for (size_t i = 0; i < facing_nodes_.size(); ++i) {
    FacingPair pair;
    pair_of(i, rest.data(), search, pair);
    if (pair.is_found()) facing_margins_[i] = std::min(facing_margins_[i], pair.gap(rest.data()));
    // If closed lips intersect at rest, front and back are undefined; the pair is dropped.
    if (facing_margins_[i] < -0.0005) facing_fans_[i] = FacingPair::none;
  }
}

Contacts::Touch Contacts::globe_touch(size_t c, const Vec3* x) const {
  const Vec3 away = x[globe_nodes_[c]] - globe_centres_[c];
  double distance = 0.0;
  const double depth = formulas::depth_in_ball(globe_radii_[c], three(away), distance);
  if (depth <= 0.0) return {};
  return {depth, away / distance};
}

Contacts::Touch Contacts::bone_touch(size_t c, const RigidTransform& mandible, const Vec3* x) const {
  const Vec3& place = x[bone_nodes_[c]];
  if (!bone_moves(c)) return bone_touch(c, place);
  Touch touch = bone_touch(c, Vec3(mandible.rotation.transpose() * (place - mandible.translation)));
  touch.normal = mandible.rotation * touch.normal;
  return touch;
}

double Contacts::energy(const RigidTransform& mandible, const Vec3* x, Vec3* gradient) const {
  double energy = 0.0;
  const auto push = [&](uint32_t node, const Touch& touch, double stiffness) {
    if (touch.depth <= 0.0) return;
    energy += 0.5 * stiffness * touch.depth * touch.depth;
    gradient[node] -= (stiffness * touch.depth) * touch.normal;
  };
  for (size_t c = 0; c < globe_nodes_.size(); ++c)
    push(globe_nodes_[c], globe_touch(c, x), options_.globe_stiffness);
  for (size_t c = 0; c < bone_nodes_.size(); ++c)
    push(bone_nodes_[c], bone_touch(c, mandible, x), options_.bone_stiffness);
  return energy;
}

void Contacts::add_curvature(const RigidTransform& mandible, std::span<const FacingPair> pairs,
                             std::span<const Grip> grips, const Vec3* x, Curvature& out) const {
  const auto press = [&](uint32_t node, const Touch& touch, double stiffness) {
    if (touch.depth > 0.0)
      out.points.push_back({{node}, {1.0}, stiffness * touch.normal * touch.normal.transpose()});
  };
  for (size_t c = 0; c < globe_nodes_.size(); ++c)
    press(globe_nodes_[c], globe_touch(c, x), options_.globe_stiffness);
  for (size_t c = 0; c < bone_nodes_.size(); ++c)
    press(bone_nodes_[c], bone_touch(c, mandible, x), options_.bone_stiffness);
  const auto quad = [&](uint32_t node, const std::array<uint32_t, 3>& corners, const Vec3& weights,
                        const Mat3& block) {
    if (corners[0] == FacingPair::none)
      out.points.push_back({{node}, {1.0}, block});
    else
      out.quads.push_back(
          {{node, corners[0], corners[1], corners[2]}, {1.0, -weights[0], -weights[1], -weights[2]}, block});
  };
  for (const FacingPair& pair : pairs)
    if (pair.is_found() && pair.gap(x) < pair.margin)
      quad(pair.node, pair.corners, pair.weights,
           options_.facing_stiffness * pair.normal * pair.normal.transpose());
  for (const Grip& grip : grips) {
    const Mat3 along = grip.normal * grip.normal.transpose();
    quad(grip.node, grip.corners, grip.weights,
         grip.stiffness * (Mat3::Identity() - along) + grip.normal_stiffness * along);
  }
}

size_t Contacts::find_grips(const RigidTransform& mandible, const RigidTransform& mandible_step,
                            std::span<const FacingPair> pairs, const Vec3* before, const Vec3* x,
                            std::span<Grip> grips, const std::vector<uint32_t>* near_bones) const {
  size_t count = 0;
  const auto add = [&](Grip grip, double force, const Vec3& slid) {
    if (count >= grips.size()) return;
    const Vec3 along = slid - grip.normal.dot(slid) * grip.normal;
    // Coulomb's force at the speed of the last step, as a spring over the next; it sticks below a hundredth
    // of a millimetre.
    grip.stiffness = options_.friction * force / std::max(along.norm(), 1e-5);
    grips[count++] = grip;
  };
  for (size_t c = 0; c < globe_nodes_.size(); ++c) {
    const Touch touch = globe_touch(c, x);
    const uint32_t node = globe_nodes_[c];
    Grip grip;
    grip.node = node;
    grip.normal = touch.normal;
    grip.anchor = x[node];
    if (touch.depth > 0.0) add(grip, options_.globe_stiffness * touch.depth, x[node] - before[node]);
  }
  const size_t bones = near_bones != nullptr ? near_bones->size() : bone_nodes_.size();
  for (size_t i = 0; i < bones; ++i) {
    const size_t c = near_bones != nullptr ? (*near_bones)[i] : i;
    const Touch touch = bone_touch(c, mandible, x);
    if (touch.depth <= 0.0) continue;
    const uint32_t node = bone_nodes_[c];
    const bool moves = field_bones_[bone_fields_[c]] == 1;
    Grip grip;
    grip.node = node;
    grip.normal = touch.normal.normalized();
    grip.anchor = moves ? mandible_step * x[node] : x[node];
    add(grip, options_.bone_stiffness * touch.depth, x[node] - before[node]);
  }
  for (size_t i = 0; i < pairs.size(); ++i) {
    const FacingPair& pair = pairs[i];
    if (!pair.is_found()) continue;
    const double depth = pair.margin - pair.gap(x), reach = options_.sticky_reach * options_.stickiness;
    const bool sticks = facing_sides_[i] < 2 && options_.stickiness > 0.0 && -depth < reach;
    if (depth <= 0.0 && !sticks) continue;
    Grip grip;
    grip.node = pair.node;
    grip.corners = pair.corners;
    grip.weights = pair.weights;
    grip.normal = pair.normal;
    Vec3 now = x[pair.node], then = before[pair.node];
    for (size_t k = 0; k < 3; ++k) {
      now -= pair.weights[static_cast<int>(k)] * x[pair.corners[k]];
      then -= pair.weights[static_cast<int>(k)] * before[pair.corners[k]];
    }
    grip.anchor = now;
    if (sticks) {  // pulled back to touching, until the gap is past its reach
      grip.anchor -= std::max(0.0, -depth) * grip.normal;
      grip.normal_stiffness = options_.sticky_stiffness * options_.stickiness;
    }
    add(grip, options_.facing_stiffness * std::max(0.0, depth), now - then);
  }
  return count;
}

double Contacts::deepest(const RigidTransform& mandible, const Vec3* x) const {
  double most = 0.0;
  for (size_t c = 0; c < globe_nodes_.size(); ++c)
    most = std::max(most, globe_touch(c, x).depth);
  for (size_t c = 0; c < bone_nodes_.size(); ++c)
    most = std::max(most, bone_touch(c, mandible, x).depth);
  FacingPair pair;
  FacingSearch search = make_search();
  for (size_t i = 0; i < facing_nodes_.size(); ++i) {
    pair_of(i, x, search, pair);
    if (pair.is_found()) most = std::max(most, pair.margin - pair.gap(x));
  }
  return most;
}

}  // namespace fascia::sim
