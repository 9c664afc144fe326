#pragma once

#include "geometry/mesh.h"

namespace fascia::spatial {

/// Barycentric weights of the point of triangle a b c that is closest to `point`; a weight is exactly 0
/// when the closest point is on an edge or corner. Degenerate triangles are treated as their longest edge.
/// C. Ericson. Real-Time Collision Detection, 5.1.5. 2005.
Vec3 closest_barycentric(const Vec3& point, const Vec3& a, const Vec3& b, const Vec3& c);

/// Signed solid angle of triangle a b c seen from `point`, in steradians; positive when the point sees
/// the back (the triangle's normal points away). A. van Oosterom, J. Strackee. 1983.
double solid_angle(const Vec3& point, const Vec3& a, const Vec3& b, const Vec3& c);

/// Ray parameter t and barycentric weights where the plane of a b c meets origin + t direction; weights
/// are clamped into the triangle. False when the ray is parallel to the plane.
bool intersect_plane(const Vec3& origin, const Vec3& direction, const Vec3& a, const Vec3& b, const Vec3& c,
                     double& t, Vec3& barycentric);

}  // namespace fascia::spatial
