// Figures 4.5 to 4.8: patches with curvature and projection, curves and surfaces as zero sets.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "builder/smas/marching_triangles.h"
#include "builder/splines/implicit.h"
#include "builder/splines/patch.h"
#include "tools/figures/drawing.h"

namespace fascia::figures {
namespace {

using splines::Patch;
using splines::Spline;

constexpr double pi = std::numbers::pi;
constexpr double ring = 1, tube = 0.42;

Vec3 torus_normal(double a, double b) {
  return {std::cos(a) * std::cos(b), std::sin(a) * std::cos(b), std::sin(b)};
}

Vec3 torus_point(double a, double b) {
  return ring * Vec3(std::cos(a), std::sin(a), 0) + tube * torus_normal(a, b);
}

TriangleMesh torus(int around, int across) {
  TriangleMesh mesh;
  for (int i = 0; i < around; ++i)
    for (int j = 0; j < across; ++j)
      mesh.vertices.push_back(torus_point(2 * pi * i / around, 2 * pi * j / across));
  for (int i = 0; i < around; ++i)
    for (int j = 0; j < across; ++j) {
      const int next = (i + 1) % around, up = (j + 1) % across;
      mesh.triangles.push_back({i * across + j, next * across + j, next * across + up});
      mesh.triangles.push_back({i * across + j, next * across + up, i * across + up});
    }
  return mesh;
}

view::Camera tilted(double distance) {
  view::Camera camera;
  camera.distance = distance;
  camera.yaw = 20;
  camera.pitch = 38;
  camera.field_of_view = 20;
  return camera;
}

std::vector<Vec3> upright_all(const std::vector<Vec3>& points) {
  std::vector<Vec3> out;
  for (const Vec3& p : points)
    out.push_back(upright(p));
  return out;
}

/// The mesh, its edges, and the patch around one vertex over a disc of `radius`.
view::DrawSurface patch_surface(const Patch& patch, double radius) {
  view::DrawSurface out = sheet(
      [&](double u, double v) {
        const double r = radius * u, a = 2 * pi * v;
        return upright(patch.position({r * std::cos(a), r * std::sin(a)}));
      },
      40);
  out.colour = Vec3(0.9, 0.6, 0.25);
  return out;
}

view::DrawLines edges(const TriangleMesh& mesh) {
  view::DrawLines out;
  out.colour = dark;
  out.width = 1;
  const std::vector<Vec3> normals = vertex_normals(mesh);
  for (const Triangle& t : mesh.triangles) {
    std::vector<Vec3> loop;
    for (int corner : {t[0], t[1], t[2], t[0]})
      loop.push_back(upright(mesh.vertices[corner] + 0.006 * normals[corner]));
    out.lines.push_back(std::move(loop));
  }
  return out;
}

/// Zero set of `field` in the plane as short segments, on a grid of `cells` over [-half, half]^2.
view::DrawLines contour(const Spline& field, double level, double half, int cells, const Vec3& colour,
                        double width) {
  view::DrawLines out;
  out.colour = colour;
  out.width = width;
  const double step = 2 * half / cells;
  const auto corner = [&](int i, int j) { return Vec3(-half + i * step, -half + j * step, 0); };
  std::vector<double> values;
  for (int j = 0; j <= cells; ++j)
    for (int i = 0; i <= cells; ++i)
      values.push_back(field.scalar(corner(i, j)) - level);
  const auto value = [&](int i, int j) { return values[static_cast<size_t>(j) * (cells + 1) + i]; };
  for (int j = 0; j < cells; ++j)
    for (int i = 0; i < cells; ++i)
      for (const auto& t : {std::array<std::array<int, 2>, 3>{{{i, j}, {i + 1, j}, {i + 1, j + 1}}},
                            std::array<std::array<int, 2>, 3>{{{i, j}, {i + 1, j + 1}, {i, j + 1}}}}) {
        std::vector<Vec3> cut;
        for (int k = 0; k < 3; ++k) {
          const auto &a = t[k], &b = t[(k + 1) % 3];
          const double fa = value(a[0], a[1]), fb = value(b[0], b[1]);
          if ((fa < 0) == (fb < 0)) continue;
          cut.push_back(corner(a[0], a[1]) + fa / (fa - fb) * (corner(b[0], b[1]) - corner(a[0], a[1])));
        }
        if (cut.size() == 2) out.lines.push_back(cut);
      }
  return out;
}

Panel circle_panel(const Spline& field, const std::vector<Vec3>& inside, bool normals,
                   const std::string& caption) {
  Panel out;
  out.caption = caption;
  out.camera = from_above(Vec3::Zero(), 1.7);
  out.list.surfaces.push_back(sheet([](double u, double v) { return Vec3(4 * u - 2, 4 * v - 2, -0.02); }, 120,
                                    [&](double u, double v) {
                                      return diverging(0.6 * field.scalar({4 * u - 2, 4 * v - 2, 0}));
                                    }));
  for (double level : {-0.75, -0.5, -0.25, 0.25, 0.5, 0.75, 1.0, 1.25, 1.5})
    out.list.lines.push_back(contour(field, level, 1.8, 90, grey, 1));
  out.list.lines.push_back(contour(field, 0, 1.8, 180, dark, 3));
  for (int i = 0; i < 8; ++i) {
    const Vec3 p(std::cos(i * pi / 4), std::sin(i * pi / 4), 0);
    out.list.surfaces.push_back(ball(p, 0.05, red));
    if (normals) out.list.surfaces.push_back(arrow(p, 1.35 * p, 0.018, red));
  }
  for (const Vec3& p : inside)
    out.list.surfaces.push_back(ball(p, 0.04, blue));
  return out;
}

}  // namespace

view::Image figure_4_5() {
  const TriangleMesh mesh = torus(26, 14);
  const Connectivity links = connectivity(mesh);
  const int vertex = 20 * 14 + 1;
  const std::vector<int> rings = splines::vertex_rings(mesh, links, vertex, 2);
  const Patch patch = splines::vertex_patch(mesh, links, vertex);
  view::Camera camera = tilted(4.4);
  camera.target = upright(mesh.vertices[vertex]);
  view::DrawSurface whole;
  whole.positions = upright_all(mesh.vertices);
  whole.triangles = mesh.triangles;
  whole.colour = clay;

  Panel chosen{{{whole}, {edges(mesh)}}, camera, "(a) two rings"};
  for (int v : rings)
    chosen.list.surfaces.push_back(
        ball(upright(mesh.vertices[v]), v == vertex ? 0.035 : 0.022, v == vertex ? red : blue));
  std::vector<bool> keep;
  for (const Triangle& t : mesh.triangles)
    keep.push_back(std::all_of(t.begin(), t.end(), [&](int corner) {
      return std::find(rings.begin(), rings.end(), corner) != rings.end();
    }));
  std::vector<int> map;
  Panel fitted{
      {{patch_surface(patch, 0.45)}, {edges(submesh(mesh, keep, &map))}}, camera, "(b) r4 ln r patch"};
  view::Camera aside = camera;
  aside.yaw = -35;
  aside.pitch = 12;
  Panel touched{{{patch_surface(patch, 0.45)}, {}}, aside, "(c) projection"};
  const Vec3 query = patch.position({0.1, 0.05}) + 0.33 * patch.normal({0.1, 0.05});
  const splines::PatchFoot foot = patch.project(query);
  view::DrawSurface sphere = ball(upright(query), foot.distance, blue);
  sphere.opacity = 0.35;
  touched.list.surfaces.push_back(sphere);
  touched.list.surfaces.push_back(ball(upright(query), 0.018, dark));
  touched.list.surfaces.push_back(ball(upright(foot.position), 0.018, red));
  touched.list.lines.push_back(line({upright(query), upright(foot.position)}, red));
  return figure({chosen, fitted, touched}, 3);
}

view::Image figure_4_6() {
  const TriangleMesh mesh = torus(64, 32);
  const Connectivity links = connectivity(mesh);
  view::DrawSurface gaussian, mean;
  gaussian.positions = mean.positions = upright_all(mesh.vertices);
  gaussian.triangles = mean.triangles = mesh.triangles;
  splines::PatchOptions options;
  options.rings = 3;
  for (int v = 0; v < mesh.vertex_count(); ++v) {
    const splines::PatchCurvature found =
        splines::vertex_patch(mesh, links, v, options).curvature(Vec2::Zero());
    gaussian.vertex_colours.push_back(diverging(found.gaussian / 3));
    mean.vertex_colours.push_back(diverging((found.mean + 1.2) / 1.2));
  }
  return figure({{{{gaussian}, {}}, tilted(9), "Gaussian, -4.1 to 1.7"},
                 {{{mean}, {}}, tilted(9), "mean, -1.5 to -0.3"}},
                2);
}

view::Image figure_4_7() {
  std::vector<Vec3> circle, inner;
  for (int i = 0; i < 8; ++i) {
    circle.emplace_back(std::cos(i * pi / 4), std::sin(i * pi / 4), 0);
    inner.push_back(0.5 * circle.back());
  }
  splines::ImplicitOptions variational, cubic, quadratic;
  for (auto* options : {&variational, &cubic, &quadratic})
    options->dimension = 2;
  variational.exponent = 2;
  variational.offset = 0.5;
  quadratic.exponent = 4;
  return figure(
      {circle_panel(splines::fit_variational(circle, circle, variational), inner, false,
                    "(a) values, r2 ln r"),
       circle_panel(splines::fit_hermite(circle, circle, cubic), {}, true, "(b) normals, r3"),
       circle_panel(splines::fit_hermite(circle, circle, quadratic), {}, true, "(c) normals, r4 ln r")},
      3);
}

view::Image figure_4_8() {
  std::vector<Vec3> points, normals;
  Panel samples{{}, tilted(9), "128 points with normals"};
  for (int i = 0; i < 16; ++i)
    for (int j = 0; j < 8; ++j) {
      const double a = 2 * pi * i / 16, b = 2 * pi * (j + 0.5 * (i % 2)) / 8;
      points.push_back(torus_point(a, b));
      normals.push_back(torus_normal(a, b));
      samples.list.surfaces.push_back(ball(upright(points.back()), 0.025, dark));
      samples.list.surfaces.push_back(
          arrow(upright(points.back()), upright(points.back() + 0.16 * normals.back()), 0.01, red));
    }
  const Spline field = splines::fit_hermite(points, normals);
  smas::MarchingOptions options;
  options.edge_length = 0.06;
  options.seeds = {points[0]};
  const smas::MarchingResult meshed = smas::marching_triangles(
      [&](const Vec3& p, Vec3* gradient) {
        Vec3 unused;
        return field.value_and_gradient(p, gradient ? *gradient : unused);
      },
      options);
  view::DrawSurface surface;
  surface.positions = upright_all(meshed.mesh.vertices);
  surface.triangles = meshed.mesh.triangles;
  surface.colour = clay;
  return figure({samples, {{{surface}, {edges(meshed.mesh)}}, tilted(9), "the zero set, genus 1"}}, 2);
}

}  // namespace fascia::figures
