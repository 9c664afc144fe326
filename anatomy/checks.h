#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace fascia::anatomy {

/// A pose that every rig is checked in.
struct CheckPose {
  std::string name;
  bool is_quick = false;      ///< also part of the short check at the end of a build
  bool is_symmetric = false;  ///< both sides have the same weights
  std::string area;           ///< the affected area: eyes, brows, mouth or face
  std::vector<std::pair<std::string, double>> weights;  ///< ARKit coefficients
};

/// The bounds of one measurement, and the remedy when it is outside them.
struct CheckBound {
  std::string row;              ///< such as blink.lid_gap; a row of one side begins with it
  std::string unit;             ///< mm, degrees, share, per_mille, count
  std::string scale;            ///< what `least` and `most` scale with: face, mouth, eye or nothing
  std::optional<double> least;  ///< in `unit`, for an adult
  std::optional<double> most;
  std::string remedy;
  std::string source;
};

/// Bounds of a landmark's displacement in a pose.
struct CheckMotion {
  std::string pose, landmark;  ///< the name of a paired landmark is without side
  std::string direction;       ///< up, down, out, in, forward, back, away
  CheckBound bound;
};

/// The list of checks (anatomy/data/checks.json).
struct Checks {
  double adult_face = 0.0, adult_mouth = 0.0, adult_eye = 0.0;  ///< metres, see check::AdultSizes
  std::vector<CheckPose> poses;
  std::vector<CheckMotion> motions;
  std::vector<CheckBound> bounds;

  /// Throws fascia::Error if there is none of that name.
  const CheckBound& bound(const std::string& row) const;
};

/// The list compiled into the library.
Checks load_checks();

/// The list in `directory`, laid out as anatomy/data. Throws fascia::Error naming file, entry and remedy.
Checks load_checks(const std::filesystem::path& directory);

}  // namespace fascia::anatomy
