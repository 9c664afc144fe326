#include "builder/landmarks/lip_opening.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "builder/spatial/way_between.h"

namespace fascia::landmarks {

namespace {

// Shares of the distance between the corners.
constexpr double widest = 0.8;    // from the middle: how far out is looked
constexpr double column = 0.025;  // from one column to the next
constexpr double highest = 0.34;  // above and below the corners' line
constexpr double row = 0.017;
constexpr double around = 0.3;     // a way so long from one row to the next leads around an opening
constexpr double off_line = 0.15;  // the lips' middle from the corners' line: farther up is the nose
constexpr double bend = 0.12;      // from one column to the next: more is a nostril or a fold

/// Lines of sight on a mouth.
struct View {
  Vec3 origin, across, up, forward;  ///< across: to the subject's left
  double width = 0.0;
};

View view_of(const MouthRegion& mouth) {
  View view;
  view.width = (mouth.left - mouth.right).norm();
  view.across = (mouth.left - mouth.right) / view.width;
  view.forward = (mouth.forward - mouth.forward.dot(view.across) * view.across).normalized();
  view.up = view.forward.cross(view.across);
  view.origin = 0.5 * (mouth.left + mouth.right);
  return view;
}

/// Where the lips part in the column `along` widths from the middle, nearest to `height`; nothing where the
/// skin goes on from top to bottom.
std::optional<Vec3> parting(const spatial::SurfaceQuery& skin, const SkinLinks& links, const View& view,
                            double along, double height) {
  std::optional<Vec3> best;
  std::optional<spatial::RayHit> above;
  for (double high = highest; high > -highest; high -= row) {
    const Vec3 from = view.origin + view.width * (along * view.across + high * view.up + view.forward);
    const auto hit = skin.first_hit(from, -view.forward, 2.0 * view.width);
    const double limit = around * view.width;
    const auto component = [&](const spatial::RayHit& at) {
      return links.component[static_cast<size_t>(at.surface.triangle)];
    };
    // Pieces that lie on the skin, or show through the mouth, are no lips.
    if (hit && above && component(*hit) != component(*above)) continue;
    if (hit && above && hit->surface.triangle != above->surface.triangle &&
        spatial::way_between(skin.mesh(), links.triangles, *above, *hit, limit) >= limit) {
      // Between the two, as far in front as the lip that is seen beside what shows through the opening.
      Vec3 middle = 0.5 * (hit->position + above->position);
      const double front =
          std::max((hit->position - middle).dot(view.forward), (above->position - middle).dot(view.forward));
      middle += front * view.forward;
      const auto off = [&](const Vec3& p) { return std::abs((p - view.origin).dot(view.up) - height); };
      if (!best || off(middle) < off(*best)) best = middle;
    }
    if (hit) above = hit;
  }
  return best;
}

}  // namespace

SkinLinks::SkinLinks(const TriangleMesh& skin) : triangles(connectivity(skin)), component(components(skin)) {}

std::optional<LipOpening> lip_opening(const spatial::SurfaceQuery& skin, const SkinLinks& links,
                                      const MouthRegion& mouth) {
  const View view = view_of(mouth);
  if (!(view.width > 0.0)) return std::nullopt;
  const auto middle = parting(skin, links, view, 0.0, 0.0);
  if (!middle || std::abs((*middle - view.origin).dot(view.up)) > off_line * view.width) return std::nullopt;
  LipOpening opening{*middle, *middle};
  for (const double side : {1.0, -1.0}) {
    Vec3& end = side > 0.0 ? opening.left : opening.right;
    for (double along = column; along < widest; along += column) {
      const auto next = parting(skin, links, view, side * along, (end - view.origin).dot(view.up));
      if (!next || std::abs((*next - end).dot(view.up)) > bend * view.width) break;
      end = *next;
    }
  }
  const double share = (opening.left - opening.right).norm() / view.width;
  const bool is_mouth = share > 0.3 && share < 2.0 * widest - 2.0 * column;
  const bool is_about =
      std::abs((0.5 * (opening.left + opening.right) - view.origin).dot(view.across)) < 0.12 * view.width;
  return is_mouth && is_about ? std::optional(opening) : std::nullopt;
}

}  // namespace fascia::landmarks
