#include "builder/splines/patch.h"

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <Eigen/LU>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <string>

#include "geometry/error.h"

namespace fascia::splines {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;

constexpr int least_points = 6;

Mat3 frame_of(const Vec3& normal) {
  const std::array<Vec3, 2> plane = tangents(normal);
  Mat3 out;
  out << plane[0], plane[1], normal.normalized();
  return out;
}

// Least squares by a polynomial alone, as a spline without centres.
Spline jet(const std::vector<Vec3>& local, int degree) {
  SplineCoefficients out;
  out.dimension = 2;
  out.outputs = 1;
  out.degree = degree;
  out.monomials = monomials(2, degree);
  double radius = 0;
  for (const Vec3& p : local)
    radius = std::max(radius, p.head<2>().norm());
  out.scale = radius > 0 ? 1 / radius : 1;
  const Index rows = static_cast<Index>(local.size()), terms = static_cast<Index>(out.monomials.size());
  MatrixXd A(rows, terms), z(rows, 1);
  for (Index i = 0; i < rows; ++i) {
    const Vec3 q = out.scale * local[static_cast<size_t>(i)];
    for (Index j = 0; j < terms; ++j)
      A(i, j) = monomial_value(out.monomials[static_cast<size_t>(j)], Vec3(q.x(), q.y(), 0));
    z(i) = local[static_cast<size_t>(i)].z();
  }
  const Eigen::ColPivHouseholderQR<MatrixXd> qr(A);
  if (qr.rank() < terms)
    throw Error("patch: " + std::to_string(rows) + " points do not determine a polynomial of degree " +
                std::to_string(degree) + "; use more rings or a lower degree");
  out.polynomial = qr.solve(z);
  return Spline(std::move(out));
}

// The triangles between the first `rings` rings, seen from the normal, must all face it.
bool folds(const TriangleMesh& mesh, const Connectivity& links, const std::vector<int>& vertices,
           const Vec3& normal) {
  std::vector<int> sorted = vertices;
  std::sort(sorted.begin(), sorted.end());
  const auto inside = [&](int v) { return std::binary_search(sorted.begin(), sorted.end(), v); };
  for (int v : vertices)
    for (int k = links.vertex_offsets[v]; k < links.vertex_offsets[v + 1]; ++k) {
      const int t = links.vertex_triangles[k];
      const Triangle& corners = mesh.triangles[t];
      if (!inside(corners[0]) || !inside(corners[1]) || !inside(corners[2])) continue;
      if (!(triangle_normal(mesh, t).dot(normal) > 0.05)) return true;
    }
  return false;
}

Vec3 normal_at(const TriangleMesh& mesh, const Connectivity& links, int vertex) {
  Vec3 sum = Vec3::Zero();
  for (int k = links.vertex_offsets[vertex]; k < links.vertex_offsets[vertex + 1]; ++k) {
    const int t = links.vertex_triangles[k];
    sum += triangle_area(mesh, t) * triangle_normal(mesh, t);
  }
  return sum.normalized();
}

}  // namespace

Patch::Patch(const Vec3& origin, const Mat3& frame, Spline height)
    : origin_(origin), frame_(frame), height_(std::move(height)) {}

Vec2 Patch::coordinates(const Vec3& point) const {
  return (frame_.transpose() * (point - origin_)).head<2>();
}

Vec3 Patch::position(const Vec2& uv) const {
  return origin_ + frame_ * Vec3(uv.x(), uv.y(), height_.scalar({uv.x(), uv.y(), 0}));
}

Vec3 Patch::normal(const Vec2& uv) const {
  Vec3 slope;
  height_.value_and_gradient({uv.x(), uv.y(), 0}, slope);
  return frame_ * Vec3(-slope.x(), -slope.y(), 1).normalized();
}

PatchCurvature Patch::curvature(const Vec2& uv) const {
  const Vec3 at(uv.x(), uv.y(), 0);
  Vec3 slope;
  height_.value_and_gradient(at, slope);
  const Mat3 second = height_.hessian(at);
  const double zu = slope.x(), zv = slope.y(), zuu = second(0, 0), zuv = second(0, 1), zvv = second(1, 1);
  const double W2 = 1 + zu * zu + zv * zv, W = std::sqrt(W2);
  PatchCurvature out;
  out.gaussian = (zuu * zvv - zuv * zuv) / (W2 * W2);
  out.mean = ((1 + zv * zv) * zuu - 2 * zu * zv * zuv + (1 + zu * zu) * zvv) / (2 * W2 * W);
  // Principal directions: second against first fundamental form.
  Eigen::Matrix2d first, form;
  first << 1 + zu * zu, zu * zv, zu * zv, 1 + zv * zv;
  form << zuu / W, zuv / W, zuv / W, zvv / W;
  const Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::Matrix2d> eigen(form, first);
  out.smallest = eigen.eigenvalues()[0];
  out.largest = eigen.eigenvalues()[1];
  const auto lifted = [&](const Eigen::Vector2d& d) -> Vec3 {
    return frame_ * Vec3(d.x(), d.y(), zu * d.x() + zv * d.y()).normalized();
  };
  out.smallest_direction = lifted(eigen.eigenvectors().col(0));
  out.largest_direction = lifted(eigen.eigenvectors().col(1));
  return out;
}

PatchFoot Patch::project(const Vec3& point) const {
  const Vec3 p = frame_.transpose() * (point - origin_);
  const auto squared = [&](const Vec2& uv) {
    return (p - Vec3(uv.x(), uv.y(), height_.scalar({uv.x(), uv.y(), 0}))).squaredNorm();
  };
  PatchFoot out;
  out.uv = p.head<2>();
  double least = squared(out.uv);
  const double extent = 1 / height_.coefficients().scale;
  for (int i = 0; i < 60 && !out.converged; ++i) {
    const Vec3 at(out.uv.x(), out.uv.y(), 0);
    Vec3 slope;
    const double z = height_.value_and_gradient(at, slope), rise = z - p.z();
    const Vec2 gradient = out.uv - p.head<2>() + rise * slope.head<2>();
    Eigen::Matrix2d second = Eigen::Matrix2d::Identity() + slope.head<2>() * slope.head<2>().transpose();
    // Newton where it goes downhill, else Gauss and Newton's, which always does.
    const Eigen::Matrix2d newton = second + rise * height_.hessian(at).topLeftCorner<2, 2>();
    if (newton.determinant() > 0 && newton.trace() > 0) second = newton;
    const Vec2 step = second.inverse() * gradient;
    double share = 1;
    while (share > 1e-10 && squared(out.uv - share * step) > least)
      share /= 2;
    out.uv -= share * step;
    least = std::min(least, squared(out.uv));
    out.converged = share * step.norm() < 1e-12 * extent || gradient.norm() < 1e-14 * extent;
  }
  out.position = position(out.uv);
  out.distance = (point - out.position).norm();
  return out;
}

Patch fit_patch(std::span<const Vec3> points, std::span<const Vec3> normals, const Vec3& origin,
                const Vec3& normal, const PatchOptions& options) {
  if (points.size() < least_points)
    throw Error("patch: " + std::to_string(points.size()) + " points; give at least six");
  if (!normals.empty() && normals.size() != points.size())
    throw Error("patch: " + std::to_string(normals.size()) + " normals for " + std::to_string(points.size()) +
                " points");
  const Mat3 frame = frame_of(normal);
  std::vector<Vec3> local;
  for (const Vec3& point : points)
    local.push_back(frame.transpose() * (point - origin));
  if (options.jet_degree > 0) return Patch(origin, frame, jet(local, options.jet_degree));

  Sites sites;
  sites.points = local;
  for (size_t i = 0; i < normals.size(); ++i)
    sites.add_gradient(local[i], 2);
  MatrixXd data(sites.rows(), 1);
  for (size_t i = 0; i < local.size(); ++i)
    data(static_cast<Index>(i)) = local[i].z();
  for (size_t i = 0; i < normals.size(); ++i) {
    const Vec3 n = frame.transpose() * normals[i].normalized();
    if (!(n.z() > 0.17))
      throw Error("patch: normal " + std::to_string(i) + " leans too far from the plane's");
    data.block<2, 1>(static_cast<Index>(local.size() + 2 * i), 0) = -n.head<2>() / n.z();
  }
  SplineOptions spline;
  spline.dimension = 2;
  spline.exponent = options.exponent;
  spline.lambda = options.lambda;
  return Patch(origin, frame, fit(sites, data, spline));
}

std::vector<int> vertex_rings(const TriangleMesh& mesh, const Connectivity& links, int vertex, int rings) {
  if (vertex < 0 || vertex >= mesh.vertex_count())
    throw Error("patch: vertex " + std::to_string(vertex) + " of " + std::to_string(mesh.vertex_count()));
  std::vector<int> out = {vertex};
  std::vector<int> seen = {vertex};
  size_t begin = 0;
  for (int ring = 0; ring < rings; ++ring) {
    std::vector<int> fresh;
    for (size_t i = begin; i < out.size(); ++i)
      for (int k = links.vertex_offsets[out[i]]; k < links.vertex_offsets[out[i] + 1]; ++k)
        for (int corner : mesh.triangles[links.vertex_triangles[k]])
          if (!std::binary_search(seen.begin(), seen.end(), corner)) fresh.push_back(corner);
    std::sort(fresh.begin(), fresh.end());
    fresh.erase(std::unique(fresh.begin(), fresh.end()), fresh.end());
    begin = out.size();
    out.insert(out.end(), fresh.begin(), fresh.end());
    seen.insert(seen.end(), fresh.begin(), fresh.end());
    std::sort(seen.begin(), seen.end());
  }
  return out;
}

Patch vertex_patch(const TriangleMesh& mesh, const Connectivity& links, int vertex,
                   const PatchOptions& options) {
  std::vector<int> chosen = vertex_rings(mesh, links, vertex, 1);
  const Vec3 normal = normal_at(mesh, links, vertex);
  if (!(normal.norm() > 0.5) || folds(mesh, links, chosen, normal))
    throw Error("patch: the mesh folds over around vertex " + std::to_string(vertex));
  const int needed = options.jet_degree > 0
                         ? std::max(least_points, static_cast<int>(monomials(2, options.jet_degree).size()))
                         : least_points;
  for (int rings = 2; rings <= options.rings || static_cast<int>(chosen.size()) < needed; ++rings) {
    const std::vector<int> wider = vertex_rings(mesh, links, vertex, rings);
    if (wider.size() == chosen.size() || folds(mesh, links, wider, normal)) break;
    chosen = wider;
  }
  std::vector<Vec3> points, normals;
  for (int v : chosen) {
    points.push_back(mesh.vertices[v]);
    if (options.normals) normals.push_back(normal_at(mesh, links, v));
  }
  if (static_cast<int>(points.size()) < needed)
    throw Error("patch: only " + std::to_string(points.size()) + " vertices around vertex " +
                std::to_string(vertex) + ", " + std::to_string(needed) + " are needed");
  return fit_patch(points, normals, mesh.vertices[vertex], normal, options);
}

}  // namespace fascia::splines
