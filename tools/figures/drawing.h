#pragma once

#include <functional>
#include <string>
#include <vector>

#include "geometry/mesh.h"
#include "view/image.h"
#include "view/renderer.h"

/// The figures of the thesis' chapter 4, drawn by Fascia's own splines.
namespace fascia::figures {

/// One panel of a figure.
struct Panel {
  view::DrawList list;
  view::Camera camera;
  std::string caption;
};

/// The panels side by side in rows of `columns`, on white.
view::Image figure(const std::vector<Panel>& panels, int columns, int width = 420, int height = 380);

const Vec3 red(0.80, 0.16, 0.14), blue(0.15, 0.35, 0.75), grey(0.62, 0.64, 0.68), dark(0.15, 0.16, 0.2),
    clay(0.85, 0.72, 0.58), green(0.18, 0.55, 0.3);

/// White at 0, red towards 1, blue towards -1.
Vec3 diverging(double value);

/// The parameter square [0,1]^2 carried by `at`, `cells` by `cells`, coloured by `colour` or clay.
view::DrawSurface sheet(const std::function<Vec3(double, double)>& at, int cells,
                        const std::function<Vec3(double, double)>& colour = {});

/// `count` + 1 lines each way over the same square, `fine` points along each.
view::DrawLines grid(const std::function<Vec3(double, double)>& at, int count, const Vec3& colour,
                     double width = 1, int fine = 80);

view::DrawSurface ball(const Vec3& centre, double radius, const Vec3& colour);

/// A shaft with a head, from `from` to `to`.
view::DrawSurface arrow(const Vec3& from, const Vec3& to, double radius, const Vec3& colour);

view::DrawLines line(std::vector<Vec3> points, const Vec3& colour, double width = 2);

/// Straight down at the plane z = 0 of half-height `half` about `target`.
view::Camera from_above(const Vec3& target, double half);

/// Height data (x, y, z up) as seen by a camera whose up is +Y.
inline Vec3 upright(const Vec3& p) {
  return {p.x(), p.z(), -p.y()};
}

// The figures: plane.cpp, surfaces.cpp and space.cpp.
view::Image figure_4_1();
view::Image figure_4_2();
view::Image figure_4_3();
view::Image figure_4_4();
view::Image figure_4_5();
view::Image figure_4_6();
view::Image figure_4_7();
view::Image figure_4_8();
view::Image figure_4_9();
view::Image figure_4_10();
view::Image figure_4_11();
view::Image figure_4_12();

}  // namespace fascia::figures
