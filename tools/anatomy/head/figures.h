#pragma once

#include <map>
#include <string>
#include <vector>

#include "geometry/landmarks.h"
#include "geometry/mesh.h"

namespace fascia::head_maker {

/// One planar section profile: points (mm) from the outer skin inward, and the anatomical points named on it.
struct Profile {
  std::vector<Vec3> points;
  std::map<std::string, int> marks;  ///< name to index into `points`

  /// Arc length (mm) from the first point to mark `name`; throws when the profile has no such mark.
  double at(const std::string& name) const;
  /// Arc length of the whole profile, mm.
  double length() const;
  /// The point at arc length `s` (mm), clamped to the ends.
  Vec3 point(double s) const;
};

/// A measured surface point with its outward unit normal and the distance to its neighbours (mm).
struct Sample {
  Vec3 position, normal;
  double spacing = 3.0;
};

/// Everything measured that shapes the generic head; left half, millimetres (anatomy/SOURCES.md).
struct Figures {
  std::map<std::string, std::vector<Profile>> fans;  ///< eye, mouth, nostril, ear
  std::vector<Sample> sections;
  Landmarks landmarks;
  Vec3 eye_centre;
  double eye_radius = 0.0, cornea_front = 0.0;
  std::vector<Eigen::Vector4d> mouth_slices;  ///< z, half width, bottom, top
};

/// Read head_sections.csv, head_profiles.csv and head_figures.json of `folder`. Throws `fascia::Error`.
Figures read_figures(const std::string& folder);

}  // namespace fascia::head_maker
