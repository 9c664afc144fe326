#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "anatomy/anatomy.h"
#include "builder/muscles/muscles.h"
#include "formats/landmark_file.h"
#include "geometry/landmarks.h"

/// The user's edits, stored in a file of their own that applies to every rebuild of the head.
namespace fascia::rigging {

/// Changes to one muscle, to a whole with all its parts, or to both sides of it. Points in the head file's
/// axes.
struct MuscleEdit {
  std::optional<bool> is_present;
  std::optional<std::string> variant;
  std::optional<double> strength, width, peak_shortening;  ///< factors, and a share of the length
  std::optional<int> bundles;
  std::optional<double> fibre_spacing;  ///< metres
  std::optional<Vec3> insertion_offset;
  std::optional<muscles::Sketch> origin, insertion;
  std::optional<std::vector<Vec3>> waypoints;
};

struct Edits {
  std::string file;  ///< for messages; empty when there is none
  /// Of all points: m, cm, mm, or metres a unit as a number; empty: as in the head file.
  std::string units;
  Landmarks landmarks;  ///< points on the skin; they go before those of a landmark file
  double fibre_spacing = muscles::Options().spacing;  ///< metres
  double least_prevalence = 0.0;  ///< leave out muscles that fewer people have, share 0..1
  std::map<std::string, MuscleEdit> muscles;
  /// Muscles drawn on this head, their regions and waypoints in the head file's axes as `muscles` has them
  /// again.
  std::vector<anatomy::Muscle> new_muscles;
  std::vector<std::filesystem::path>
      muscle_files;  ///< more muscles, drawn on the generic head: see anatomy::add_muscles
};

/// Reads an edits file; docs/muscles.md describes it and schema/edits.schema.json its form.
///
/// Throws fascia::Error naming the file, the entry and the remedy when it is missing, not JSON, has an entry
/// that is not known, or a value of the wrong kind or out of range.
Edits read_edits(const std::filesystem::path& path);

/// The length of one unit of points in `units` (of Edits) in units of the head file.
double unit_ratio(const std::string& units, const Mat4& input_to_metres);

/// Sets the variant of a muscle, as `--variant MUSCLE=VARIANT` gives it.
void set_variant(Edits& edits, const std::string& assignment);

/// The anatomy with the muscles that `edits` add. Throws fascia::Error when a name is taken.
anatomy::GenericAnatomy with_new_muscles(const anatomy::GenericAnatomy& anatomy, const Edits& edits);

/// What `edits` ask of the muscle stage. `anatomy` has the new muscles already; `input_to_metres` is the
/// head's. Throws fascia::Error when a name is not known, saying which one is near, or stands for several
/// muscles where one is needed.
muscles::Options muscle_options(const Edits& edits, const anatomy::GenericAnatomy& anatomy,
                                const Mat4& input_to_metres);

}  // namespace fascia::rigging
