#pragma once

#include <cstddef>
#include <cstdint>
#include <string_view>

#include "rig/model/muscle_table.h"
#include "rig/model/rig.h"

/// The one list of what a rig file holds: every field of the model once, with its name in the file, its
/// length and its range. Reading, writing and checking are visitors that walk these lists, so that a new
/// field is one line here (and one in the schema under rig/spec).
///
/// A visitor offers
///   text(name, string)                     number(name, scalar)              hash(name, uint64_t)
///   bounded(name, double, least, most)     a number that must be given, within bounds
///   vector(name, Vec3f)                    matrix(name, Mat4f)               choice(name, enum, names)
///   object(name, body)                     array(name, std::vector, body(visitor, element, index))
///   list(name, std::vector, length)        finite numbers, in an accessor
///   unbounded(name, std::vector, length)   the same, where infinity is allowed
///   index(name, std::vector, length, limit)   whole numbers below `limit`, in an accessor
///   offsets(name, std::vector, length)     rising from 0: where each run of a list begins
///   triangles(name, std::vector, limit)    triangles as a flat index list
///   names(name, std::vector, member)       one text per element; gives the vector its length
///   column(name, std::vector, member)      one number per element, in an accessor
///   texts(name, std::vector<std::string>)
/// A length of `any` is whatever the file says. Every template takes the struct const or not.
namespace fascia::rig {

inline constexpr std::size_t any = SIZE_MAX;
inline constexpr std::string_view fibre_end_names[] = {"smas", "skin", "cranium", "mandible"};

template <class V, class T>
void surface_fields(V& v, T& surface) {
  v.list("positions", surface.positions, any);
  v.triangles("indices", surface.triangles, surface.positions.size());
}

template <class V, class T>
void jaw_fields(V& v, T& jaw) {
  v.vector("origin", jaw.origin);
  v.vector("lateral", jaw.lateral);
  v.vector("forward", jaw.forward);
  v.vector("up", jaw.up);
  v.number("openAngle", jaw.open_angle);
  v.vector("openGlide", jaw.open_glide);
  v.number("forwardGlide", jaw.forward_glide);
  v.number("forwardDrop", jaw.forward_drop);
  v.number("lateralAngle", jaw.lateral_angle);
  v.number("lateralGlide", jaw.lateral_glide);
  v.number("travelTime", jaw.travel_time);
}

template <class V, class T>
void eye_fields(V& v, T& eye) {
  v.vector("centre", eye.centre);
  v.number("radius", eye.radius);
  v.vector("gaze", eye.gaze);
}

template <class V, class T>
void skull_fields(V& v, T& skull) {
  v.object("cranium", [&](auto& o) { surface_fields(o, skull.cranium); });
  v.object("mandible", [&](auto& o) { surface_fields(o, skull.mandible); });
  v.object("teethUpper", [&](auto& o) { surface_fields(o, skull.teeth_upper); });
  v.object("teethLower", [&](auto& o) { surface_fields(o, skull.teeth_lower); });
  v.object("landmarks", [&](auto& o) {
    o.names("names", skull.landmarks, &Landmark::name);
    o.column("skin", skull.landmarks, &Landmark::skin);
    o.column("bone", skull.landmarks, &Landmark::bone);
    o.column("depth", skull.landmarks, &Landmark::depth);
    o.column("confidence", skull.landmarks, &Landmark::confidence);
  });
  v.object("jaw", [&](auto& o) { jaw_fields(o, skull.jaw); });
  v.object("eyeLeft", [&](auto& o) { eye_fields(o, skull.eye_left); });
  v.object("eyeRight", [&](auto& o) { eye_fields(o, skull.eye_right); });
}

template <class V, class T>
void smas_fields(V& v, T& smas) {
  v.object("surface", [&](auto& o) { surface_fields(o, smas.surface); });
  const std::size_t vertices = smas.surface.positions.size();
  v.list("depthToSkin", smas.depth_to_skin, vertices);
  v.list("depthToBone", smas.depth_to_bone, vertices);
  v.list("skinAttachment", smas.skin_attachment, vertices);
  v.list("boneAttachment", smas.bone_attachment, vertices);
  v.object("ligaments", [&](auto& o) {
    o.names("names", smas.ligaments, &Ligament::name);
    o.column("bone", smas.ligaments, &Ligament::bone);
    o.column("skin", smas.ligaments, &Ligament::skin);
    o.column("stiffness", smas.ligaments, &Ligament::stiffness);
  });
}

template <class V, class T>
void muscle_fields(V& v, T& muscle) {
  v.text("name", muscle.name);
  v.text("group", muscle.group);
  v.text("kind", muscle.kind);
  v.choice("origin", muscle.origin, fibre_end_names);
  v.choice("insertion", muscle.insertion, fibre_end_names);
  v.number("strength", muscle.strength);
  v.number("peakShortening", muscle.peak_shortening);
}

/// `smas_triangles` is the number of triangles of the SMAS surface, which fibres are bound to.
template <class V, class T>
void muscle_table_fields(V& v, T& table, std::size_t smas_triangles) {
  v.array("muscles", table.heads, [](auto& o, auto& head, std::size_t) { muscle_fields(o, head); });
  const std::size_t offsets = table.heads.size() + 1;
  v.offsets("fibres", table.fibres, offsets);
  v.offsets("fibrePoints", table.fibre_points, run_end(table.fibres) + 1);
  const std::size_t points = run_end(table.fibre_points);
  v.list("points", table.points, points);
  v.index("triangles", table.triangles, points, smas_triangles);
  v.list("barycentrics", table.barycentrics, points);
  v.list("offsets", table.offsets, points);
  v.offsets("originRegions", table.origin_regions, offsets);
  v.list("originRegionPoints", table.origin_points, run_end(table.origin_regions));
  v.offsets("insertionRegions", table.insertion_regions, offsets);
  v.list("insertionRegionPoints", table.insertion_points, run_end(table.insertion_regions));
}

/// How many muscles and channels there are: what indices in the tissue may point at.
struct TissueLimits {
  std::size_t muscles = 0;
  std::size_t channels = 0;
};

template <class V, class T>
void tissue_level_fields(V& v, T& level, const TissueLimits& limits) {
  v.text("name", level.name);
  v.number("columns", level.columns);
  const std::size_t columns = level.columns, nodes = 3 * columns;
  v.list("rest", level.rest, nodes);
  v.index("kinds", level.kinds, nodes, static_cast<std::size_t>(NodeKind::mucosa) + 1);
  v.list("masses", level.masses, nodes);
  v.list("jawWeights", level.jaw_weights, nodes);
  v.index("prisms", level.triangles, any, columns);
  const std::size_t prisms = level.triangles.size();

  v.index("springNodes", level.spring_nodes, any, nodes);
  const std::size_t springs = level.spring_nodes.size();
  v.list("springStiffness", level.spring_stiffness, springs);
  v.unbounded("springLimitStrain", level.spring_limit_strain, springs);
  v.list("springSecondStiffness", level.spring_second_stiffness, springs);
  v.index("springOneSided", level.spring_one_sided, springs, 2);

  v.list("skinMembrane", level.skin_membrane, prisms);
  v.list("smasMembrane", level.smas_membrane, prisms);
  v.list("skinBending", level.skin_bending, columns);
  v.list("smasBending", level.smas_bending, columns);
  v.number("poissonRatio", level.poisson_ratio);

  v.index("tetherNodes", level.tether_nodes, any, nodes);
  const std::size_t tethers = level.tether_nodes.size();
  v.list("tetherNormals", level.tether_normals, tethers);
  v.list("tetherNormalStiffness", level.tether_normal_stiffness, tethers);
  v.list("tetherTangentialStiffness", level.tether_tangential_stiffness, tethers);

  v.list("volumeStiffness", level.volume_stiffness, prisms);
  v.list("innerVolumeStiffness", level.inner_volume_stiffness, prisms);

  v.index("fibreMuscles", level.fibre_muscle, any, limits.muscles);
  const std::size_t fibres = level.fibre_muscle.size();
  v.index("fibreChannels", level.fibre_channel, fibres, limits.channels);
  v.offsets("fibreOffsets", level.fibre_offsets, fibres + 1);
  const std::size_t points = run_end(level.fibre_offsets);
  v.index("fibreNodes", level.fibre_nodes, points, nodes);
  v.list("fibreWeights", level.fibre_weights, points);
  v.list("fibreRest", level.fibre_rest, points);
  v.index("fibreAnchors", level.fibre_anchor, points, static_cast<std::size_t>(FibreEnd::mandible) + 1);
  v.list("fibreTaper", level.fibre_taper, points);
  v.list("fibreStrength", level.fibre_strength, fibres);
  v.list("fibreShortest", level.fibre_shortest, fibres);

  v.index("carrierChannels", level.carrier_channel, any, limits.channels);
  const std::size_t carriers = level.carrier_channel.size();
  v.index("carrierNodes", level.carrier_node, carriers, nodes);
  v.list("carrierOrigins", level.carrier_origin, carriers);
  v.list("carrierAxes", level.carrier_axis, carriers);
  v.list("carrierAngles", level.carrier_angle, carriers);
  v.list("carrierReverseAngles", level.carrier_reverse, carriers);
  v.list("carrierStiffness", level.carrier_stiffness, carriers);
  v.list("carrierDrive", level.carrier_drive, carriers);

  v.index("pressureChannels", level.pressure_channel, any, limits.channels);
  const std::size_t pressures = level.pressure_channel.size();
  v.index("pressurePrisms", level.pressure_prism, pressures, prisms);
  v.list("pressures", level.pressure, pressures);

  v.list("globeCentres", level.globe_centre, any);
  const std::size_t globes = level.globe_centre.size();
  v.list("globeRadii", level.globe_radius, globes);
  v.index("globeContactNodes", level.globe_contact_node, any, nodes);
  v.index("globeContactGlobes", level.globe_contact_globe, level.globe_contact_node.size(), globes);

  v.index("contactFieldBones", level.contact_field_bone, any, 2);
  const std::size_t fields = level.contact_field_bone.size();
  v.list("contactFieldOrigins", level.contact_field_origin, fields);
  v.list("contactFieldSpacings", level.contact_field_spacing, fields);
  v.list("contactFieldSteps", level.contact_field_step, fields);
  v.index("contactFieldSizes", level.contact_field_size, fields, 1024);
  v.index("contactFieldValues", level.contact_field_values, any, 256);
  v.index("contactNodes", level.contact_node, any, nodes);
  v.index("contactNodeFields", level.contact_field, level.contact_node.size(), fields);

  v.index("facingPrisms", level.facing_prism, any, prisms);
  v.index("facingSides", level.facing_side, level.facing_prism.size(), 6);
}

template <class V, class T>
void facing_range_fields(V& v, T& range) {
  v.bounded("before", range.before, 0.0, 0.1);
  v.bounded("behind", range.behind, 0.0, 0.1);
  v.bounded("beside", range.beside, 0.0, 0.1);
}

template <class V, class T>
void mechanics_fields(V& v, T& mechanics) {
  v.bounded("stiffnessDamping", mechanics.stiffness_damping, 0.0, 1.0);
  v.bounded("massDamping", mechanics.mass_damping, 0.0, 1000.0);
  v.bounded("activationRise", mechanics.activation_rise, 0.0, 10.0);
  v.bounded("activationDecay", mechanics.activation_decay, 0.0, 10.0);
  v.bounded("initialForceSlope", mechanics.initial_force_slope, 0.0, 1.0);
  v.bounded("globeStiffness", mechanics.globe_stiffness, 0.0, 1e5);
  v.bounded("boneStiffness", mechanics.bone_stiffness, 0.0, 1e5);
  v.bounded("facingStiffness", mechanics.facing_stiffness, 0.0, 1e5);
  v.bounded("contactThickness", mechanics.contact_thickness, -0.01, 0.01);
  v.bounded("lidThickness", mechanics.lid_thickness, -0.01, 0.01);
  v.bounded("friction", mechanics.friction, 0.0, 10.0);
  v.bounded("stickyReach", mechanics.sticky_reach, 0.0, 0.1);
  v.bounded("stickyStiffness", mechanics.sticky_stiffness, 0.0, 1e5);
  v.object("lipRange", [&](auto& o) { facing_range_fields(o, mechanics.lip_range); });
  v.object("lidRange", [&](auto& o) { facing_range_fields(o, mechanics.lid_range); });
}

/// `nodes` is the number of nodes of the level the binding belongs to.
template <class V, class T>
void binding_fields(V& v, T& binding, std::size_t nodes) {
  v.number("mesh", binding.mesh);
  v.number("primitive", binding.primitive);
  v.text("part", binding.part);
  v.number("vertexCount", binding.vertex_count);
  v.hash("positionHash", binding.position_hash);
  v.matrix("toRig", binding.to_rig);
  v.number("influences", binding.influences);
  const std::size_t vertices = binding.vertex_count;
  v.index("nodes", binding.nodes, vertices * binding.influences, nodes);
  v.list("weights", binding.weights, vertices * binding.influences);
  v.list("jawWeights", binding.jaw_weights, vertices);
  v.index("eyes", binding.eye, vertices, 3);
}

template <class V, class T>
void channel_fields(V& v, T& channel) {
  v.text("name", channel.name);
  v.text("group", channel.group);
  v.number("minimum", channel.minimum);
  v.number("maximum", channel.maximum);
  v.number("rest", channel.rest);
  v.number("muscle", channel.muscle);
  v.text("unit", channel.unit);
}

/// `channels` is the number of channels that entries may point at.
template <class V, class T>
void named_set_fields(V& v, T& set, std::size_t channels) {
  v.text("name", set.name);
  v.texts("members", set.members);
  v.index("entryMembers", set.member_indices, any, set.members.size());
  const std::size_t entries = set.member_indices.size();
  v.index("entryChannels", set.channel_indices, entries, channels);
  v.list("entryWeights", set.weights, entries);
  v.list("responseWeights", set.response_weights, any);
  v.list("responses", set.responses, set.response_weights.size() * set.members.size());
}

template <class V, class T>
void actuation_fields(V& v, T& actuation) {
  v.array("channels", actuation.channels,
          [](auto& o, auto& channel, std::size_t) { channel_fields(o, channel); });
  const std::size_t channels = actuation.channels.size();
  v.array("sets", actuation.sets,
          [channels](auto& o, auto& set, std::size_t) { named_set_fields(o, set, channels); });
}

}  // namespace fascia::rig
