#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

/// The data model of a face rig, independent of any file format. Everything is in metres, right-handed, +Y
/// up, the face looking along +Z, in the head's bind pose; in single precision, as it is stored and
/// simulated, where nothing else is said.
namespace fascia::rig {

using Vec2f = Eigen::Vector2f;
using Vec3f = Eigen::Vector3f;
using Vec4f = Eigen::Vector4f;
using Triangle = std::array<uint32_t, 3>;
using Mat4f = Eigen::Matrix4f;

/// A triangle surface of the anatomy.
struct Surface {
  std::vector<Vec3f> positions;
  std::vector<Triangle> triangles;
};

/// A named point on the skin and its partner on the bone.
struct Landmark {
  std::string name;
  Vec3f skin = Vec3f::Zero();
  Vec3f bone = Vec3f::Zero();
  float depth = 0.0F;       ///< metres along the skin normal
  float confidence = 1.0F;  ///< 0..1; 1 when given by hand
};

/// The temporomandibular joint in closed form: motion of the mandible for given jaw channels.
struct JawJoint {
  Vec3f origin = Vec3f::Zero();    ///< middle between the condyle centres
  Vec3f lateral = Vec3f::UnitX();  ///< unit hinge axis, to the subject's left
  Vec3f forward = Vec3f::UnitZ();  ///< unit, along the condylar path's projection
  Vec3f up = Vec3f::UnitY();
  float open_angle = 0.436F;  ///< radians of rotation at jaw_open = 1
  Vec3f open_glide =
      Vec3f(0, -0.006F, 0.008F);  ///< (lateral, up, forward) metres of condylar glide at jaw_open = 1
  float forward_glide = 0.008F;   ///< metres at jaw_forward = 1, along and down the condylar path
  float forward_drop = 0.003F;    ///< metres downward at jaw_forward = 1
  float lateral_angle = 0.14F;    ///< radians about `up` at jaw_lateral = 1 (to the subject's left)
  float lateral_glide = 0.003F;   ///< metres to the subject's left at jaw_lateral = 1
  double travel_time = 0.12;      ///< seconds: shortest, from 0 to 1 of a channel
};

/// An eyeball.
struct Eye {
  Vec3f centre = Vec3f::Zero();
  float radius = 0.0F;          ///< metres; 0 if the head has no eye on this side
  Vec3f gaze = Vec3f::UnitZ();  ///< unit, at rest
};

struct Skull {
  Surface cranium, mandible, teeth_upper, teeth_lower;
  std::vector<Landmark> landmarks;
  JawJoint jaw;
  Eye eye_left, eye_right;
};

/// A ligament between bone and skin through the fascia; it resists only stretch.
struct Ligament {
  std::string name;
  Vec3f bone = Vec3f::Zero();
  Vec3f skin = Vec3f::Zero();
  float stiffness = 0.0F;  ///< newton per metre
};

struct Smas {
  Surface surface;
  std::vector<float> depth_to_skin;    ///< #vertices, metres
  std::vector<float> depth_to_bone;    ///< #vertices, metres; negative where there is no bone
  std::vector<float> skin_attachment;  ///< #vertices, 0 gliding .. 1 firmly attached
  std::vector<float> bone_attachment;  ///< #vertices, 0 gliding .. 1 firmly attached
  std::vector<Ligament> ligaments;
};

/// What an end of a fibre is attached to.
enum class FibreEnd : uint8_t { smas = 0, skin = 1, cranium = 2, mandible = 3 };

/// One muscle or named part of one: fibres as polylines bound to the SMAS.
///
/// Fibre `f` has the points `fibre_offsets[f] .. fibre_offsets[f+1]`. Each point's place is its SMAS
/// triangle's point at `barycentrics` plus `offsets` metres along the triangle's unit normal.
struct Muscle {
  std::string name;                     ///< with side, such as zygomaticus_major_left
  std::string group;                    ///< the group it is a part of, such as orbicularis_oculi_left
  std::string kind;                     ///< strap, sheet, fan, sphincter_ring or compressor
  std::vector<uint32_t> fibre_offsets;  ///< #fibres + 1
  std::vector<Vec3f> points;            ///< #points, rest place
  std::vector<uint32_t> triangles;      ///< #points, SMAS triangle
  std::vector<Vec3f> barycentrics;      ///< #points
  std::vector<float> offsets;           ///< #points, metres
  FibreEnd origin = FibreEnd::cranium;
  FibreEnd insertion = FibreEnd::smas;
  std::vector<Vec3f> origin_region;     ///< closed polygon
  std::vector<Vec3f> insertion_region;  ///< closed polygon
  float strength = 1.0F;                ///< newtons at full activation, shared by the fibres
  float peak_shortening = 0.2F;         ///< share of the rest length at full activation
};

/// Layers of lattice nodes.
enum class Layer : uint8_t { skin = 0, smas = 1, inner = 2 };

/// How a lattice node is held.
enum class NodeKind : uint8_t {
  free = 0,              ///< moves under the energies only
  fixed = 1,             ///< follows the head rigidly: the rim of the simulated region
  fixed_cranium = 2,     ///< on the cranium
  fixed_mandible = 3,    ///< moves with the mandible by its jaw weight (1 on the bone itself)
  gliding_cranium = 4,   ///< slides over the cranium
  gliding_mandible = 5,  ///< slides over the mandible
  mucosa = 6             ///< free inner surface: no bone behind, contact only
};

/// The lattice of one level of detail.
///
/// Nodes form columns of three (skin, SMAS, inner): node `layer * columns + column`. Stiffness is in newton
/// per metre unless a line says otherwise. Constraint lists are in solver order.
struct TissueLevel {
  std::string name;  ///< low, medium or high
  uint32_t columns = 0;
  std::vector<Vec3f> rest;          ///< #nodes = 3 * columns
  std::vector<NodeKind> kinds;      ///< #nodes
  std::vector<float> masses;        ///< #nodes, kilogram
  std::vector<float> jaw_weights;   ///< #nodes, 0 the node's bone is the cranium .. 1 the mandible
  std::vector<Triangle> triangles;  ///< #prisms, columns, counter-clockwise from outside

  /// Springs along layer edges and across layers: pairs of nodes.
  std::vector<std::array<uint32_t, 2>> spring_nodes;
  std::vector<float> spring_stiffness;         ///< up to the limit strain
  std::vector<float> spring_limit_strain;      ///< where the second stiffness begins; infinity: never
  std::vector<float> spring_second_stiffness;  ///< beyond it
  std::vector<uint8_t> spring_one_sided;       ///< 1: resists stretch only

  /// Membranes: the constant-strain triangles of the skin and SMAS layers, two lists of #prisms.
  std::vector<float> skin_membrane, smas_membrane;  ///< Young's modulus times thickness, N/m
  std::vector<float> skin_bending, smas_bending;    ///< #columns each, newton metre (flexural rigidity)
  float poisson_ratio = 0.35F;                      ///< of both membranes

  /// Anisotropic tethers of nodes to the bone or body behind them.
  std::vector<uint32_t> tether_nodes;
  std::vector<Vec3f> tether_normals;
  std::vector<float> tether_normal_stiffness, tether_tangential_stiffness;

  std::vector<float> volume_stiffness;        ///< #prisms, pascal: between skin and SMAS
  std::vector<float> inner_volume_stiffness;  ///< #prisms, pascal: between SMAS and inner layer

  /// Fibres for this level. Fibre `f` has the points `fibre_offsets[f] .. fibre_offsets[f+1]`; each
  /// point is a blend of three nodes, or of a bone where `fibre_anchor` says so.
  std::vector<uint32_t> fibre_muscle;   ///< #fibres, index of the rig's muscle
  std::vector<uint32_t> fibre_channel;  ///< #fibres, index of the actuation channel that contracts it
  std::vector<uint32_t> fibre_offsets;  ///< #fibres + 1
  std::vector<std::array<uint32_t, 3>> fibre_nodes;  ///< #points
  std::vector<Vec3f> fibre_weights;                  ///< #points
  std::vector<Vec3f> fibre_rest;                     ///< #points, rest place
  std::vector<FibreEnd> fibre_anchor;                ///< #points; cranium / mandible: fixed to that bone
  std::vector<float> fibre_taper;     ///< #points, fraction of the tension in the segment to the next point
  std::vector<float> fibre_strength;  ///< #fibres, newton at full activation and rest length
  std::vector<float> fibre_shortest;  ///< #fibres, fraction of the rest length at which the force vanishes

  /// Carriers: nodes that an actuator rotates about an axis (lids about the globe, lips about their roll
  /// axis).
  std::vector<uint32_t> carrier_channel, carrier_node;
  std::vector<Vec3f> carrier_origin, carrier_axis;
  std::vector<float> carrier_angle;    ///< radians at channel value 1
  std::vector<float> carrier_reverse;  ///< radians at channel value -1
  std::vector<float>
      carrier_stiffness;  ///< pulls the node back to its position under the rigid motion of its bones
  std::vector<float> carrier_drive;  ///< force per metre of the carrier's own motion

  /// Pressures: prisms whose inner side a channel presses outward.
  std::vector<uint32_t> pressure_channel, pressure_prism;
  std::vector<float> pressure;  ///< pascal at channel value 1

  /// Eyeballs that lids lie on, and the nodes that may touch them.
  std::vector<Vec3f> globe_centre;
  std::vector<float> globe_radius;
  std::vector<uint32_t> globe_contact_node, globe_contact_globe;  ///< pairs

  /// Signed distance fields of the bones with their teeth, each on a grid in its bone's frame; the values of
  /// all fields are concatenated, x fastest. Distance in metres = (value - 128) * step, negative inside.
  std::vector<uint8_t> contact_field_bone;                       ///< #fields, 0 cranium, 1 mandible
  std::vector<Vec3f> contact_field_origin;                       ///< #fields, place of the first value
  std::vector<float> contact_field_spacing, contact_field_step;  ///< #fields, metres
  std::vector<std::array<uint32_t, 3>> contact_field_size;       ///< #fields, values along x, y, z
  std::vector<uint8_t> contact_field_values;
  std::vector<uint32_t> contact_node, contact_field;  ///< pairs that may touch

  /// Self-contact of skin: lips and lids. Outer faces of prisms of side 2k are in contact only with those of
  /// side 2k + 1.
  std::vector<uint32_t> facing_prism;
  std::vector<uint8_t> facing_side;  ///< 0 upper, 1 lower lip; 2, 3 upper, lower lid left; 4, 5 right
};

/// How the vertices of one primitive of the user's file follow the lattice, the jaw or an eye.
///
/// Vertex displacement = sum of `weights` times the displacement of `nodes`, plus `jaw_weights` times the
/// jaw's displacement of the vertex; vertices of an eye rotate with it instead.
struct Binding {
  uint32_t mesh = 0, primitive = 0;  ///< in the glTF file
  std::string part;                  ///< skin, eye_left, teeth_lower, ...
  uint32_t vertex_count = 0;
  uint64_t position_hash = 0;        ///< fingerprint of the primitive's POSITION bytes
  Mat4f to_rig = Mat4f::Identity();  ///< from the primitive's own coordinates to the rig's metres
  uint32_t influences = 4;           ///< nodes per vertex
  std::vector<uint32_t> nodes;       ///< #vertices * influences
  std::vector<float> weights;        ///< #vertices * influences
  std::vector<float> jaw_weights;    ///< #vertices
  std::vector<uint8_t> eye;          ///< #vertices: 0 none, 1 left, 2 right
};

/// Where a point may lie to be in contact with a facing lip or lid, metres.
struct FacingRange {
  double before = 0.0;  ///< in front of the surface
  double behind = 0.0;  ///< behind it; deeper points belong to another surface
  double beside = 0.0;  ///< beside it
};

/// Constants of damping, activation and contact, the same for the whole tissue and all its levels. In double
/// precision, so that they are used exactly as in the anatomy's data.
struct TissueMechanics {
  double stiffness_damping = 0.0;  ///< seconds: damping force per stiffness force and unit of rate
  double mass_damping = 0.0;       ///< per second

  double activation_rise = 0.0, activation_decay = 0.0;  ///< seconds: time constants
  double initial_force_slope = 0.0;  ///< of a muscle's force, relative to maximal, over activation at 0

  double globe_stiffness = 0.0;    ///< newton per metre a node: of contact with an eyeball
  double bone_stiffness = 0.0;     ///< the same with bone and teeth
  double facing_stiffness = 0.0;   ///< the same between lips and between lids
  double contact_thickness = 0.0;  ///< metres: margin between skin and bone, lip and lip
  double lid_thickness = 0.0;      ///< metres: margin between the lids; negative: they overlap
  double friction = 0.0;           ///< Coulomb's coefficient
  double sticky_reach = 0.0;       ///< metres: gap at which sticky lips part
  double sticky_stiffness = 0.0;   ///< newton per metre a node: of their adhesion
  FacingRange lip_range, lid_range;
};

/// All levels of detail with their bindings.
struct Tissue {
  /// Absent in rigs of releases that kept these constants in the solver.
  std::optional<TissueMechanics> mechanics;
  std::vector<TissueLevel> levels;
  std::vector<std::vector<Binding>> bindings;  ///< one list per level
};

/// One writable value of the face.
struct Channel {
  std::string name;
  std::string group;  ///< muscle, jaw, eye, lid, lip or pressure
  float minimum = 0.0F, maximum = 1.0F, rest = 0.0F;
  int32_t muscle = -1;  ///< index of the muscle it contracts, or -1
  std::string unit;     ///< "1", "rad"
};

/// A named vocabulary (arkit, au, viseme, vrm) as a sparse matrix onto the channels, with the response curves
/// of its members: without knots, linear.
struct NamedSet {
  std::string name;
  std::vector<std::string> members;
  std::vector<uint32_t> member_indices;   ///< #entries
  std::vector<uint32_t> channel_indices;  ///< #entries
  std::vector<float> weights;             ///< #entries
  std::vector<float> response_weights;    ///< #knots: weights of members, rising between 0 and 1
  std::vector<float> responses;  ///< #members * #knots: share of a member's row that each weight plays
};

struct Actuation {
  std::vector<Channel> channels;
  std::vector<NamedSet> sets;
};

/// A whole rig: the anatomy, the lattice and the channels that drive it.
struct Rig {
  Skull skull;
  Smas smas;
  std::vector<Muscle> muscles;
  Tissue tissue;
  Actuation actuation;
  Mat4f input_to_metres = Mat4f::Identity();  ///< from the user's axes and units to the rig's
};

}  // namespace fascia::rig
