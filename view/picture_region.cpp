#include "view/picture_region.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace fascia::view {

Rectangle covered(const Shot& shot) {
  const Mat4 to_clip = clip_matrix(shot.camera, shot.aspect()) * eye_matrix(shot.camera);
  Eigen::Vector2d least(1, 1), most(-1, -1);
  bool is_behind = false;
  const auto add = [&](const std::vector<Vec3>& points) {
    for (const Vec3& p : points) {
      const Eigen::Vector4d c = to_clip * p.homogeneous();
      if (!(c[3] > 1e-6)) is_behind = true;
      const Eigen::Vector2d at = c.head<2>() / c[3];
      least = least.cwiseMin(at);
      most = most.cwiseMax(at);
    }
  };
  for (const DrawSurface& surface : shot.list.surfaces)
    add(surface.positions);
  for (const DrawLines& bundle : shot.list.lines)
    for (const std::vector<Vec3>& line : bundle.lines)
      add(line);
  if (is_behind || !least.allFinite() || !most.allFinite()) return {0, 0, shot.width, shot.height};
  const Eigen::Vector2d size(shot.width, shot.height), margin(8, 8);
  const Eigen::Vector2i from = ((0.5 * (least.array() + 1.0) * size.array()).matrix() - margin)
                                   .cwiseMax(0.0)
                                   .cwiseMin(size)
                                   .cast<int>(),
                        to = ((0.5 * (most.array() + 1.0) * size.array()).matrix() + margin)
                                 .cwiseMax(0.0)
                                 .cwiseMin(size)
                                 .cast<int>();
  return {from[0], from[1], std::max(0, to[0] - from[0]), std::max(0, to[1] - from[1])};
}

void keep_inside(const Rectangle& at, double scale, int x, int y, int margin) {
  const auto up = [&](int length) { return static_cast<int>(std::ceil(length * scale)); };
  glEnable(GL_SCISSOR_TEST);
  glScissor(x + static_cast<int>(at.x * scale) - margin, y + static_cast<int>(at.y * scale) - margin,
            up(at.width) + 1 + 2 * margin, up(at.height) + 1 + 2 * margin);
}

}  // namespace fascia::view
