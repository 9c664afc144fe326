#include "builder/smas/smas.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <memory>

#include "builder/smas/marching_triangles.h"
#include "builder/smas/samples.h"
#include "builder/smas/trim.h"
#include "builder/smas/vertex_grid.h"
#include "builder/splines/polyharmonic.h"
#include "geometry/connectivity.h"
#include "geometry/error.h"

namespace fascia::smas {

namespace {

// The signed height over the SMAS as a spline, from a choice of samples.
class HeightFit {
 public:
  HeightFit(const std::vector<DepthSample>& samples, double scale)
      : samples_(samples), scale_(scale), grid_(0.004 * scale), chosen_(samples.size(), false) {}

  // Takes samples at least `spacing` apart, in order of `order`, until there are `limit` centres.
  void choose(const std::vector<int>& order, double spacing, int limit);
  void solve();
  double error(int sample) const { return std::abs(spline_.scalar(samples_[sample].zero)); }
  const splines::Spline& spline() const { return spline_; }
  int centres() const { return static_cast<int>(sites_.points.size()); }

 private:
  bool add(const Vec3& point, double value, double spacing);

  const std::vector<DepthSample>& samples_;
  const double scale_;
  VertexGrid grid_;
  std::vector<bool> chosen_;
  std::vector<int> near_;
  std::vector<double> values_;
  splines::Sites sites_;
  splines::Spline spline_;
  int zeros_ = 0;
};

bool HeightFit::add(const Vec3& point, double value, double spacing) {
  grid_.near(point, spacing, &near_);
  if (!near_.empty()) return false;
  grid_.add(point);
  sites_.points.push_back(point);
  values_.push_back(value);
  return true;
}

void HeightFit::choose(const std::vector<int>& order, double spacing, int limit) {
  for (int i : order) {
    if (centres() + 1 >= limit) return;
    const DepthSample& sample = samples_[i];
    if (chosen_[i] || !add(sample.zero, 0.0, spacing)) continue;
    chosen_[i] = true;
    // Every other zero point has a partner of known height, in turn over and under it.
    const int turn = zeros_++ % 4;
    const double height = std::min(sample.depth, 0.005 * scale_) * (turn < 2 ? 1.0 : -1.0);
    if (turn % 2 == 0) add(sample.zero + height * sample.normal, height, std::min(0.0005 * scale_, 0.5 * std::abs(height)));
  }
}

void HeightFit::solve() {
  splines::SplineOptions options;
  options.exponent = 3;
  options.degree = 1;
  const Eigen::Map<const Eigen::VectorXd> data(values_.data(), static_cast<Eigen::Index>(values_.size()));
  spline_ = splines::fit(sites_, data, options);
}

HeightFit fit(const std::vector<DepthSample>& samples, const Options& options, double scale, double area) {
  HeightFit height(samples, scale);
  std::vector<int> order(samples.size());
  for (size_t i = 0; i < order.size(); ++i) order[i] = static_cast<int>(i);
  // First an even cover with about half of the centres, then where that misses most.
  const int limit = std::max(options.max_centres, 60);
  const double even = std::sqrt(1.2 * area / (0.3 * limit));
  height.choose(order, even, limit / 2);
  height.choose(order, 0.7 * even, limit / 2);
  height.solve();
  std::vector<double> error(samples.size());
  for (size_t i = 0; i < samples.size(); ++i) error[i] = height.error(static_cast<int>(i));
  std::stable_sort(order.begin(), order.end(), [&](int a, int b) { return error[a] > error[b]; });
  while (!order.empty() && error[order.back()] < options.fit_tolerance) order.pop_back();
  if (order.empty()) return height;
  height.choose(order, 0.0045 * scale, limit);
  height.choose(order, 0.0025 * scale, limit);
  height.solve();
  return height;
}

double area_of(const TriangleMesh& mesh) {
  double area = 0.0;
  for (int t = 0; t < mesh.triangle_count(); ++t) area += triangle_area(mesh, t);
  return area;
}

double interpolate(const TriangleMesh& mesh, const std::vector<double>& field, const SurfacePoint& at) {
  const Triangle& t = mesh.triangles[at.triangle];
  return at.barycentric[0] * field[t[0]] + at.barycentric[1] * field[t[1]] + at.barycentric[2] * field[t[2]];
}

// Whether the closest point of the facial skin is on its boundary: then the query lies beyond it.
bool beyond(const Connectivity& links, const SurfacePoint& at, const std::vector<bool>& border, const TriangleMesh& mesh) {
  const Triangle& t = mesh.triangles[at.triangle];
  int corner = -1, zeros = 0;
  for (int e = 0; e < 3; ++e) {
    if (at.barycentric[(e + 2) % 3] < 1e-7) {
      ++zeros;
      if (links.neighbours[at.triangle][e] < 0) return true;
    } else {
      corner = t[(e + 2) % 3];
    }
  }
  return zeros == 2 && border[corner];
}

std::vector<bool> border_vertices(const TriangleMesh& mesh, const Connectivity& links) {
  std::vector<bool> border(mesh.vertices.size(), false);
  for (int t = 0; t < mesh.triangle_count(); ++t)
    for (int e = 0; e < 3; ++e)
      if (links.neighbours[t][e] < 0) border[mesh.triangles[t][e]] = border[mesh.triangles[t][(e + 1) % 3]] = true;
  return border;
}

// A vertex between the layers: where its skin is, and how far skin and bone are.
struct Lie {
  spatial::ClosestPoint skin;
  double under_skin, over_bone;
};

Lie lie_of(const Vec3& point, const spatial::SurfaceQuery& skin, const Bones& bones) {
  Lie lie;
  lie.skin = skin.closest(point);
  lie.under_skin = -lie.skin.signed_distance;
  lie.over_bone = bones.distance(point);
  return lie;
}

// Moves a vertex that is too near to one layer away from it, at most to the middle between the two.
Vec3 between_layers(Vec3 point, double clearance, const spatial::SurfaceQuery& skin, const Bones& bones) {
  for (int round = 0; round < 12; ++round) {
    const Lie lie = lie_of(point, skin, bones);
    if (lie.under_skin >= clearance && lie.over_bone >= clearance) break;
    const Vec3 outward = skin.smooth_normal(lie.skin.surface);
    if (lie.under_skin < clearance && lie.over_bone < clearance) break;
    if (lie.under_skin < clearance) {
      const double room = std::isfinite(lie.over_bone) ? 0.5 * (lie.over_bone - lie.under_skin) : 1.0;
      point -= outward * std::min(1.1 * (clearance - lie.under_skin), std::max(room, 0.0));
    } else {
      const double room = 0.5 * (lie.under_skin - lie.over_bone);
      point += outward * std::min(1.1 * (clearance - lie.over_bone), std::max(room, 0.0));
    }
  }
  return point;
}

// Between skin and bone in a place where there is less room than twice the clearance: the middle of it.
Vec3 middle(const Vec3& point, const spatial::SurfaceQuery& skin, const Bones& bones, double range) {
  const spatial::ClosestPoint hit = skin.closest(point);
  const Vec3 outward = skin.smooth_normal(hit.surface);
  const double to_bone = std::min(bones.along(hit.position, -outward, range), bones.distance(hit.position, range));
  return std::isfinite(to_bone) && to_bone > 0.0 ? Vec3(hit.position - 0.5 * to_bone * outward) : point;
}

void order_layers(const FacialSkin& face, const spatial::SurfaceQuery& skin, const Bones& bones, double clearance,
                  double range, Result* result) {
  const size_t count = result->mesh.vertices.size();
  result->skin_distance.resize(count);
  result->bone_distance.resize(count);
  result->skin_points.resize(count);
  for (size_t v = 0; v < count; ++v) {
    Vec3& point = result->mesh.vertices[v];
    Lie lie = lie_of(point, skin, bones);
    if (lie.under_skin < clearance || lie.over_bone < clearance) {
      point = between_layers(point, clearance, skin, bones);
      lie = lie_of(point, skin, bones);
      if (!(lie.under_skin > 0.0 && lie.over_bone > 0.0)) {
        const Vec3 centre = middle(point, skin, bones, range);
        const Lie there = lie_of(centre, skin, bones);
        if (std::min(there.under_skin, there.over_bone) > std::min(lie.under_skin, lie.over_bone)) point = centre, lie = there;
      }
    }
    result->skin_distance[v] = lie.under_skin;
    result->bone_distance[v] = lie.over_bone;
    result->skin_points[v] = {face.skin_triangle[lie.skin.surface.triangle], lie.skin.surface.barycentric};
    if (!(lie.under_skin > 0.0 && lie.over_bone > 0.0)) ++result->outside_layers;
  }
}

// Errors of every fourth sample: enough to know them, and cheaper.
void measure_fit(const std::vector<DepthSample>& samples, const HeightFit& height, Result* result) {
  int count = 0;
  for (size_t i = 0; i < samples.size(); i += 4, ++count) {
    const double error = height.error(static_cast<int>(i));
    result->fit_error += error * error;
    result->depth_error = std::max(result->depth_error, error);
  }
  result->fit_error = std::sqrt(result->fit_error / count);
}

int count_folds(const TriangleMesh& mesh, const std::vector<Vec3>& normals) {
  int folds = 0;
  for (int t = 0; t < mesh.triangle_count(); ++t) {
    const auto& [a, b, c] = mesh.triangles[t];
    folds += !(triangle_normal(mesh, t).dot(normals[a] + normals[b] + normals[c]) > 0.0);
  }
  return folds;
}

// Drops triangles at the boundary that lie folded over or are slivers. Returns whether there were any.
bool drop_poor_border(MarchingResult* surface) {
  const Connectivity links = connectivity(surface->mesh);
  const std::vector<bool> border = border_vertices(surface->mesh, links);
  std::vector<Triangle> kept;
  for (int t = 0; t < surface->mesh.triangle_count(); ++t) {
    const Triangle& corners = surface->mesh.triangles[t];
    if (border[corners[0]] || border[corners[1]] || border[corners[2]]) {
      TriangleMesh one;
      Vec3 facing = Vec3::Zero();
      for (int v : corners) one.vertices.push_back(surface->mesh.vertices[v]), facing += surface->normals[v];
      one.triangles = {{0, 1, 2}};
      if (triangle_quality(one).min_angle < 22.0 || !(triangle_normal(one, 0).dot(facing) > 0.0)) continue;
    }
    kept.push_back(corners);
  }
  if (kept.size() == surface->mesh.triangles.size()) return false;
  surface->mesh.triangles = std::move(kept);
  // Vertices that no triangle uses any more go as well.
  std::vector<double> inside(surface->mesh.vertices.size(), 1.0);
  trim(0.35, &surface->mesh, &surface->normals, &surface->sizes, &inside);
  keep_main_part(&surface->mesh, &surface->normals, &surface->sizes, &inside);
  return true;
}

}  // namespace

Result build(const Inputs& inputs, const Options& options) {
  if (!inputs.skin || inputs.skin->empty()) throw Error("SMAS: the head has no skin triangles");
  if (!(options.edge_length > 0.0)) throw Error("SMAS: edge_length must be positive");
  const double scale = face_scale(inputs.landmarks);
  const double edge = options.edge_length * scale;
  const double band = 2.4 * edge;
  const ReachField reach(inputs.landmarks, options.reach, band);
  const FacialSkin face = facial_skin(*inputs.skin, inputs.landmarks, reach, band);
  const spatial::SurfaceQuery skin(face.mesh);
  const Bones bones(inputs.cranium, inputs.mandible,
                    [&](const Vec3& p) { return reach.within_limits(p) > -0.03 * scale; });
  const LayerDepth layers(options.layers.empty() ? adult_layers() : options.layers, inputs.landmarks, scale);

  const std::vector<DepthSample> samples = depth_samples(face, bones, layers, scale, 0.8 * edge);
  const HeightFit height = fit(samples, options, scale, area_of(face.mesh));
  const splines::Spline& spline = height.spline();
  const ImplicitFunction function = [&spline](const Vec3& p, Vec3* gradient) {
    return gradient ? spline.value_and_gradient(p, *gradient) : spline.scalar(p);
  };

  const auto field_at = [&](const Vec3& p) {
    return interpolate(face.mesh, face.field, skin.closest(p).surface);
  };
  MarchingOptions marching;
  marching.edge_length = edge;
  marching.tolerance = 1e-4;
  marching.improve = false;
  const Connectivity links = connectivity(face.mesh);
  const std::vector<bool> border = border_vertices(face.mesh, links);
  marching.domain = [&](const Vec3& p) {
    const spatial::ClosestPoint hit = skin.closest(p, 0.03 * scale);
    if (!hit.found()) return false;
    const double reached = interpolate(face.mesh, face.field, hit.surface);
    return reached > 0.5 * edge || (reached > -1.9 * edge && !beyond(links, hit.surface, border, face.mesh));
  };
  const Vec3& start = inputs.landmarks.at("glabella");
  marching.seeds.push_back(std::min_element(samples.begin(), samples.end(), [&](const DepthSample& a, const DepthSample& b) {
                             return (a.skin - start).squaredNorm() < (b.skin - start).squaredNorm();
                           })->zero);
  MarchingResult surface = marching_triangles(function, marching);

  Result result;
  result.evaluations = surface.evaluations;
  std::vector<double> field(surface.mesh.vertices.size());
  for (size_t v = 0; v < field.size(); ++v) field[v] = field_at(surface.mesh.vertices[v]);
  trim(0.35, &surface.mesh, &surface.normals, &surface.sizes, &field);
  keep_main_part(&surface.mesh, &surface.normals, &surface.sizes, &field);
  if (surface.mesh.empty()) throw Error("SMAS: no surface between skin and bone; check the landmarks and the fitted skull");
  QualityOptions quality;
  quality.tolerance = 1e-3 * edge;
  quality.boundary_smoothing = 0.3;
  quality.passes = 4;
  result.evaluations += improve_triangles(function, quality, &surface.mesh, &surface.normals, &surface.sizes);
  // At openings, where the skin ends, being moved between the layers can spoil a triangle.
  for (int round = 0; round < 4; ++round) {
    result.mesh = surface.mesh;
    result.normals = surface.normals;
    result.outside_layers = 0;
    order_layers(face, skin, bones, options.clearance * scale, 0.06 * scale, &result);
    surface.mesh = result.mesh;
    if (!drop_poor_border(&surface)) break;
  }

  result.boundary = boundary_loops(result.mesh, connectivity(result.mesh));
  result.folds = count_folds(result.mesh, result.normals);
  result.quality = triangle_quality(result.mesh);
  result.centres = height.centres();
  measure_fit(samples, height, &result);
  return result;
}

}  // namespace fascia::smas
