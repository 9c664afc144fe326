#include "sim/lattice.h"

#include <cmath>

namespace fascia::sim {
namespace {

// What single precision still resolves, with a wide margin around what tissue is like.
constexpr float farthest = 1000.0F;  // metres from the origin
constexpr float smallest = 1e-4F;    // metres across
constexpr float heaviest = 1e3F;     // kilogram a node
constexpr float lightest = 1e-15F;
constexpr float stiffest = 1e10F;     // newton per metre, pascal, ...
constexpr float strongest = 1e6F;     // newton, pascal
constexpr float largest_turn = 6.3F;  // radians

bool all_positive(std::span<const float> values) {
  for (const float value : values)
    if (!(value >= 0.0F)) return false;
  return true;
}

bool all_within(std::span<const float> values, float least, float most) {
  for (const float value : values)
    if (!(value >= least && value <= most)) return false;
  return true;
}

bool all_within(std::span<const Vec3f> values, float most) {
  for (const Vec3f& value : values)
    if (!(value.cwiseAbs().array() <= most).all()) return false;
  return true;
}

bool all_finite(std::span<const Vec3f> values) {
  for (const Vec3f& value : values)
    if (!value.allFinite()) return false;
  return true;
}

bool all_below(std::span<const uint32_t> values, size_t limit) {
  for (const uint32_t value : values)
    if (value >= limit) return false;
  return true;
}

const char* fault_of_nodes(const Lattice& l) {
  const size_t nodes = l.node_count();
  if (l.columns == 0) return "the lattice has no columns";
  if (l.rest.size() != nodes || l.kinds.size() != nodes || l.masses.size() != nodes ||
      l.jaw_weights.size() != nodes)
    return "rest, kinds, masses and jaw_weights need one entry a node";
  if (!all_finite(l.rest)) return "a rest position is not finite";
  if (!all_within(l.rest, farthest))
    return "a rest position lies more than a kilometre from the origin: move the head to the origin and "
           "build "
           "the rig again";
  Vec3f low = l.rest.front(), high = low;
  for (const Vec3f& place : l.rest) {
    low = low.cwiseMin(place);
    high = high.cwiseMax(place);
  }
  if (!((high - low).norm() >= smallest)) return "the lattice is less than a tenth of a millimetre across";
  for (const uint8_t kind : l.kinds)
    if (kind > static_cast<uint8_t>(NodeKind::mucosa)) return "a node is of no known kind";
  for (const float mass : l.masses)
    if (!(mass > 0.0F) || !std::isfinite(mass)) return "a node's mass is not positive";
  if (!all_within(l.masses, lightest, heaviest)) return "a node's mass is out of all proportion";
  for (const float weight : l.jaw_weights)
    if (!(weight >= 0.0F && weight <= 1.0F)) return "a jaw weight is not within 0..1";
  for (const auto& triangle : l.triangles)
    if (!all_below(triangle, l.columns)) return "a prism names a column that does not exist";
  return nullptr;
}

const char* fault_of_layers(const Lattice& l) {
  const size_t springs = l.spring_nodes.size(), prisms = l.triangles.size();
  if (l.spring_stiffness.size() != springs || l.spring_limit_strain.size() != springs ||
      l.spring_second_stiffness.size() != springs || l.spring_one_sided.size() != springs)
    return "the spring lists differ in length";
  for (const auto& pair : l.spring_nodes)
    if (!all_below(pair, l.node_count()) || pair[0] == pair[1])
      return "a spring names a node that does not exist";
  if (!all_positive(l.spring_stiffness) || !all_positive(l.spring_limit_strain) ||
      !all_positive(l.spring_second_stiffness))
    return "a spring has a negative stiffness or limit";
  if (!all_within(l.spring_stiffness, 0.0F, stiffest) ||
      !all_within(l.spring_second_stiffness, 0.0F, stiffest))
    return "a spring's stiffness is out of all proportion";
  if (l.skin_membrane.size() != prisms || l.smas_membrane.size() != prisms ||
      l.volume_stiffness.size() != prisms || l.inner_volume_stiffness.size() != prisms)
    return "membranes and volume stiffnesses need one entry a prism";
  if (l.skin_bending.size() != l.columns || l.smas_bending.size() != l.columns)
    return "bending needs one entry a column";
  if (!all_positive(l.skin_membrane) || !all_positive(l.smas_membrane) || !all_positive(l.volume_stiffness) ||
      !all_positive(l.inner_volume_stiffness) || !all_positive(l.skin_bending) ||
      !all_positive(l.smas_bending))
    return "a layer stiffness is negative";
  for (const auto& list : {l.skin_membrane, l.smas_membrane, l.volume_stiffness, l.inner_volume_stiffness,
                           l.skin_bending, l.smas_bending})
    if (!all_within(list, 0.0F, stiffest)) return "a layer stiffness is out of all proportion";
  if (!(l.poisson_ratio >= 0.0F && l.poisson_ratio < 0.5F)) return "poisson_ratio is not within 0..0.5";
  const size_t tethers = l.tether_nodes.size();
  if (l.tether_normals.size() != tethers || l.tether_normal_stiffness.size() != tethers ||
      l.tether_tangential_stiffness.size() != tethers)
    return "the tether lists differ in length";
  if (!all_below(l.tether_nodes, l.node_count())) return "a tether names a node that does not exist";
  if (!all_finite(l.tether_normals) || !all_positive(l.tether_normal_stiffness) ||
      !all_positive(l.tether_tangential_stiffness))
    return "a tether is not finite or is negative";
  if (!all_within(l.tether_normal_stiffness, 0.0F, stiffest) ||
      !all_within(l.tether_tangential_stiffness, 0.0F, stiffest))
    return "a tether's stiffness is out of all proportion";
  return nullptr;
}

const char* fault_of_fibres(const Lattice& l) {
  const size_t fibres = l.fibre_channel.size(), points = l.fibre_nodes.size();
  if (fibres == 0) return points == 0 ? nullptr : "there are fibre points but no fibres";
  if (l.fibre_offsets.size() != fibres + 1 || l.fibre_strength.size() != fibres ||
      l.fibre_shortest.size() != fibres)
    return "the fibre lists differ in length";
  if (l.fibre_weights.size() != points || l.fibre_rest.size() != points || l.fibre_anchor.size() != points ||
      l.fibre_taper.size() != points)
    return "the fibre point lists differ in length";
  if (l.fibre_offsets.front() != 0 || l.fibre_offsets.back() != points)
    return "fibre_offsets do not span the points";
  for (size_t f = 0; f < fibres; ++f)
    if (l.fibre_offsets[f] > l.fibre_offsets[f + 1]) return "fibre_offsets fall";
  for (const auto& nodes : l.fibre_nodes)
    if (!all_below(nodes, l.node_count())) return "a fibre names a node that does not exist";
  if (!all_finite(l.fibre_weights) || !all_finite(l.fibre_rest)) return "a fibre point is not finite";
  if (!all_positive(l.fibre_strength) || !all_positive(l.fibre_taper))
    return "a fibre's strength is negative";
  if (!all_within(l.fibre_strength, 0.0F, strongest) || !all_within(l.fibre_taper, 0.0F, 1e3F) ||
      !all_within(l.fibre_weights, 1e3F) || !all_within(l.fibre_rest, farthest))
    return "a fibre's numbers are out of all proportion";
  for (const float share : l.fibre_shortest)
    if (!(share >= 0.0F && share < 1.0F)) return "fibre_shortest is not within 0..1";
  for (const uint8_t anchor : l.fibre_anchor)
    if (anchor > static_cast<uint8_t>(FibreAnchor::mandible)) return "a fibre anchor is of no known kind";
  return nullptr;
}

const char* fault_of_actuators(const Lattice& l) {
  const size_t carriers = l.carrier_channel.size();
  if (l.carrier_node.size() != carriers || l.carrier_origin.size() != carriers ||
      l.carrier_axis.size() != carriers || l.carrier_angle.size() != carriers ||
      l.carrier_reverse.size() != carriers || l.carrier_stiffness.size() != carriers ||
      l.carrier_drive.size() != carriers)
    return "the carrier lists differ in length";
  if (!all_below(l.carrier_node, l.node_count())) return "a carrier names a node that does not exist";
  if (!all_finite(l.carrier_origin) || !all_finite(l.carrier_axis) || !all_positive(l.carrier_stiffness) ||
      !all_positive(l.carrier_drive))
    return "a carrier is not finite or is negative";
  if (!all_within(l.carrier_origin, farthest) || !all_within(l.carrier_axis, 1e3F) ||
      !all_within(l.carrier_angle, -largest_turn, largest_turn) ||
      !all_within(l.carrier_reverse, -largest_turn, largest_turn) ||
      !all_within(l.carrier_stiffness, 0.0F, stiffest) || !all_within(l.carrier_drive, 0.0F, stiffest))
    return "a carrier's numbers are out of all proportion";
  if (l.pressure_prism.size() != l.pressure_channel.size() || l.pressure.size() != l.pressure_channel.size())
    return "the pressure lists differ in length";
  if (!all_below(l.pressure_prism, l.triangles.size())) return "a pressure names a prism that does not exist";
  if (!all_within(l.pressure, -strongest, strongest)) return "a pressure is out of all proportion";
  if (l.globe_radius.size() != l.globe_centre.size() || !all_finite(l.globe_centre) ||
      !all_positive(l.globe_radius))
    return "the globe lists are at fault";
  if (!all_within(l.globe_centre, farthest) || !all_within(l.globe_radius, 0.0F, farthest))
    return "a globe is out of all proportion";
  if (l.globe_contact_globe.size() != l.globe_contact_node.size() ||
      !all_below(l.globe_contact_node, l.node_count()) ||
      !all_below(l.globe_contact_globe, l.globe_centre.size()))
    return "a globe contact names what does not exist";
  return nullptr;
}

const char* fault_of_contact(const Lattice& l) {
  const size_t fields = l.contact_field_bone.size();
  if (l.contact_field_origin.size() != fields || l.contact_field_spacing.size() != fields ||
      l.contact_field_step.size() != fields || l.contact_field_size.size() != fields)
    return "the contact field lists differ in length";
  size_t values = 0;
  for (size_t f = 0; f < fields; ++f) {
    const auto& size = l.contact_field_size[f];
    if (!(l.contact_field_spacing[f] > 0.0F) || !(l.contact_field_step[f] > 0.0F) ||
        !std::isfinite(l.contact_field_spacing[f]) || !std::isfinite(l.contact_field_step[f]) ||
        size[0] < 3 || size[1] < 3 || size[2] < 3 || size[0] > 1024 || size[1] > 1024 || size[2] > 1024 ||
        l.contact_field_bone[f] > 1)
      return "a contact field is degenerate";
    values += static_cast<size_t>(size[0]) * size[1] * size[2];
  }
  if (!all_within(l.contact_field_origin, farthest) ||
      !all_within(l.contact_field_spacing, 1e-6F, farthest) ||
      !all_within(l.contact_field_step, 1e-9F, farthest))
    return "a contact field is out of all proportion";
  if (!all_finite(l.contact_field_origin) || l.contact_field_values.size() != values)
    return "a contact field has not the values its size tells";
  if (l.contact_node.size() != l.contact_field.size() || !all_below(l.contact_node, l.node_count()) ||
      !all_below(l.contact_field, fields))
    return "a bone contact names what does not exist";
  if (l.facing_prism.size() != l.facing_side.size() || !all_below(l.facing_prism, l.triangles.size()))
    return "a facing side names a prism that does not exist";
  for (const uint8_t side : l.facing_side)
    if (side > 5) return "a facing side is of no known kind";
  return nullptr;
}

}  // namespace

const char* lattice_fault(const Lattice& lattice) {
  if (const char* fault = fault_of_nodes(lattice)) return fault;
  if (const char* fault = fault_of_layers(lattice)) return fault;
  if (const char* fault = fault_of_fibres(lattice)) return fault;
  if (const char* fault = fault_of_actuators(lattice)) return fault;
  return fault_of_contact(lattice);
}

}  // namespace fascia::sim
