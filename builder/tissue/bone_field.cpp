#include "builder/tissue/bone_field.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "builder/spatial/surface_query.h"

namespace fascia::tissue {
namespace {

constexpr float unknown = std::numeric_limits<float>::quiet_NaN();

/// Gives points beyond reach of the surface, still `unknown`, the sign of the known ones they are connected
/// to.
void spread_signs(BoneField& field, float reach) {
  std::vector<size_t> front;
  for (size_t at = 0; at < field.distance.size(); ++at)
    if (!std::isnan(field.distance[at])) front.push_back(at);
  const size_t strides[3] = {1, field.size[0], static_cast<size_t>(field.size[0]) * field.size[1]};
  for (size_t next = 0; next < front.size(); ++next) {
    const size_t at = front[next];
    for (size_t axis = 0; axis < 3; ++axis) {
      const size_t place = at / strides[axis] % field.size[axis];
      for (const bool up : {false, true}) {
        if (up ? place + 1 >= field.size[axis] : place == 0) continue;
        const size_t beside = up ? at + strides[axis] : at - strides[axis];
        if (!std::isnan(field.distance[beside])) continue;
        field.distance[beside] = std::copysign(reach, field.distance[at]);
        front.push_back(beside);
      }
    }
  }
  for (float& distance : field.distance)
    if (std::isnan(distance)) distance = reach;
}

struct Neighbour {
  int i, j, k;
  float apart;  ///< metres
};

/// The 13 neighbours of a grid point that come before it (or, times -1, after it).
std::vector<Neighbour> neighbours_before(double spacing) {
  std::vector<Neighbour> list;
  for (int k = -1; k <= 0; ++k)
    for (int j = -1; j <= (k < 0 ? 1 : 0); ++j)
      for (int i = -1; i <= (k < 0 || j < 0 ? 1 : -1); ++i)
        list.push_back({i, j, k, static_cast<float>(spacing * std::sqrt(i * i + j * j + k * k))});
  return list;
}

/// One sweep of the chamfer transform (Borgefors 1986), forward or backward: raises distances that lie
/// farther below a neighbour's than the two are apart. Says whether one was.
bool raise(BoneField& field, const std::vector<Neighbour>& neighbours, bool forward) {
  constexpr float rounding = 1e-6F;  // metres
  const int sign = forward ? 1 : -1;
  const auto size = [&](size_t axis) { return static_cast<int>(field.size[axis]); };
  bool changed = false;
  const int count = static_cast<int>(field.distance.size());
  for (int n = 0; n < count; ++n) {
    const int at = forward ? n : count - 1 - n;
    const int i = at % size(0), j = at / size(0) % size(1), k = at / (size(0) * size(1));
    float& distance = field.distance[static_cast<size_t>(at)];
    for (const Neighbour& beside : neighbours) {
      const int a = i + sign * beside.i, b = j + sign * beside.j, c = k + sign * beside.k;
      if (a < 0 || b < 0 || c < 0 || a >= size(0) || b >= size(1) || c >= size(2)) continue;
      const float least = field.distance[static_cast<size_t>(a + size(0) * (b + size(1) * c))] - beside.apart;
      if (distance + rounding >= least) continue;
      distance = least;
      changed = true;
    }
  }
  return changed;
}

}  // namespace

BoneField sample_bone_field(const TriangleMesh& bone, const Bounds& box, double spacing, double reach) {
  constexpr double most_values = 250.0;  // along an axis
  constexpr int sweeps = 8;              // at most; a sound field needs one
  const spatial::SurfaceQuery query(bone);
  BoneField field;
  field.spacing = spacing;
  field.origin = box.lower - Vec3::Constant(spacing);
  for (int axis = 0; axis < 3; ++axis) {
    const double length = box.upper[axis] - field.origin[axis] + spacing;
    field.size[static_cast<size_t>(axis)] =
        static_cast<uint32_t>(std::clamp(std::ceil(length / spacing), 2.0, most_values)) + 1;
  }
  field.distance.reserve(static_cast<size_t>(field.size[0]) * field.size[1] * field.size[2]);
  for (uint32_t k = 0; k < field.size[2]; ++k)
    for (uint32_t j = 0; j < field.size[1]; ++j)
      for (uint32_t i = 0; i < field.size[0]; ++i) {
        const spatial::ClosestPoint hit = query.closest(field.origin + spacing * Vec3(i, j, k), reach);
        field.distance.push_back(
            hit.found() ? static_cast<float>(std::clamp(hit.signed_distance, -reach, reach)) : unknown);
      }
  spread_signs(field, static_cast<float>(reach));
  const std::vector<Neighbour> neighbours = neighbours_before(spacing);
  for (int sweep = 0; sweep < sweeps; ++sweep) {
    const bool first = raise(field, neighbours, true), second = raise(field, neighbours, false);
    if (!first && !second) break;
  }
  return field;
}

}  // namespace fascia::tissue
