#pragma once

#include <optional>
#include <string>
#include <vector>

#include "anatomy/checks.h"
#include "check/head.h"
#include "geometry/for_each.h"

namespace fascia::check {

/// One measurement: its value, its bounds, and the remedy when it is outside them.
struct Row {
  std::string name;             ///< such as blink.lid_gap_left
  double value = 0.0;           ///< in `unit`; values that are not finite count as failures
  std::string unit;             ///< mm, degrees, share, per_mille, count
  std::optional<double> least;  ///< scaled to this face
  std::optional<double> most;
  bool ok = true;
  std::string remedy;         ///< what to do when the row fails
  std::string pose;           ///< the pose in which it was measured
  std::optional<Vec3> place;  ///< location in that pose: metres, rig frame
};

struct Options {
  bool is_quick = false;     ///< the poses marked quick alone, without mirror images and crossings
  double rest_motion = 0.0;  ///< metres: deviation of the player's rest from the file's
  ForEach for_each;  ///< how some poses are played side by side, if the player may be called so; the rows are
                     ///< the same
};

/// Plays the poses of `checks` on `head` and measures each: lids, mouth, landmarks, mirror images, triangles,
/// edges, crossings, eyes and what should be still. Rows about parts that the head lacks (eyes, teeth, hair)
/// are omitted, and so are those of poses for which the player has no shape.
std::vector<Row> run(const Head& head, const Player& player, const anatomy::Checks& checks,
                     const Options& options = {});

/// Number of failed rows.
int failed(const std::vector<Row>& rows);

}  // namespace fascia::check
