#pragma once

#include <optional>
#include <string>
#include <vector>

#include "anatomy/checks.h"
#include "check/head.h"

namespace fascia::check {

/// One measure: what was found, what it may be, and what to do when it is not.
struct Row {
  std::string name;             ///< such as blink.lid_gap_left
  double value = 0.0;           ///< in `unit`; not finite values are written as a failure
  std::string unit;             ///< mm, degrees, share, per_mille, count
  std::optional<double> least;  ///< as it holds for a face of this size
  std::optional<double> most;
  bool ok = true;
  std::string remedy;         ///< what to do when the row fails
  std::string pose;           ///< in which pose it was found
  std::optional<Vec3> place;  ///< where, in that pose: metres, rig frame
};

struct Options {
  bool is_quick = false;     ///< the poses marked quick alone, without mirror images and crossings
  double rest_motion = 0.0;  ///< metres that the player's rest is off the file's
};

/// Plays the poses of `checks` on `head` and measures each: lids, mouth, landmarks, mirror images, triangles,
/// edges, crossings, eyes and what should be still. A row whose subject the head does not have (eyes, teeth,
/// hair) is left out; so is every row of a pose for which the player has no shape.
std::vector<Row> run(const Head& head, const Player& player, const anatomy::Checks& checks,
                     const Options& options = {});

/// How many rows have failed.
int failed(const std::vector<Row>& rows);

}  // namespace fascia::check
