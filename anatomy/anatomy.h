#pragma once

#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "anatomy/mechanics.h"
#include "anatomy/side.h"
#include "geometry/mesh.h"

/// The generic anatomy of the human face: named points, tissue depths, muscles, layers, channels, expression
/// tables, and a generic head and skull. The data are files that a specialist can read and correct
/// (anatomy/data); this is their reader. Everything here is in metres and radians, right-handed, +X to the
/// subject's left, +Y up, the face looking along +Z; the files are in millimetres and degrees.
namespace fascia::anatomy {

/// A named point of the face or the skull.
struct Landmark {
  std::string name;          ///< with its side, such as zygion_left
  std::string abbreviation;  ///< such as zy
  std::string definition;
  Side side = Side::midline;
  bool craniometric = false;   ///< defined on bone; else cephalometric, defined on skin
  bool required = false;       ///< one of the few landmarks that detection needs
  std::optional<Vec3> skin;    ///< on the generic head's skin
  Vec3 normal = Vec3::Zero();  ///< unit outward skin normal; zero without a skin point
  Vec3 tangent =
      Vec3::Zero();  ///< unit, horizontal within the skin, away from the midplane (left on it); zero likewise
  std::optional<Vec3> bone;         ///< on the generic skull
  Vec3 bone_normal = Vec3::Zero();  ///< unit outward normal of the bone; zero without a bone point
  bool bone_from_depth = false;     ///< bone = skin - depth * normal; else measured on a skull
  std::string depth;                ///< its key in the tissue depth tables; empty if there is none
};

/// A named curve of the face or the skull, as points in order along it.
struct Curve {
  std::string name;
  std::string definition;
  Side side = Side::midline;
  std::string on;  ///< skin, cranium or mandible
  bool closed = false;
  std::vector<Vec3> points;
};

/// Thickness of the soft tissue over one landmark.
struct TissueDepth {
  std::string key;         ///< bone landmark abbreviation, the `depth` of a Landmark
  double mean = 0.0;       ///< metres
  double deviation = 0.0;  ///< standard deviation, metres; 0 if the source gives none
};

struct TissueDepthTable {
  std::string name;
  std::string population;          ///< the population it was measured on
  std::string sex, age, ancestry;  ///< the same as keywords, such as female, adult; empty: not distinguished
  std::string source;
  std::vector<TissueDepth> depths;

  /// The depth with this key, or null.
  const TissueDepth* find(std::string_view key) const;
};

/// One object of the generic head or skull.
struct MeshObject {
  std::string name;  ///< as in the file: skin, eye_left, cranium, mandible, teeth_upper, ...
  TriangleMesh mesh;
  std::vector<std::array<Vec2, 3>> corner_uvs;  ///< #triangles, or empty when the file has no UVs
};

/// A named part of the generic head's skin: polygons of the object `skin` in head.obj, counted from 0.
struct SkinRegion {
  std::string name;  ///< lip_upper, mouth_lining, nostril_left, ...
  size_t first = 0, count = 0;
};

/// What one end of a muscle is attached to.
enum class Attachment { cranium, mandible, hyoid, galea, smas, skin, modiolus, tarsus, fascia };

/// A patch in which fibres begin or end: its corners in cyclic order, near the named surface.
struct Region {
  Attachment on = Attachment::smas;
  std::vector<Vec3> polygon;
};

/// A band around an orifice, for muscles that run around it. Distances are along the skin from the
/// line where the lips (lids) meet, not from the mesh's edge loop. Angles are seen from the front
/// about the orifice's centre: 0 to the subject's left, pi/2 upward.
struct OrificeBand {
  std::string orifice;                        ///< mouth, eye_left or eye_right
  double inner = 0.0, outer = 0.0;            ///< metres
  double begin_angle = 0.0, end_angle = 0.0;  ///< radians, begin < end
  bool medial_on_bone =
      false;  ///< the ring's medial end is attached to the canthal ligament and the bone behind it
  bool upper() const { return begin_angle + end_angle > 0.0; }
};

enum class MuscleKind { strap, sheet, fan, sphincter_ring, compressor };

/// An anatomical variant of a muscle.
struct Variant {
  std::string name;         ///< absent, bifid, ...
  double prevalence = 0.0;  ///< share of faces, 0..1
  std::string note;
  bool is_absent = false;                ///< the muscle is missing
  double width = 1.0;                    ///< factor of the usual width
  Vec3 insertion_offset = Vec3::Zero();  ///< from the usual insertion, metres on the generic head
};

/// A muscle, or the part of one that has a channel of its own.
struct Muscle {
  std::string name;   ///< with its side, such as frontalis_medial_left
  std::string whole;  ///< the muscle it is a part of, with its side; its own name if it has no parts
  std::string title;  ///< display name
  std::string group;  ///< mimic, masticatory or lid
  Side side = Side::midline;
  MuscleKind kind = MuscleKind::strap;
  Region origin, insertion;         ///< polygons empty for rings and compressors
  std::vector<Vec3> waypoints;      ///< the central fibre passes through these, in order from the origin
  std::optional<OrificeBand> band;  ///< of sphincter rings and compressors
  /// Depth along the course, evenly spaced from origin to insertion: 0 at the skin .. 1 at the bone.
  std::vector<double> depth_fraction;
  std::string layer;             ///< F1 (superficial) .. F4 (Freilinger 1987), galea, deep, orbit
  double peak_shortening = 0.2;  ///< share of the rest length at full activation
  /// Physiological cross-section, square metres. Times a muscle stress of about 0.3 MPa it is the force.
  double cross_section = 0.0;
  int bundles = 1;          ///< sub-bundles side by side that the fibres should make
  double prevalence = 1.0;  ///< share of faces that have it
  std::vector<Variant> variants;
  std::vector<int> action_units;  ///< FACS units it is a part of; negative: relaxes in that unit
  std::string source;
};

/// A labelled area of the skin: a polygon on the generic head's skin, corners in cyclic order.
struct Zone {
  std::string name;  ///< with its side
  Side side = Side::midline;
  std::vector<Vec3> polygon;
  double value = 0.0;    ///< meaning and unit: see the list it is in
  double falloff = 0.0;  ///< metres over which the value fades outside the polygon
  std::string note;
};

/// A band of ligament from bone or deep fascia through the SMAS to the skin. `bone` and `skin` are the
/// two ends of the same fibres, point by point along the ligament.
struct RetainingLigament {
  std::string name;
  Side side = Side::midline;
  std::string type;  ///< osteocutaneous, fascial or septum
  std::string from;  ///< cranium, mandible or deep fascia
  std::vector<Vec3> bone, skin;
  double stiffness = 0.0;  ///< newton per metre, of the whole ligament
  std::string source;
};

/// Depth of the SMAS near one landmark (or near both of a pair).
struct SmasDepth {
  std::string landmark;     ///< without side for a pair: "malare" stands for malare_left and malare_right
  double fraction = 0.0;    ///< of the way from the skin to the bone
  double free_depth = 0.0;  ///< metres under the skin of an adult where no bone limits it, or bone is far
};

struct Tissue {
  double skin_attachment = 0.0;        ///< where no zone says otherwise
  double glide = 0.0;                  ///< where no zone says otherwise, metres
  std::vector<SmasDepth> smas_depths;  ///< interpolated between the landmarks
  std::vector<Zone> skin_attachments;  ///< value: SMAS to skin, 0 gliding .. 1 firm
  std::vector<Zone> gliding_planes;    ///< value: free travel of the SMAS over bone, metres
  std::vector<RetainingLigament> ligaments;
};

/// One writable value of the face: a muscle part's activation, or a motion that is not a muscle's.
struct Actuator {
  std::string name;
  std::string group;  ///< muscle, jaw, eye, lid, lip or pressure
  double minimum = 0.0, maximum = 1.0, rest = 0.0;
  std::string unit;        ///< "1" or "rad"
  std::string note;        ///< what the positive direction is
  bool is_muscle = false;  ///< then a Muscle has the same name
};

/// A name that stands for several actuators at once, such as orbicularis_oculi_left.
struct Whole {
  std::string name;
  std::vector<std::string> members;  ///< actuator names
};

/// One name of a vocabulary as a linear combination of actuators.
struct Expression {
  std::string name;
  std::string corrects;  ///< the expression it is added to if it is a corrective; else empty
  std::string note;
  std::vector<std::pair<std::string, double>> weights;  ///< actuator name and weight; negative relaxes
  std::vector<double> response;  ///< share of the row at each of the set's response_weights; none: the weight
};

struct ExpressionSet {
  std::string name;  ///< arkit, au, viseme, vrm, smile
  std::string title;
  std::string source;
  std::vector<double> response_weights;  ///< rising between 0 and 1
  std::vector<Expression> expressions;

  /// The expression of this name, or null.
  const Expression* find(std::string_view expression) const;
};

struct GenericAnatomy {
  std::vector<Landmark> landmarks;
  std::vector<Curve> curves;
  std::vector<TissueDepthTable> depth_tables;  ///< the first is the default
  std::vector<MeshObject> head;                ///< skin, eyes, ... of the generic head
  std::string head_source;                     ///< the text of head.obj, with untriangulated polygons
  std::vector<SkinRegion> skin_regions;        ///< of the generic head
  std::vector<MeshObject> skull;               ///< cranium, mandible, teeth
  std::vector<Muscle> muscles;                 ///< both sides
  Tissue tissue;
  Mechanics mechanics;
  std::vector<Actuator> actuators;
  std::vector<Whole> wholes;
  std::vector<ExpressionSet> expression_sets;

  /// Each returns the entry of that name, or null.
  const Landmark* landmark(std::string_view name) const;
  const Curve* curve(std::string_view name) const;
  const TissueDepthTable* depth_table(std::string_view name) const;
  const MeshObject* head_object(std::string_view name) const;
  const MeshObject* skull_object(std::string_view name) const;
  const Muscle* muscle(std::string_view name) const;
  const Actuator* actuator(std::string_view name) const;
  const Whole* whole(std::string_view name) const;
  const ExpressionSet* expression_set(std::string_view name) const;
};

/// The anatomy compiled into the library; reads no file.
GenericAnatomy load_generic();

/// The anatomy in `directory`, with the structure of anatomy/data, for corrected copies. For a missing file
/// the built-in one is used, so that a directory may contain only the corrected files. Throws fascia::Error
/// naming the file, the entry and the remedy if a file is malformed, a reference does not resolve, the
/// directory contains none of the files, or it contains a JSON or OBJ file of another name.
GenericAnatomy load_generic(const std::filesystem::path& directory);

/// Names of the data files of `directory` that differ from the built-in ones.
std::vector<std::string> corrected_files(const std::filesystem::path& directory);

/// Adds the tables of a file of the form of anatomy/data/tissue_depths.json and returns their names. A table
/// replaces an existing one of the same name. Throws fascia::Error naming the file and the entry at fault.
std::vector<std::string> add_depth_tables(GenericAnatomy& anatomy, const std::filesystem::path& file);

/// Adds a muscle with its channel, its name to the members of its group, and a weight of 1 to the action
/// units that it lists (-1 where it relaxes), of both sides and of its own. It replaces an existing muscle of
/// the same name, whose weights stay. Throws fascia::Error if the name belongs to a channel or group of
/// another kind, or an action unit is unknown.
void add_muscle(GenericAnatomy& anatomy, Muscle muscle);

/// Adds the muscles of a file of the form of anatomy/data/muscles.json, drawn on the generic head, as
/// `add_muscle` does. Throws fascia::Error naming the file and the entry at fault.
void add_muscles(GenericAnatomy& anatomy, const std::filesystem::path& file);

/// Names of the data files built in, such as "landmarks.json" or "expressions/arkit.json".
std::vector<std::string> embedded_files();

/// The bytes of a data file built in; throws fascia::Error for a name that is not among them.
std::string_view embedded_file(std::string_view name);

}  // namespace fascia::anatomy
