#include "builder/smas/smas.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "builder/smas/height_fit.h"
#include "builder/smas/marching_triangles.h"
#include "builder/smas/order_layers.h"
#include "builder/smas/trim.h"
#include "geometry/connectivity.h"
#include "geometry/error.h"

namespace fascia::smas {

namespace {

double area_of(const TriangleMesh& mesh) {
  double area = 0.0;
  for (int t = 0; t < mesh.triangle_count(); ++t)
    area += triangle_area(mesh, t);
  return area;
}

// Whether the closest point of the facial skin is on its boundary: then the query lies beyond it.
bool beyond(const Connectivity& links, const SurfacePoint& at, const std::vector<bool>& border,
            const TriangleMesh& mesh) {
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
      if (links.neighbours[t][e] < 0)
        border[mesh.triangles[t][e]] = border[mesh.triangles[t][(e + 1) % 3]] = true;
  return border;
}

// Errors of every fourth sample: enough to know them, and cheaper.
void measure_fit(const HeightFit& height, Result* result) {
  const std::vector<double> errors = height.errors(4);
  for (double error : errors) {
    result->fit_error += error * error;
    result->depth_error = std::max(result->depth_error, error);
  }
  result->fit_error = std::sqrt(result->fit_error / static_cast<double>(errors.size()));
}

int count_folds(const TriangleMesh& mesh, const std::vector<Vec3>& normals) {
  int folds = 0;
  for (int t = 0; t < mesh.triangle_count(); ++t) {
    const auto& [a, b, c] = mesh.triangles[t];
    folds += !(triangle_normal(mesh, t).dot(normals[a] + normals[b] + normals[c]) > 0.0);
  }
  return folds;
}

}  // namespace

Inputs inputs_from(const anatomy::GenericAnatomy& anatomy) {
  Inputs inputs;
  inputs.depths = anatomy.tissue.smas_depths;
  inputs.shape = anatomy.mechanics.smas_shape;
  return inputs;
}

Result build(const Inputs& inputs, const Options& options) {
  if (!inputs.skin || inputs.skin->empty()) throw Error("SMAS: the head has no skin triangles");
  if (!(options.edge_length > 0.0)) throw Error("SMAS: edge_length must be positive");
  if (inputs.depths.empty() || !(inputs.shape.adult_width > 0.0))
    throw Error("SMAS: the depths and the shape of the anatomy are missing among the inputs");
  const double scale = face_scale(inputs.landmarks, inputs.shape);
  const double edge = options.edge_length * scale;
  const double band = 2.4 * edge;
  const ReachField reach(inputs.landmarks, with_options(inputs.shape, options.reach), options.reach.nostrils,
                         band);
  const FacialSkin face = facial_skin(*inputs.skin, inputs.landmarks, reach, band);
  const spatial::SurfaceQuery skin(face.mesh);
  const Bones bones(inputs.cranium, inputs.mandible,
                    [&](const Vec3& p) { return reach.within_limits(p) > -0.03 * scale; });
  const LayerDepth layers(inputs.depths, inputs.shape, inputs.landmarks, scale);

  const std::vector<DepthSample> samples = depth_samples(face, bones, layers, scale, 0.8 * edge);
  const HeightFit height = fit_height(samples, options, scale, area_of(face.mesh));
  const splines::Spline& spline = height.spline();
  const ImplicitFunction function = [&spline](const Vec3& p, Vec3* gradient) {
    return gradient ? spline.fast_value_and_gradient(p, *gradient) : spline.scalar(p);
  };

  MarchingOptions marching;
  marching.edge_length = edge;
  marching.tolerance = 1e-4;
  marching.improve = false;
  const Connectivity links = connectivity(face.mesh);
  const std::vector<bool> border = border_vertices(face.mesh, links);
  marching.domain = [&](const Vec3& p) {
    if (reach(p) < -1.9 * edge) return false;
    const spatial::ClosestPoint hit = skin.closest(p, 0.03 * scale);
    if (!hit.found() || !beyond(links, hit.surface, border, face.mesh)) return hit.found();
    // Past the end of the skin there is nothing that holds the function: as far as half an edge.
    const Vec3 offset = p - hit.position, normal = skin.smooth_normal(hit.surface);
    return (offset - normal * normal.dot(offset)).norm() < 0.5 * edge;
  };
  const Vec3& start = inputs.landmarks.at("glabella");
  marching.seeds.push_back(
      std::min_element(samples.begin(), samples.end(), [&](const DepthSample& a, const DepthSample& b) {
        return (a.skin - start).squaredNorm() < (b.skin - start).squaredNorm();
      })->zero);
  MarchingResult surface = marching_triangles(function, marching);

  Result result;
  result.evaluations = surface.evaluations;
  std::vector<double> field(surface.mesh.vertices.size());
  for (size_t v = 0; v < field.size(); ++v) {
    // Itself, and the skin over it: lids and lips turn in before their fissure ends.
    const Vec3& p = surface.mesh.vertices[v];
    field[v] = std::min(reach(p), reach(skin.closest(p).position));
  }
  trim(0.35, &surface.mesh, &surface.normals, &surface.sizes, &field);
  keep_main_part(&surface.mesh, &surface.normals, &surface.sizes, &field);
  if (surface.mesh.empty())
    throw Error("SMAS: no surface between skin and bone; check the landmarks and the fitted skull");
  QualityOptions quality;
  quality.tolerance = 1e-3 * edge;
  quality.boundary_smoothing = 0.3;
  quality.passes = 4;
  result.evaluations += improve_triangles(function, quality, &surface.mesh, &surface.normals, &surface.sizes);
  const std::vector<Vec3> skin_normals = vertex_normals(*inputs.skin);
  const auto outward = [&](const SurfacePoint& at) {
    const Triangle& t = inputs.skin->triangles[face.skin_triangle[at.triangle]];
    return Vec3(at.barycentric[0] * skin_normals[t[0]] + at.barycentric[1] * skin_normals[t[1]] +
                at.barycentric[2] * skin_normals[t[2]]);
  };
  const std::vector<Lie> lies =
      order_layers({skin, bones, inputs.shape.clearance * scale, 0.06 * scale, outward}, &surface);
  result.mesh = std::move(surface.mesh);
  result.normals = std::move(surface.normals);
  for (const Lie& lie : lies) {
    result.skin_distance.push_back(lie.under_skin);
    result.bone_distance.push_back(lie.over_bone);
    result.skin_points.push_back(
        {face.skin_triangle[lie.skin.surface.triangle], lie.skin.surface.barycentric});
    result.outside_layers += !lie.between();
  }
  result.boundary = boundary_loops(result.mesh, connectivity(result.mesh));
  result.folds = count_folds(result.mesh, result.normals);
  result.quality = triangle_quality(result.mesh);
  result.centres = height.data();
  measure_fit(height, &result);
  return result;
}

}  // namespace fascia::smas
