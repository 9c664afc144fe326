#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace fascia::anatomy {

/// A pose that every rig is asked to play.
struct CheckPose {
  std::string name;
  bool is_quick = false;                                ///< also in the short check that a build ends with
  bool is_symmetric = false;                            ///< both sides do the same
  std::string area;                                     ///< where it shows: eyes, brows, mouth or face
  std::vector<std::pair<std::string, double>> weights;  ///< ARKit coefficients
};

/// What one measure may be, and what to do when it is not.
struct CheckBound {
  std::string row;              ///< such as blink.lid_gap; a row of one side begins with it
  std::string unit;             ///< mm, degrees, share, per_mille, count
  std::string scale;            ///< what `least` and `most` grow with: face, mouth, eye or nothing
  std::optional<double> least;  ///< in `unit`, for an adult
  std::optional<double> most;
  std::string remedy;
  std::string source;
};

/// How far a landmark must go in a pose.
struct CheckMotion {
  std::string pose, landmark;  ///< a landmark of both sides stands without side
  std::string direction;       ///< up, down, out, in, forward, back, away
  CheckBound bound;
};

/// The fixed list of what a rig must show (anatomy/data/checks.json).
struct Checks {
  double adult_face = 0.0, adult_mouth = 0.0, adult_eye = 0.0;  ///< metres, see check::AdultSizes
  std::vector<CheckPose> poses;
  std::vector<CheckMotion> motions;
  std::vector<CheckBound> bounds;

  /// Throws fascia::Error when there is none of that name.
  const CheckBound& bound(const std::string& row) const;
};

/// The list built into the library.
Checks load_checks();

/// The list in `directory`, laid out as anatomy/data. Throws fascia::Error naming file, entry and remedy.
Checks load_checks(const std::filesystem::path& directory);

}  // namespace fascia::anatomy
