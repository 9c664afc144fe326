#pragma once

#include <array>
#include <optional>
#include <vector>

#include "rig/model/rig.h"
#include "view/face/lattice_layers.h"

namespace fascia::view {

/// Points that move with their nearest anchors: the displacements of these, weighted by distance (Franke &
/// Nielson 1980, Smooth interpolation of large sets of scattered data), fading out far from all of them.
class Following {
 public:
  /// Anchors and points at rest, m; each point follows the `nearest` anchors nearest to it.
  Following(std::vector<Vec3> anchors, std::vector<Vec3> points, size_t nearest);

  /// Where the points are when the anchors are at `now` (one an anchor, else all are at rest).
  std::vector<Vec3> at(const std::vector<Vec3>& now) const;

 private:
  struct Share {
    size_t anchor = 0;
    double weight = 0.0;
  };
  std::vector<Vec3> anchors_, points_;
  std::vector<std::vector<Share>> shares_;  // one list a point
};

/// What of the anatomy the solvers do not report, brought along with what they do: the SMAS follows its layer
/// of the lattice, the ends of ligaments and landmarks the skin, the cranium or the mandible.
class MovingAnatomy {
 public:
  using Band = std::array<Vec3, 2>;  ///< on the bone, on the skin

  /// `rig` must outlive this; `skin`: vertices of the skin at rest, m.
  MovingAnatomy(const rig::Rig& rig, std::vector<Vec3> skin);

  /// Vertices of the SMAS, m; at rest where the lattice is empty.
  std::vector<Vec3> smas(const Lattice& now) const;
  /// Ligaments and landmarks, in the rig's order, with the skin at `skin` and the mandible moved by `jaw`.
  std::vector<Band> ligaments(const std::vector<Vec3>& skin, const Mat4& jaw) const;
  std::vector<Band> landmarks(const std::vector<Vec3>& skin, const Mat4& jaw) const;

 private:
  /// Bands at rest, and what their ends follow.
  struct Bands {
    std::vector<Vec3> bone;
    std::vector<bool> is_on_mandible;
    std::optional<Following> skin;
  };
  Bands bind(std::vector<Vec3> bone, std::vector<Vec3> skin) const;
  /// `bands`, made from `rest` (with ends on the `bone` and on the `skin`) when they are first asked for.
  template <class Ends>
  const Bands& bound(std::optional<Bands>& bands, const std::vector<Ends>& rest) const;
  static std::vector<Band> moved(const Bands& bands, const std::vector<Vec3>& skin, const Mat4& jaw);

  const rig::Rig& rig_;
  std::vector<Vec3> skin_;
  // Made when they are first asked for.
  mutable std::optional<Following> smas_;
  mutable size_t smas_columns_ = 0;
  mutable std::optional<Bands> ligaments_, landmarks_;
};

}  // namespace fascia::view
