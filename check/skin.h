#pragma once

#include <utility>
#include <vector>

#include "check/head.h"
#include "geometry/connectivity.h"

namespace fascia::check {

/// The skin of a head's face as one surface: the skin parts put together, welded along their open edges,
/// without what lies far from the face. Vertices that only touch, as closed lips do, stay apart.
class Skin {
 public:
  /// Takes the triangles of parts named "skin" that lie within `reach` metres of `centre`.
  Skin(const Head& head, const Vec3& centre, double reach);

  const TriangleMesh& rest() const { return rest_; }
  const Connectivity& links() const { return links_; }
  /// #vertices: nothing moves it, as the eyes of scans, which are one surface with their lids.
  const std::vector<bool>& is_still() const { return is_still_; }

  /// Its vertices as they stand in `shape`.
  std::vector<Vec3> vertices(const Shape& shape) const;

 private:
  TriangleMesh rest_;
  Connectivity links_;
  std::vector<bool> is_still_;
  std::vector<std::pair<size_t, size_t>> source_;  // part and vertex of each vertex
};

/// Some triangles of the skin, with which rays and closest points are looked for pose by pose.
struct Patch {
  std::vector<int> vertices;        ///< of the skin
  std::vector<Triangle> triangles;  ///< of `vertices`
  std::vector<int> source;          ///< #triangles, of the skin
  TriangleMesh mesh(const std::vector<Vec3>& skin) const;
};

/// The triangles whose corners all satisfy `keep`, one flag a vertex of the skin.
Patch patch(const TriangleMesh& skin, const std::vector<bool>& keep);

/// The triangles that have a corner within `radius` metres of `centre`.
Patch patch_about(const TriangleMesh& skin, const Vec3& centre, double radius);

/// The same without those that nothing moves: lids, but not what they close over.
Patch moving_patch_about(const Skin& skin, const Vec3& centre, double radius);

/// The place of `point` when the mesh's vertices stand at `vertices`.
Vec3 place(const TriangleMesh& mesh, const std::vector<Vec3>& vertices, const SurfacePoint& point);

}  // namespace fascia::check
