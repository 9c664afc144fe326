#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "anatomy/anatomy.h"
#include "builder/openings/openings.h"
#include "builder/prepare/prepare.h"
#include "builder/rigging/edits.h"
#include "builder/smas/smas.h"
#include "formats/landmark_file.h"
#include "formats/scene.h"
#include "geometry/for_each.h"
#include "rig/model/rig.h"

/// The complete build of a rig from a head mesh, stage by stage.
namespace fascia::rigging {

struct BuildOptions {
  prepare::PrepareOptions prepare;
  openings::OpeningOptions openings;  ///< whether closed lips and lids are parted, which parts are added
  double tissue_scale = 1.0;          ///< scales every tissue depth: children, stylised heads
  smas::Options smas;                 ///< how far it reaches, how fine it is
  std::string detail = "medium";      ///< finest level of the lattice: low, medium or high
  Edits edits;                        ///< the user's changes to landmarks and muscles
  /// Called as each stage begins, with its name; may be empty.
  std::function<void(const std::string& stage)> progress;
  /// How independent parts of a stage are run; empty: one after the other. The rig is the same.
  ForEach for_each;
};

struct StageTime {
  std::string name;
  double seconds = 0.0;
};

/// Figures of a build, as `fascia build --json` prints them. Lengths in millimetres.
struct BuildReport {
  std::vector<std::string>
      corrected;  ///< files of the anatomy that are not as built in; the caller's to fill
  std::string units;
  Mat4 input_to_metres = Mat4::Identity();
  struct PartFigures {
    std::string mesh, part;  ///< name in the file; what it, or some connected piece of it, was taken for
    int vertices = 0;
  };
  std::vector<PartFigures> parts;                       ///< in the file's order of meshes
  std::optional<prepare::Eyeball> eye_left, eye_right;  ///< metres, rig frame
  std::vector<openings::Parted> parted;                 ///< closed lips and lids that were opened
  std::vector<std::string> added;                       ///< parts of the generic head given to this one
  int appended_vertices = 0;  ///< of the input's own meshes, behind those that were there
  std::vector<StageTime> stages;
  int landmarks_given = 0, landmarks_found = 0;
  std::vector<std::string> low_confidence;
  struct LandmarkFigures {
    std::string name;
    bool given = false, required = false;
    double confidence = 0.0;
    bool has_bone = false;  ///< else the figures below are 0
    double depth_mm = 0.0, table_mm = 0.0,
           deviation_mm = 0.0;  ///< fitted; by the table, scaled; between people
    double residual_mm = 0.0;   ///< from the fitted bone to where the table puts it
  };
  std::vector<LandmarkFigures> landmarks;  ///< by name
  double landmark_rms_mm = 0.0, landmark_max_mm = 0.0;
  int bone_outside_skin = 0, bone_corrected = 0;
  double bone_corrected_max_mm = 0.0;
  int curve_points = 0, curve_points_used = 0;
  double skull_uncovered_share =
      0.0;  ///< of the skull, left out because the head does not have the skin over it
  int smas_vertices = 0, smas_triangles = 0, smas_outside_layers = 0;
  double smas_min_angle_deg = 0.0;
  struct MuscleFigures {
    std::string name, whole;  ///< the muscle, and what it is a part of (its own name when it has no parts)
    int fibres = 0, crossings = 0;
    double length_mm = 0.0, shortest_mm = 0.0, longest_mm = 0.0;  ///< mean of the fibres, and the extremes
    double area_mm2 = 0.0, thickness_mm = 0.0, volume_mm3 = 0.0, strength_n = 0.0;
    double origin_distance_mm = 0.0,
           insertion_distance_mm = 0.0;  ///< farthest fibre end from what it is fastened to
  };
  std::vector<MuscleFigures> muscles;
  struct ModiolusFigures {
    std::string name;
    Vec3 centre = Vec3::Zero();  ///< metres, rig frame
    double radius_mm = 0.0;
    std::vector<std::string> muscles;
  };
  std::vector<ModiolusFigures> modioli;
  /// Muscles that the edits change, add or leave out, and how many landmarks they give.
  struct EditFigures {
    int landmarks = 0;
    std::vector<std::string> changed, added, absent;
  };
  EditFigures edits;
  struct LevelFigures {
    std::string name;
    int nodes = 0, springs = 0;
  };
  std::vector<LevelFigures> tissue;
  std::vector<std::string> warnings;
};

struct BuildResult {
  rig::Rig rig;
  /// The file that the rig belongs to, where it is no longer the one that came: lips or lids were parted, or
  /// parts added.
  std::optional<formats::Scene> opened;
  BuildReport report;
};

/// Builds the rig of `scene`.
///
/// `landmarks` are the given ones (see formats/landmark_file.h), none as a rule: the rest is found, or, where
/// all that `anatomy` marks as required are given, carried over through them. Throws fascia::Error naming the
/// stage's part at fault and the remedy.
BuildResult build_rig(const formats::Scene& scene, const formats::LandmarkFile& landmarks,
                      const anatomy::GenericAnatomy& anatomy, const BuildOptions& options = {});

}  // namespace fascia::rigging
