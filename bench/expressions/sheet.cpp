#include "bench/expressions/sheet.h"

#include <algorithm>
#include <cstdio>

#include "view/renderer.h"

namespace fascia::bench {
namespace {

Vec3 heat(double mm) {
  const double t = std::min(mm / 5.0, 1.0);
  return Vec3(std::min(1.0, 2.0 * t), std::min({1.0, 2.0 * t, 2.0 - 2.0 * t}), std::max(0.0, 1.0 - 2.0 * t));
}

/// Before the middle of the face, from a little to the side, a size of the face away.
view::Camera camera_of(const std::vector<Vec3>& rest) {
  Vec3 low = Vec3::Constant(1e9), high = -low;
  for (const Vec3& p : rest) {
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }
  view::Camera camera;
  camera.target = 0.5 * (low + high);
  camera.distance = 2.6 * (high - low).y();
  camera.yaw = 20;
  return camera;
}

}  // namespace

struct Sheet::Parts {
  view::Renderer renderer{340, 380};
  std::vector<view::Tile> tiles;
};

Sheet::Sheet() : parts_(std::make_unique<Parts>()) {}
Sheet::~Sheet() = default;

void Sheet::add(const std::string& caption, const std::vector<Vec3>& rest,
                const std::vector<Triangle>& triangles, const Eigen::VectorXd& simulated,
                const Eigen::VectorXd& truth, const Score& score) {
  for (int kind = 0; kind < 3; ++kind) {
    view::DrawList list;
    view::DrawSurface surface;
    surface.triangles = triangles;
    surface.colour = Vec3(0.86, 0.69, 0.59);
    surface.shine = 0.1;
    for (size_t v = 0; v < rest.size(); ++v) {
      const auto at = static_cast<Eigen::Index>(3 * v);
      const Vec3 own = simulated.segment<3>(at), known = truth.segment<3>(at);
      surface.positions.push_back(rest[v] + (kind == 0 ? known : own));
      if (kind == 2) surface.vertex_colours.push_back(heat(1e3 * (own - known).norm()));
    }
    list.surfaces.push_back(std::move(surface));
    char text[96];
    if (kind == 0)
      std::snprintf(text, sizeof text, "%s known", caption.c_str());
    else if (kind == 1)
      std::snprintf(text, sizeof text, "simulated %.2f", score.explained);
    else
      std::snprintf(text, sizeof text, "error 0..5 mm: %.2f", score.error_mm);
    parts_->tiles.push_back({parts_->renderer.draw(list, camera_of(rest)), text});
  }
}

void Sheet::write(const std::filesystem::path& path) const {
  view::write_png(path.string(), view::contact_sheet(parts_->tiles, 9));
}

}  // namespace fascia::bench
