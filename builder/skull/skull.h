#pragma once

// Fitting a generic skull under the skin of a given head.
//
// This work is based on:
// O. Aina. Generating Anatomical Substructures for Physically-Based Facial Animation, ch. 6. 2011
// K. Mardia, J. Kent, C. Goodall, J. Little. Kriging and splines with derivative information. 1996
// C. Stephan, E. Simpson. Facial soft tissue depths in craniofacial identification, part I. 2008

#include <map>
#include <string>
#include <vector>

#include "anatomy/mechanics.h"
#include "builder/skull/exterior.h"
#include "builder/splines/warp.h"
#include "geometry/mesh.h"

namespace fascia::skull {

/// A landmark of the generic head: where it is on skin and on bone, and how deep bone lies there in people.
struct GenericLandmark {
  std::string name;
  Vec3 skin = Vec3::Zero();  ///< m
  Vec3 bone = Vec3::Zero();  ///< m
  bool has_bone = true;      ///< false: a skin landmark only; it steers the skin side of the map
  double depth = 0;          ///< mean soft-tissue depth, m
  double depth_sd = 0.003;   ///< its standard deviation between people, m
};

/// A line along the bone, such as the rim of the orbit.
struct BoneCurve {
  std::string name;
  bool closed = false;
  std::vector<Vec3> points;  ///< m, in order
};

/// The generic skull. All meshes in metres in one frame; `skin` may be empty.
struct Generic {
  TriangleMesh cranium, mandible, teeth_upper, teeth_lower;
  TriangleMesh skin;  ///< generic head; gives the depth everywhere when present
  std::vector<GenericLandmark> landmarks;
  std::vector<BoneCurve> curves;     ///< semilandmarks slide along them
  Vec3 condyle_left = Vec3::Zero();  ///< centres of the condyles, on the hinge axis
  Vec3 condyle_right = Vec3::Zero();
  anatomy::mechanics::JawMotion jaw;  ///< how far the mandible moves
};

/// A landmark found or given on the head to fit.
struct TargetLandmark {
  Vec3 skin = Vec3::Zero();  ///< m
  double confidence = 1;     ///< in (0, 1]
};

struct FitOptions {
  double tissue_scale = 1;                    ///< sigma: scales every depth; children and stylised heads
  std::map<std::string, double> depth_scale;  ///< k: scales the depth of single landmarks
  double smoothing = 1000;         ///< 1/m: inverse variance of bone displacement per metre; 0 interpolates
  int normal_passes = 8;           ///< times the depth directions are re-estimated on the fitted bone
  double normal_tolerance = 5e-5;  ///< no more passes once no bone target moves farther than this, m
  double skin_normal_share = 0.5;  ///< depth direction: 0 that of the generic, 1 the skin's normal
  double exponent = 1;  ///< of the spline's kernel: 1 the thin plate; 3 is smoother, and what normals need
  double normal_deviation = 0;   ///< radians by which bone turns less or more than skin; > 0 takes the skin's
                                 ///< normals at landmarks as derivative data (exponent > 2)
  double curve_spacing = 0.012;  ///< of semilandmarks along the curves, m; 0 leaves the curves out
  double clearance_share = 0.6;  ///< bone stays this share of the local depth under the skin...
  double clearance_floor = 0.002;             ///< ...and at least this, m (scaled down with tissue_scale < 1)
  const TriangleMesh* teeth_upper = nullptr;  ///< teeth that the head already has, m
  const TriangleMesh* teeth_lower = nullptr;
  double teeth_deviation = 0.0005;  ///< of the bone from those teeth, m; above 0.001 they bend the jaws
                                    ///< towards them instead of replacing the generic ones
  bool trim_uncovered = true;       ///< leave out what would lie under skin that the head does not have
};

struct FittedLandmark {
  std::string name;
  Vec3 skin = Vec3::Zero();       ///< on the head
  Vec3 bone = Vec3::Zero();       ///< on the fitted skull
  Vec3 target = Vec3::Zero();     ///< where the depth table puts the bone
  Vec3 direction = Vec3::Zero();  ///< unit, bone to skin
  double depth = 0;               ///< from fitted bone to skin landmark, m
  double table_depth = 0;         ///< scaled depth of the table, m
  double table_deviation = 0;     ///< its standard deviation between people, m
  double residual = 0;            ///< |bone - target|, m
  double confidence = 1;
};

/// How the mandible moves: a hinge through the condyles, and a glide along the articular eminence.
struct JawFrame {
  Vec3 condyle_left = Vec3::Zero(), condyle_right = Vec3::Zero();  ///< m
  Vec3 origin = Vec3::Zero();                                      ///< midway between the condyles
  Vec3 hinge = Vec3::UnitX();    ///< unit axis to the subject's left; positive turns open the jaw
  Vec3 forward = Vec3::UnitZ();  ///< unit, along the occlusal plane
  anatomy::mechanics::JawMotion
      motion;  ///< at full value of the jaw's channels, lengths as this head is large
};

/// The map from the generic's bone to the fitted bone: a smoothed thin-plate warp, replaced by one
/// similarity around the teeth and one around each joint so that what fits together keeps its shape.
class BoneMap {
 public:
  struct Patch {
    std::vector<Vec3> anchors;    ///< generic points that move by the similarity
    double inner = 0, outer = 0;  ///< full strength within `inner` of an anchor, none beyond `outer`, m
    Mat4 similarity = Mat4::Identity();
    bool fixed = false;                          ///< by teeth that the head shows; else it follows the warp
    double strength(const Vec3& generic) const;  ///< 1 near the anchors, 0 far off, smooth between
  };
  BoneMap() = default;
  BoneMap(splines::Warp warp, std::vector<Patch> patches);
  Vec3 operator()(const Vec3& generic) const;
  std::vector<Vec3> operator()(std::span<const Vec3> generic) const;
  std::vector<Patch>& patches() { return patches_; }
  const std::vector<Patch>& patches() const { return patches_; }
  const splines::Warp& warp() const { return warp_; }

 private:
  Vec3 blend(const Vec3& generic, const Vec3& warped) const;
  splines::Warp warp_;
  std::vector<Patch> patches_;
};

struct FitResult {
  TriangleMesh cranium, mandible, teeth_upper, teeth_lower;  ///< m; the generic's triangles, or part of them
  std::vector<FittedLandmark> landmarks;
  BoneMap bone_map;    ///< generic bone -> this bone, before the last clearance correction
  splines::Warp warp;  ///< generic head (skin and bone) -> this head: carries regions and curves
  Mat4 similarity = Mat4::Identity();  ///< generic -> head, Procrustes
  JawFrame jaw;
  double landmark_rms = 0;        ///< of the residuals weighted by confidence, m
  double landmark_max = 0;        ///< largest residual of a landmark with confidence 0.5 or more, m
  int bone_outside_skin = 0;      ///< vertices outside the outer skin: 0 unless the head makes it impossible
  int bone_within_clearance = 0;  ///< vertices nearer to the skin than their clearance
  int corrected_vertices = 0;     ///< moved by the last correction
  double corrected_max = 0;       ///< m
  int curve_points = 0, curve_points_used = 0;  ///< semilandmarks, and those with skin over them
  double uncovered_share = 0;  ///< of the skull's triangles, under skin that the head does not have
  std::vector<std::string> warnings;
};

/// Fits `generic` under `skin` (prepared once, see exterior.h). Landmarks are matched by name; unknown names
/// are ignored with a warning. Throws Error when fewer than four bone landmarks match, when they are coplanar
/// beyond use, or when an option is out of range.
///
/// Steps: Procrustes similarity; bone targets = skin point - sigma k depth along the depth direction;
/// semilandmarks slid along the curves; smoothed thin-plate warp with the table's SD; directions
/// re-estimated; similarity patches at teeth and joints; bone brought inside the skin, first by added
/// constraints, then vertex by vertex; bone left out that would lie under skin the head does not have. See
/// docs/skull.md.
FitResult fit(const Generic& generic, const Exterior& skin,
              const std::map<std::string, TargetLandmark>& landmarks, const FitOptions& options = {});

/// Same on a bare mesh in metres.
FitResult fit(const Generic& generic, const TriangleMesh& skin,
              const std::map<std::string, TargetLandmark>& landmarks, const FitOptions& options = {});

}  // namespace fascia::skull
