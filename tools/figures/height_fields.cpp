// Figures 4.1 to 4.4: kernels and height fields over the plane.
#include <cmath>

#include "builder/splines/polyharmonic.h"
#include "tools/figures/drawing.h"

namespace fascia::figures {
namespace {

using splines::Sites;
using splines::Spline;
using splines::SplineOptions;

view::Camera oblique(const Vec3& target, double distance) {
  view::Camera camera;
  camera.target = target;
  camera.distance = distance;
  camera.yaw = 28;
  camera.pitch = 30;
  camera.field_of_view = 20;
  return camera;
}

struct HeightField {
  Sites sites;
  Eigen::MatrixXd data;
  Spline spline;
};

/// Eight values on the rim of a 10 by 10 square; with `cross` not NaN also the derivative 1 along (1, 1) and
/// `cross` along (-1, 1) in the middle.
HeightField rim(double exponent, bool derivatives, double cross = 0) {
  HeightField out;
  out.sites.points = {{0.5, 0.5, 0}, {9.5, 0.5, 0}, {0.5, 9.5, 0}, {9.5, 9.5, 0},
                      {5, 0.5, 0},   {5, 9.5, 0},   {0.5, 5, 0},   {9.5, 5, 0}};
  const double h = std::sqrt(0.5);
  if (derivatives) {
    out.sites.add_derivative({5, 5, 0}, {h, h, 0});
    out.sites.add_derivative({5, 5, 0}, {-h, h, 0});
  }
  out.data = Eigen::MatrixXd::Zero(out.sites.rows(), 1);
  out.data.topRows(8) << 0, 0, 0, 0, 1.5, 1.5, -1.5, -1.5;
  if (derivatives) out.data.bottomRows(2) << 1, cross;
  SplineOptions options;
  options.dimension = 2;
  options.exponent = exponent;
  out.spline = splines::fit(out.sites, out.data, options);
  return out;
}

Panel panel(const HeightField& field, const std::string& caption) {
  const auto at = [&](double u, double v) {
    return upright({10 * u, 10 * v, field.spline.scalar({10 * u, 10 * v, 0})});
  };
  Panel out;
  out.caption = caption;
  out.camera = oblique({5, 0, -5}, 40);
  out.list.surfaces.push_back(sheet(at, 80, [&](double u, double v) {
    return diverging(field.spline.scalar({10 * u, 10 * v, 0}) / 2);
  }));
  out.list.lines.push_back(
      grid([&](double u, double v) { return Vec3(at(u, v) + Vec3(0, 0.03, 0)); }, 20, dark));
  for (int i = 0; i < field.sites.value_count(); ++i) {
    Vec3 p = field.sites.points[i];
    p.z() = field.data(i);
    out.list.surfaces.push_back(ball(upright(p), 0.22, dark));
  }
  for (int j = 0; j < field.sites.derivative_count(); ++j) {
    Vec3 from = field.sites.derivative_points[j], along = field.sites.derivative_directions[j];
    from.z() = field.spline.scalar(from) + 0.1;
    along.z() = field.data(field.sites.value_count() + j);
    out.list.surfaces.push_back(arrow(upright(from), upright(from + 2 * along), 0.08, j == 0 ? red : green));
  }
  return out;
}

Panel kernel_panel(double exponent, const std::string& caption) {
  const splines::Kernel kernel(exponent);
  const double reach = 0.95, corner = std::abs(kernel.value(2 * reach * reach));
  const auto height = [&](double u, double v) {
    const double x = reach * (2 * u - 1), y = reach * (2 * v - 1);
    return kernel.sign() * kernel.value(x * x + y * y) / corner;
  };
  const auto at = [&](double u, double v) {
    return upright({reach * (2 * u - 1), reach * (2 * v - 1), 0.8 * height(u, v)});
  };
  Panel out;
  out.caption = caption;
  out.camera = oblique({0, 0.25, 0}, 8.6);
  out.list.surfaces.push_back(
      sheet(at, 80, [&](double u, double v) { return diverging(1.2 * height(u, v)); }));
  out.list.lines.push_back(
      grid([&](double u, double v) { return Vec3(at(u, v) + Vec3(0, 0.006, 0)); }, 20, dark));
  return out;
}

}  // namespace

view::Image figure_4_1() {
  return figure({kernel_panel(2, "r2 ln r, plate in 2D"), kernel_panel(1, "r, plate in 3D"),
                 kernel_panel(3, "r3, gradients")},
                3);
}

view::Image figure_4_2() {
  return figure({panel(rim(2, false), "r2 ln r through 8 values")}, 1, 640, 480);
}

view::Image figure_4_3() {
  return figure({panel(rim(3, true), "r3, slopes 1 and 0"), panel(rim(4, true), "r4 ln r, slopes 1 and 0")},
                2);
}

view::Image figure_4_4() {
  return figure({panel(rim(3, true, 0.25), "r3, slopes 1 and 1/4"),
                 panel(rim(4, true, 0.25), "r4 ln r, slopes 1 and 1/4")},
                2);
}

}  // namespace fascia::figures
