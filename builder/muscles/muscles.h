#pragma once

#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "anatomy/anatomy.h"
#include "builder/spatial/surface_query.h"
#include "builder/splines/warp.h"
#include "geometry/landmarks.h"
#include "geometry/mesh.h"

namespace fascia::muscles {

/// A point of a fibre, and its binding to the SMAS.
struct FibrePoint {
  Vec3 position = Vec3::Zero();  ///< metres
  /// Nearest place of the SMAS, and the height over it along the SMAS' smooth normal (negative: deeper),
  /// metres. `position` is that place moved by `offset`, except where `bound` is false: at bones, in the
  /// opening of an orifice and for muscles that run far from the SMAS it is only the nearest place.
  SurfacePoint smas;
  double offset = 0.0;
  bool bound = true;
};

struct Fibre {
  std::vector<FibrePoint> points;  ///< from origin to insertion, evenly spaced
  double rest_length = 0.0;        ///< metres
  int bundle = 0;                  ///< sub-bundle it belongs to, from 0
};

/// A muscle of this head.
struct Muscle {
  std::string name, whole, title, group, layer;  ///< as in anatomy::Muscle
  anatomy::Side side = anatomy::Side::midline;
  anatomy::MuscleKind kind = anatomy::MuscleKind::strap;
  anatomy::Attachment origin_on = anatomy::Attachment::smas, insertion_on = anatomy::Attachment::smas;
  std::vector<Vec3> origin, insertion;  ///< the regions carried to this head, metres; empty for rings
  std::vector<Fibre> fibres;            ///< in order; no two of them cross
  int bundles = 1;
  double peak_shortening = 0.0;
  double strength = 0.0;       ///< force at full activation, newton, all fibres together
  double cross_section = 0.0;  ///< square metres
  double mean_length = 0.0, shortest = 0.0, longest = 0.0;  ///< of the fibres, metres
  double area = 0.0;                                        ///< of the sheet the fibres span, square metres
  double volume = 0.0;                                      ///< cross-section times mean length, cubic metres
  double thickness = 0.0;                                   ///< volume over area, metres; 0 without an area
  /// Largest distance of a fibre end from its surface of attachment (bone, skin, or the SMAS, which contains
  /// the modiolus), metres; 0 if that is not a surface of this head (hyoid, fascia, galea, tarsus).
  double origin_distance = 0.0, insertion_distance = 0.0;
  int crossings = 0;  ///< places where two of its fibres cross; see crossings()
};

/// Surfaces and landmarks that muscles are placed on. Meshes and landmarks in metres, in this head's frame:
/// face along +Z, +Y up.
struct Inputs {
  const TriangleMesh* smas = nullptr;
  const spatial::SurfaceQuery* skin = nullptr;
  const spatial::SurfaceQuery* cranium = nullptr;   ///< may be null: bone ends then hang at their depth
  const spatial::SurfaceQuery* mandible = nullptr;  ///< likewise
  const spatial::SurfaceQuery* teeth = nullptr;     ///< may be null; the lips' depth ends on them
  const splines::Warp* warp = nullptr;              ///< generic anatomy -> this head; null: they are the same
  /// Landmarks on this head's skin. Rings need cheilion of both sides, stomion and, for each eye,
  /// exocanthion, endocanthion, palpebrale_superius and palpebrale_inferius.
  Landmarks landmarks;
  std::span<const anatomy::Muscle> muscles;
  anatomy::mechanics::Muscles constants;  ///< of the anatomy
};

/// A region drawn on this head that replaces the generic one.
struct Sketch {
  std::vector<Vec3> points;  ///< metres, on the head: its skin, its SMAS or its bones
  bool is_curve = false;     ///< its boundary in order; otherwise points anywhere in it
};

/// The user's changes to one muscle.
struct Edit {
  double strength = 1.0;  ///< times the generic strength
  double width = 1.0;     ///< times the width of both regions across the course, or of a ring's band
  Vec3 insertion_offset = Vec3::Zero();  ///< moves the insertion, metres
  std::optional<double> peak_shortening;
  std::optional<int> bundles;
  std::optional<double> spacing;  ///< between fibres, metres
  std::optional<Sketch> origin, insertion;
  std::optional<std::vector<Vec3>> waypoints;  ///< metres, on this head; empty: the straight course
};

struct Options {
  double spacing = 0.002;  ///< between fibres, metres on an adult face
  /// Fibres a muscle has at least and, at the spacing above, at most; a denser spacing allows as many more.
  int fewest_fibres = 3, most_fibres = 9;
  double point_spacing = 0.004;  ///< between the points of a fibre, metres
  int fewest_points = 5, most_points = 25;
  /// Where in a region a fibre ends: 0 at the side that faces the other region, 1 at the far side.
  double region_share = 0.5;
  double least_prevalence = 0.0;      ///< leave out muscles that fewer people have
  std::vector<std::string> absent;    ///< names or wholes to leave out
  std::map<std::string, Edit> edits;  ///< by name
};

/// The node lateral to a corner of the mouth in which muscles are interwoven and mechanically coupled.
struct Modiolus {
  std::string name;  ///< modiolus_left or modiolus_right
  anatomy::Side side = anatomy::Side::left;
  Vec3 centre = Vec3::Zero();        ///< metres, on the SMAS
  double radius = 0.0;               ///< farthest end of a fibre from the centre along the SMAS, metres
  std::vector<std::string> muscles;  ///< that end in it, in the order of the input
};

struct Result {
  std::vector<Muscle> muscles;  ///< in the order of the input
  std::vector<Modiolus> modioli;
  std::vector<std::string> warnings;
};

/// Places every muscle of `inputs.muscles` on this head (Aina 2011, section 7.2): its regions are mapped by
/// the warp, their geodesic hulls on the SMAS joined by common tangents, and fibres constructed between the
/// facing arcs as boundary-value geodesics, each point at its depth between skin and bone. Sphincters are
/// rings at constant distance from the orifice, compressors run across them. Muscles that lie deep or away
/// from the SMAS (chewing, tongue base, orbit), or are obstructed by an opening of it (depressor septi), run
/// from region to region through their waypoints. Crossing fibres of one muscle are reordered. A muscle that
/// cannot be placed on this head is omitted and named in `Result::warnings`, with the reason. Throws `Error`
/// naming the muscle when inputs are missing, an edit names no muscle, or a region of an edited muscle is
/// invalid: a sketch with fewer than three points, off the head, of no extent, or whose curve crosses itself.
Result build(const Inputs& inputs, const Options& options = {});

/// Throws `Error` beginning with `what` when `sketch`, in metres, is no region on any head: too few points,
/// no extent, or a curve that crosses itself.
void check_sketch(const Sketch& sketch, const std::string& what);

/// Sets lengths, area, volume and thickness of `muscle` from its fibres.
void measure(Muscle& muscle);

/// How many times two fibres of one muscle cross, seen along the SMAS' normals, or, where none of their
/// points is bound to the SMAS, along the normal of the sheet they span. Ends that touch do not count. Each
/// fibre is held against the four that follow it, as fibres lie side by side in their order.
int crossings(const std::vector<Fibre>& fibres, const spatial::SurfaceQuery& smas);

}  // namespace fascia::muscles
