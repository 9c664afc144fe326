// Figures 4.9 to 4.12: landmark deformations of the plane and of a ball.
#include <Eigen/Geometry>
#include <cmath>
#include <numbers>

#include "builder/splines/deformation.h"
#include "tools/figures/drawing.h"

namespace fascia::figures {
namespace {

using splines::DeformationLandmark;
using splines::DeformationOptions;
using splines::Warp;

constexpr double pi = std::numbers::pi;

DeformationLandmark held(const Vec3& at) {
  DeformationLandmark out;
  out.source = out.target = at;
  return out;
}

/// The grid over [-half, half]^2 as `warp` leaves it, with landmarks and what becomes of their vectors.
Panel plane_panel(const Warp& warp, const std::vector<DeformationLandmark>& landmarks, double half,
                  const std::string& caption, double margin = 1.3) {
  const auto at = [&](double u, double v) { return warp(Vec3(half * (2 * u - 1), half * (2 * v - 1), 0)); };
  Panel out;
  out.caption = caption;
  out.camera = from_above(Vec3::Zero(), margin * half);
  out.list.lines.push_back(grid(at, 24, grey, 1.2, 160));
  for (const DeformationLandmark& landmark : landmarks) {
    const bool moves = (landmark.target - landmark.source).norm() > 0;
    out.list.surfaces.push_back(ball(landmark.target, 0.025 * half, moves ? red : dark));
    if (moves) {
      out.list.surfaces.push_back(ball(landmark.source, 0.018 * half, blue));
      out.list.lines.push_back(line({landmark.source, landmark.target}, red, 2));
    }
    for (const splines::CarriedVector& carried : landmark.vectors)
      out.list.surfaces.push_back(
          arrow(landmark.target, landmark.target + 0.25 * half * carried.image, 0.012 * half, red));
  }
  return out;
}

std::vector<DeformationLandmark> frame_with(const std::vector<DeformationLandmark>& more) {
  std::vector<DeformationLandmark> out = {held({-1, -1, 0}), held({1, -1, 0}), held({-1, 1, 0}),
                                          held({1, 1, 0})};
  out.insert(out.end(), more.begin(), more.end());
  return out;
}

Panel rotated_panel(double exponent, const std::string& caption) {
  std::vector<DeformationLandmark> landmarks;
  const Mat3 turn = Eigen::AngleAxisd(pi / 4, Vec3::UnitZ()).toRotationMatrix();
  for (const Vec3& p : {Vec3(1, 0, 0), Vec3(-1, 0, 0), Vec3(0, 1, 0), Vec3(0, -1, 0)}) {
    landmarks.push_back(held(p));
    landmarks.back().carry_frame(turn, 2);
  }
  DeformationOptions options;
  options.dimension = 2;
  options.exponent = exponent;
  return plane_panel(splines::fit_deformation(landmarks, options), landmarks, 1.5, caption, 1.75);
}

/// The unit ball's surface and its grid after `warp`.
Panel ball_panel(const Warp& warp, const std::vector<DeformationLandmark>& landmarks,
                 const std::string& caption) {
  const auto at = [&](double u, double v, double radius) {
    const double a = 2 * pi * u, b = pi * (v - 0.5);
    return upright(warp(radius * Vec3(std::cos(b) * std::cos(a), std::cos(b) * std::sin(a), std::sin(b))));
  };
  Panel out;
  out.caption = caption;
  out.camera.distance = 8.2;
  out.camera.yaw = 35;
  out.camera.pitch = 24;
  out.list.surfaces.push_back(sheet([&](double u, double v) { return at(u, v, 1); }, 96));
  out.list.lines.push_back(grid([&](double u, double v) { return at(u, v, 1.008); }, 24, dark, 1, 120));
  const Vec3 colours[] = {red, green, blue};
  for (const DeformationLandmark& landmark : landmarks) {
    out.list.surfaces.push_back(ball(upright(landmark.target), 0.05, dark));
    for (size_t k = 0; k < landmark.vectors.size(); ++k)
      out.list.surfaces.push_back(arrow(upright(landmark.target),
                                        upright(landmark.target + 0.42 * landmark.vectors[k].image), 0.018,
                                        colours[k]));
  }
  return out;
}

/// The octahedron's corners, all held; with `turned` the equator's triads turn by -45 degrees about the
/// vertical, and with `further` the one at +x by -45 degrees more about x.
std::vector<DeformationLandmark> octahedron(bool turned, bool further) {
  std::vector<DeformationLandmark> out;
  for (const Vec3& corner :
       {Vec3(0, 0, 1), Vec3(0, 0, -1), Vec3(1, 0, 0), Vec3(-1, 0, 0), Vec3(0, 1, 0), Vec3(0, -1, 0)}) {
    out.push_back(held(corner));
    if (!turned || corner.z() != 0) continue;
    Mat3 turn = Eigen::AngleAxisd(-pi / 4, Vec3::UnitZ()).toRotationMatrix();
    if (further && corner.x() == 1)
      turn = Eigen::AngleAxisd(-pi / 4, Vec3::UnitX()).toRotationMatrix() * turn;
    out.back().carry_frame(turn);
  }
  return out;
}

}  // namespace

view::Image figure_4_9() {
  DeformationLandmark one = held({-0.35, -0.1, 0}), two = held({0.35, 0.1, 0});
  one.target = {-0.15, 0.3, 0};
  two.target = {0.15, -0.3, 0};
  const std::vector<DeformationLandmark> landmarks = frame_with({one, two});
  std::vector<Panel> panels;
  for (double exponent : {2.0, 3.0}) {
    DeformationOptions options;
    options.dimension = 2;
    options.exponent = exponent;
    panels.push_back(plane_panel(splines::fit_deformation(landmarks, options), landmarks, 1,
                                 exponent == 2 ? "r2 ln r" : "r3"));
  }
  return figure(panels, 2);
}

view::Image figure_4_10() {
  const Vec3 across = Vec3(1, 1, 0).normalized(), along = Vec3(-1, 1, 0).normalized();
  DeformationLandmark pressed = held(Vec3::Zero()), sheared = pressed;
  pressed.vectors = {{across, 0.25 * across}};
  sheared.vectors = {{along, Vec3(-0.2, 1.2, 0)}};
  DeformationOptions options;
  options.dimension = 2;
  const std::vector<DeformationLandmark> one = frame_with({pressed}), two = frame_with({sheared});
  return figure({plane_panel(splines::fit_deformation(one, options), one, 1, "a crease: one vector pressed"),
                 plane_panel(splines::fit_deformation(two, options), two, 1, "an edge: one vector turned")},
                2);
}

view::Image figure_4_11() {
  return figure({rotated_panel(3, "r3"), rotated_panel(3.5, "r3.5"), rotated_panel(4, "r4 ln r")}, 3);
}

view::Image figure_4_12() {
  const std::vector<DeformationLandmark> rest = octahedron(false, false), twisted = octahedron(true, false),
                                         further = octahedron(true, true);
  std::vector<DeformationLandmark> pressed = rest;
  pressed[0].target = {0, 0, 0.5};
  DeformationOptions plate;
  plate.exponent = 1;
  return figure({ball_panel(splines::fit_deformation(rest), rest, "(a) six landmarks"),
                 ball_panel(splines::fit_deformation(pressed, plate), pressed, "(b) pole pressed in, r"),
                 ball_panel(splines::fit_deformation(twisted), twisted, "(c) equator turned, r3"),
                 ball_panel(splines::fit_deformation(further), further, "(d) one triad further")},
                2);
}

}  // namespace fascia::figures
