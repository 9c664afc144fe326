#include "view/face/heat_map.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

#include "view/text.h"

namespace fascia::view {

namespace {

/// Knots at even distances, straight between them.
template <size_t n>
Vec3 along(const std::array<std::array<double, 3>, n>& knots, double share) {
  const double at = std::clamp(share, 0.0, 1.0) * static_cast<double>(n - 1);
  const size_t low = std::min(static_cast<size_t>(at), n - 2);
  const double t = at - static_cast<double>(low);
  const auto vec = [&](size_t k) { return Vec3(knots[k][0], knots[k][1], knots[k][2]); };
  return (1.0 - t) * vec(low) + t * vec(low + 1);
}

constexpr std::array<std::array<double, 3>, 9> cool_warm = {{{0.230, 0.299, 0.754},
                                                             {0.384, 0.510, 0.918},
                                                             {0.554, 0.690, 0.996},
                                                             {0.720, 0.813, 0.976},
                                                             {0.865, 0.865, 0.865},
                                                             {0.958, 0.769, 0.678},
                                                             {0.956, 0.598, 0.477},
                                                             {0.870, 0.378, 0.300},
                                                             {0.706, 0.016, 0.150}}};
constexpr std::array<std::array<double, 3>, 9> viridis = {{{0.267, 0.005, 0.329},
                                                           {0.278, 0.176, 0.484},
                                                           {0.230, 0.322, 0.546},
                                                           {0.173, 0.449, 0.558},
                                                           {0.128, 0.567, 0.551},
                                                           {0.154, 0.680, 0.504},
                                                           {0.362, 0.786, 0.388},
                                                           {0.668, 0.862, 0.196},
                                                           {0.993, 0.906, 0.144}}};

}  // namespace

Vec3 heat_colour(const HeatScale& scale, double value) {
  const double span = std::max(scale.most - scale.least, 1e-12);
  const double share = std::isfinite(value) ? (value - scale.least) / span : 0.0;
  return scale.is_diverging ? along(cool_warm, share) : along(viridis, share);
}

std::vector<double> areal_strain(const std::vector<Vec3>& rest, const std::vector<Vec3>& now,
                                 const std::vector<Triangle>& triangles) {
  std::vector<double> before(rest.size(), 0.0), after(rest.size(), 0.0);
  const auto area = [](const std::vector<Vec3>& p, const Triangle& t) {
    const Vec3& a = p[static_cast<size_t>(t[0])];
    return (p[static_cast<size_t>(t[1])] - a).cross(p[static_cast<size_t>(t[2])] - a).norm();
  };
  for (const Triangle& t : triangles)
    for (int corner : t) {
      before[static_cast<size_t>(corner)] += area(rest, t);
      after[static_cast<size_t>(corner)] += area(now, t);
    }
  for (size_t v = 0; v < rest.size(); ++v)
    after[v] = before[v] > 0.0 ? after[v] / before[v] - 1.0 : 0.0;
  return after;
}

void add_legend(Image& image, const HeatScale& scale) {
  const int unit = std::max(1, image.height / 90), bar_height = std::max(2, unit), text_height = 2 * unit + 4;
  // As wide as its title, which a small picture's letters would else carry beyond the edge.
  const int title_width = text_width(scale.title, text_height),
            bar_width = std::min(std::max(22 * unit, title_width), image.width - 2 * unit);
  const int left = image.width - bar_width - std::min(3 * unit, (image.width - bar_width) / 2),
            top = image.height - 7 * unit;
  for (int x = 0; x < bar_width; ++x) {
    const Vec3 colour = heat_colour(scale, scale.least + (scale.most - scale.least) * (x + 0.5) / bar_width);
    Colour bytes;
    for (int k = 0; k < 3; ++k)
      bytes[static_cast<size_t>(k)] = static_cast<uint8_t>(std::lround(255.0 * colour[k]));
    paste(image, Image(1, bar_height, bytes), left + x, top);
  }
  const Colour ink = {230, 230, 230};
  write_text(image, scale.title, left, top - text_height - unit, text_height, ink);
  for (const double share : {0.0, 0.5, 1.0}) {
    char number[32];
    std::snprintf(number, sizeof number, "%.3g", scale.least + share * (scale.most - scale.least));
    const int width = text_width(number, text_height);
    write_text(image, number, left + static_cast<int>(share * (bar_width - width)),
               top + bar_height + unit / 2 + 1, text_height, ink);
  }
}

}  // namespace fascia::view
