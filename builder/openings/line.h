#pragma once

#include <functional>
#include <map>
#include <string>
#include <vector>

#include "anatomy/anatomy.h"
#include "builder/spatial/surface_query.h"
#include "geometry/landmarks.h"
#include "geometry/mesh.h"

namespace fascia::openings {

/// How the generic head is turned and scaled onto a face (least squares over the landmarks both have): the
/// face's own axes, whatever its pose.
struct FaceAxes {
  Mat3 rotation = Mat3::Identity();  ///< columns: to the subject's left, up, front; unit vectors
  double scale = 1.0;                ///< this face over the generic one
};
FaceAxes face_axes(const anatomy::GenericAnatomy& anatomy, const Landmarks& landmarks);

/// The line along which lips or lids meet, as a height over the straight line between its corners.
struct MeetingLine {
  Vec3 origin = Vec3::Zero();    ///< midway between the corners, metres
  Mat3 axes = Mat3::Identity();  ///< columns: from the right corner to the left, up, out of the face
  double half_width = 0.0;       ///< half the distance between the corners, metres
  std::vector<double> heights;   ///< metres, in even steps from the right corner to the left
  double clearness = 0.0;        ///< how much of a valley the surface has along it: mean bend, radians

  double along(const Vec3& p) const;  ///< -1 at the right corner .. 1 at the left
  double height(double along) const;  ///< metres over the straight line; level beyond the corners
  double above(const Vec3& p) const;  ///< metres over the line, negative below it
  Vec3 place(double along, double up, double front) const;  ///< metres, from the point of the line at `along`
};

struct LineSearch {
  double reach = 0.2;  ///< rows to look through above and below what is expected, as a share of the width
  double bend_scale = 0.03;  ///< over which the surface's bend is measured, as a share of the width
  double keep = 0.15;        ///< how much is paid for each `keep_scale` off what is expected
  double keep_scale = 0.08;
  double straight = 0.5;  ///< how much is paid for a slope of 1
};

/// Looks for the valley from corner to corner of `skin` that is deepest and straightest (dynamic programming
/// over a map of depths as seen from the front), near `expected`: height over the straight line between
/// `right` and `left` as a share of the width, by the place along, -1..1.
MeetingLine find_line(const spatial::SurfaceQuery& skin, const Vec3& right, const Vec3& left,
                      const FaceAxes& face, const std::function<double(double)>& expected,
                      const LineSearch& search = {});

}  // namespace fascia::openings
