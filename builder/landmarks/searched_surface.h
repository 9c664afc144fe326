#pragma once

#include <list>
#include <optional>
#include <vector>

#include "builder/landmarks/placement.h"

namespace fascia::landmarks {

/// A surface that a head is looked for in, its triangles facing outward, with samples about places of it made
/// when first asked for.
class SearchedSurface {
 public:
  /// Throws fascia::Error when `mesh` has no triangles that can be used.
  explicit SearchedSurface(TriangleMesh mesh);

  const TriangleMesh& mesh() const { return mesh_; }
  const spatial::SurfaceQuery& query() const { return *query_; }
  bool is_inside_out() const { return is_inside_out_; }
  const Samples& open() const { return open_; }  ///< spread over all of it, seen from outside
  double extent() const { return extent_; }      ///< diagonal of the bounds
  Ball all() const { return all_; }              ///< sphere fitted to all of it

  /// Open samples in a ball about `ball`, a little wider, some 5,000 however small it is.
  const Neighbours& about(const Ball& ball);

 private:
  TriangleMesh mesh_;
  std::optional<spatial::SurfaceQuery> query_;
  bool is_inside_out_ = false;
  Samples open_;
  double extent_ = 0.0;
  Ball all_;
  struct Patch {
    Ball ball;
    Neighbours samples;
  };
  std::list<Patch> patches_;
};

}  // namespace fascia::landmarks
