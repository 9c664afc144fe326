#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "sim/vector.h"

namespace fascia::sim {

/// How a lattice node is held. The numbers are those of the rig file. A `fixed_mandible` node moves with the
/// jaw by its jaw weight: 1 on the bone itself, less in deep tissue between both bones.
enum class NodeKind : uint8_t {
  free = 0,
  fixed = 1,
  fixed_cranium = 2,
  fixed_mandible = 3,
  gliding_cranium = 4,
  gliding_mandible = 5,
  mucosa = 6
};

/// What a fibre point follows. The numbers are those of the rig file.
enum class FibreAnchor : uint8_t { smas = 0, skin = 1, cranium = 2, mandible = 3 };

/// A view of one level of detail of the tissue: spans onto arrays the caller keeps alive.
///
/// Nodes form columns of three layers (skin, SMAS, inner): node `layer * columns + column`. Lengths in
/// metres, stiffnesses in newton per metre unless said otherwise. An optional list may be empty.
struct Lattice {
  uint32_t columns = 0;
  std::span<const Vec3f> rest;         ///< #nodes = 3 * columns
  std::span<const uint8_t> kinds;      ///< #nodes, NodeKind
  std::span<const float> masses;       ///< #nodes, kilogram
  std::span<const float> jaw_weights;  ///< #nodes, 0 carried by the cranium .. 1 by the mandible
  std::span<const std::array<uint32_t, 3>> triangles;  ///< #prisms, columns

  std::span<const std::array<uint32_t, 2>> spring_nodes;
  std::span<const float> spring_stiffness;
  std::span<const float> spring_limit_strain;
  std::span<const float> spring_second_stiffness;
  std::span<const uint8_t> spring_one_sided;

  std::span<const float> skin_membrane, smas_membrane;  ///< #prisms, Young's modulus times thickness
  std::span<const float> skin_bending, smas_bending;    ///< #columns, flexural rigidity, newton metre
  float poisson_ratio = 0.0F;                           ///< of both membranes

  std::span<const uint32_t> tether_nodes;
  std::span<const Vec3f> tether_normals;
  std::span<const float> tether_normal_stiffness, tether_tangential_stiffness;

  std::span<const float> volume_stiffness;        ///< #prisms, pascal: between skin and SMAS
  std::span<const float> inner_volume_stiffness;  ///< #prisms, pascal: between SMAS and inner layer

  std::span<const uint32_t> fibre_channel;               ///< #fibres
  std::span<const uint32_t> fibre_offsets;               ///< #fibres + 1
  std::span<const std::array<uint32_t, 3>> fibre_nodes;  ///< #points
  std::span<const Vec3f> fibre_weights;                  ///< #points
  std::span<const Vec3f> fibre_rest;                     ///< #points
  std::span<const uint8_t> fibre_anchor;                 ///< #points, FibreAnchor
  std::span<const float> fibre_taper;     ///< #points, tension share of the segment that begins here
  std::span<const float> fibre_strength;  ///< #fibres, newton at full activation
  std::span<const float> fibre_shortest;  ///< #fibres, share of the rest length where the pull ends

  std::span<const uint32_t> carrier_channel, carrier_node;
  std::span<const Vec3f> carrier_origin, carrier_axis;
  std::span<const float> carrier_angle;      ///< radians at channel value 1
  std::span<const float> carrier_reverse;    ///< radians at channel value -1
  std::span<const float> carrier_stiffness;  ///< pulls the node back to its rigidly moved position
  std::span<const float> carrier_drive;      ///< force per metre of the carrier's motion

  std::span<const uint32_t> pressure_channel, pressure_prism;
  std::span<const float> pressure;  ///< pascal at channel value 1

  std::span<const Vec3f> globe_centre;                                ///< #globes, eyeballs that lids lie on
  std::span<const float> globe_radius;                                ///< #globes
  std::span<const uint32_t> globe_contact_node, globe_contact_globe;  ///< pairs that may touch

  std::span<const uint8_t> contact_field_bone;                       ///< #fields, 0 cranium, 1 mandible
  std::span<const Vec3f> contact_field_origin;                       ///< #fields
  std::span<const float> contact_field_spacing, contact_field_step;  ///< #fields
  std::span<const std::array<uint32_t, 3>> contact_field_size;       ///< #fields, values along x, y, z
  std::span<const uint8_t>
      contact_field_values;  ///< one field after the other, x fastest; (value - 128) * step
  std::span<const uint32_t> contact_node, contact_field;  ///< pairs that may touch

  std::span<const uint32_t> facing_prism;  ///< outer sides that may touch one another
  std::span<const uint8_t> facing_side;    ///< an even side meets the odd one after it

  uint32_t node_count() const { return 3 * columns; }
  uint32_t fibre_count() const { return static_cast<uint32_t>(fibre_channel.size()); }
};

/// A message if `lattice` is invalid, or null: inconsistent sizes, indices out of range, values that are not
/// finite, negative stiffness.
const char* lattice_fault(const Lattice& lattice);

/// Whether two enumerators of a file and of the solver stand for the same number.
template <class A, class B>
constexpr bool is_same_number(A a, B b) {
  return static_cast<uint8_t>(a) == static_cast<uint8_t>(b);
}

/// Ties the enumerators of a file, whose bytes `lattice_of` takes as they are, to those of the solver.
template <class FileKind, class FileAnchor>
constexpr bool has_same_numbers() {
  return is_same_number(FileKind::free, NodeKind::free) && is_same_number(FileKind::fixed, NodeKind::fixed) &&
         is_same_number(FileKind::fixed_cranium, NodeKind::fixed_cranium) &&
         is_same_number(FileKind::fixed_mandible, NodeKind::fixed_mandible) &&
         is_same_number(FileKind::gliding_cranium, NodeKind::gliding_cranium) &&
         is_same_number(FileKind::gliding_mandible, NodeKind::gliding_mandible) &&
         is_same_number(FileKind::mucosa, NodeKind::mucosa) &&
         is_same_number(FileAnchor::smas, FibreAnchor::smas) &&
         is_same_number(FileAnchor::skin, FibreAnchor::skin) &&
         is_same_number(FileAnchor::cranium, FibreAnchor::cranium) &&
         is_same_number(FileAnchor::mandible, FibreAnchor::mandible);
}

/// The view of a rig's tissue level (any struct with its field names).
template <class Level>
Lattice lattice_of(const Level& level) {
  static_assert(has_same_numbers<typename decltype(level.kinds)::value_type,
                                 typename decltype(level.fibre_anchor)::value_type>());
  const auto bytes = [](const auto& list) {
    return std::span<const uint8_t>(reinterpret_cast<const uint8_t*>(list.data()), list.size());
  };
  Lattice view;
  view.columns = level.columns;
  view.rest = level.rest;
  view.kinds = bytes(level.kinds);
  view.masses = level.masses;
  view.jaw_weights = level.jaw_weights;
  view.triangles = level.triangles;
  view.spring_nodes = level.spring_nodes;
  view.spring_stiffness = level.spring_stiffness;
  view.spring_limit_strain = level.spring_limit_strain;
  view.spring_second_stiffness = level.spring_second_stiffness;
  view.spring_one_sided = level.spring_one_sided;
  view.skin_membrane = level.skin_membrane;
  view.smas_membrane = level.smas_membrane;
  view.skin_bending = level.skin_bending;
  view.smas_bending = level.smas_bending;
  view.poisson_ratio = level.poisson_ratio;
  view.tether_nodes = level.tether_nodes;
  view.tether_normals = level.tether_normals;
  view.tether_normal_stiffness = level.tether_normal_stiffness;
  view.tether_tangential_stiffness = level.tether_tangential_stiffness;
  view.volume_stiffness = level.volume_stiffness;
  view.inner_volume_stiffness = level.inner_volume_stiffness;
  view.fibre_channel = level.fibre_channel;
  view.fibre_offsets = level.fibre_offsets;
  view.fibre_nodes = level.fibre_nodes;
  view.fibre_weights = level.fibre_weights;
  view.fibre_rest = level.fibre_rest;
  view.fibre_anchor = bytes(level.fibre_anchor);
  view.fibre_taper = level.fibre_taper;
  view.fibre_strength = level.fibre_strength;
  view.fibre_shortest = level.fibre_shortest;
  view.carrier_channel = level.carrier_channel;
  view.carrier_node = level.carrier_node;
  view.carrier_origin = level.carrier_origin;
  view.carrier_axis = level.carrier_axis;
  view.carrier_angle = level.carrier_angle;
  view.carrier_reverse = level.carrier_reverse;
  view.carrier_stiffness = level.carrier_stiffness;
  view.carrier_drive = level.carrier_drive;
  view.pressure_channel = level.pressure_channel;
  view.pressure_prism = level.pressure_prism;
  view.pressure = level.pressure;
  view.globe_centre = level.globe_centre;
  view.globe_radius = level.globe_radius;
  view.globe_contact_node = level.globe_contact_node;
  view.globe_contact_globe = level.globe_contact_globe;
  view.contact_field_bone = level.contact_field_bone;
  view.contact_field_origin = level.contact_field_origin;
  view.contact_field_spacing = level.contact_field_spacing;
  view.contact_field_step = level.contact_field_step;
  view.contact_field_size = level.contact_field_size;
  view.contact_field_values = level.contact_field_values;
  view.contact_node = level.contact_node;
  view.contact_field = level.contact_field;
  view.facing_prism = level.facing_prism;
  view.facing_side = level.facing_side;
  return view;
}

}  // namespace fascia::sim
