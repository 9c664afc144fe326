#pragma once

#include <string>
#include <vector>

#include "builder/splines/warp.h"
#include "geometry/mesh.h"

namespace fascia::skull_maker {

/// A point of an outer surface with its unit outward normal, millimetres.
struct OrientedPoint {
  Vec3 position = Vec3::Zero();
  Vec3 normal = Vec3::Zero();
};

/// A tooth cut across its long axis.
struct ToothSection {
  double level = 0;  ///< mm from the tip
  Vec3 centre = Vec3::Zero();
  double half_mesiodistal = 0;
  double half_buccolingual = 0;
};

/// A tooth of the left half.
struct Tooth {
  std::string name;                    ///< such as `first_molar`
  Vec3 axis = Vec3::Zero();            ///< unit, towards the tip
  Vec3 mesial = Vec3::Zero();          ///< unit, along the dental arch
  std::vector<ToothSection> sections;  ///< from the tip to the neck
};

/// A named curve of the skull's surface, in order.
struct NamedCurve {
  std::string name;
  std::string bone;  ///< cranium or mandible
  std::vector<OrientedPoint> points;
};

/// All that the skull is shaped from: left half, in the frame of the measured skull.
struct Figures {
  std::vector<OrientedPoint> cranium;
  std::vector<OrientedPoint> mandible;
  std::vector<Tooth> teeth_upper;
  std::vector<Tooth> teeth_lower;
  std::vector<NamedCurve> curves;  ///< rims of either bone, and edges to cut by
  splines::Warp to_generic;        ///< from that frame to the generic head's
};

/// Reads skull_*.csv of `folder`. Throws Error naming the file and line that cannot be read.
Figures read_figures(const std::string& folder);

/// The curve of this name. Throws Error when it was not measured.
const NamedCurve& curve(const std::vector<NamedCurve>& curves, const std::string& name);

/// `points` in the generic frame: positions by the warp, normals by its inverse transposed Jacobian.
std::vector<OrientedPoint> carry(const splines::Warp& warp, const std::vector<OrientedPoint>& points);

}  // namespace fascia::skull_maker
