#include "builder/spatial/surface_query.h"

#include <embree3/rtcore.h>
#include <tbb/task_arena.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <memory>
#include <mutex>
#include <new>
#include <numbers>
#include <numeric>
#include <string>

#include "builder/spatial/triangle.h"
#include "geometry/connectivity.h"
#include "geometry/error.h"

namespace fascia::spatial {
namespace {

void check(const TriangleMesh& mesh) {
  if (mesh.triangles.empty()) throw Error("surface query: the mesh has no triangles");
  for (const Triangle& triangle : mesh.triangles)
    for (int corner : triangle)
      if (corner < 0 || corner >= mesh.vertex_count())
        throw Error("surface query: a triangle names vertex " + std::to_string(corner) + " of " +
                    std::to_string(mesh.vertex_count()));
  for (const Vec3& vertex : mesh.vertices)
    if (!vertex.allFinite()) throw Error("surface query: a vertex is not finite; repair the mesh first");
}

// Vertex -> first vertex at the same position.
std::vector<int> merged_vertices(const std::vector<Vec3>& vertices) {
  std::vector<int> order(vertices.size()), representative(vertices.size());
  std::iota(order.begin(), order.end(), 0);
  const auto before = [&](int a, int b) {
    const Vec3 &p = vertices[a], &q = vertices[b];
    if (p.x() != q.x()) return p.x() < q.x();
    if (p.y() != q.y()) return p.y() < q.y();
    if (p.z() != q.z()) return p.z() < q.z();
    return a < b;
  };
  std::sort(order.begin(), order.end(), before);
  for (size_t i = 0; i < order.size(); ++i) {
    const bool same = i > 0 && vertices[order[i]] == vertices[order[i - 1]];
    representative[order[i]] = same ? representative[order[i - 1]] : order[i];
  }
  return representative;
}

double corner_angle(const Vec3& at, const Vec3& left, const Vec3& right) {
  const Vec3 u = left - at, v = right - at;
  return std::atan2(u.cross(v).norm(), u.dot(v));
}

// Throws when a call of Embree's has failed; `device` may be null.
void check_embree(RTCDevice device) {
  const RTCError error = rtcGetDeviceError(device);
  if (error == RTC_ERROR_OUT_OF_MEMORY) throw std::bad_alloc();
  if (error != RTC_ERROR_NONE) throw Error("surface query: Embree fails with error " + std::to_string(error));
}

// What Embree has made. Throws when it is null.
template <class Made>
Made made_by_embree(RTCDevice device, Made what) {
  if (what) return what;
  check_embree(device);
  throw std::bad_alloc();
}

// A new buffer of `geometry` with three numbers an element.
template <class Number>
Number* new_buffer(RTCDevice device, RTCGeometry geometry, RTCBufferType type, RTCFormat format,
                   size_t count) {
  return static_cast<Number*>(
      made_by_embree(device, rtcSetNewGeometryBuffer(geometry, type, 0, format, 3 * sizeof(Number), count)));
}

}  // namespace

struct SurfaceQuery::State {
  TriangleMesh mesh;
  Vec3 origin = Vec3::Zero();  // single precision runs relative to it
  double size = 1;             // largest coordinate relative to `origin`
  RTCDevice device = nullptr;
  RTCScene scene = nullptr;
  // Made when first asked for: rays alone need none.
  mutable std::once_flag normals_made;
  mutable std::vector<Vec3> face_normals, vertex_normals;
  mutable std::vector<std::array<Vec3, 3>> edge_normals;

  State() = default;
  State(const State&) = delete;
  State& operator=(const State&) = delete;
  ~State() {
    if (scene) rtcReleaseScene(scene);
    if (device) rtcReleaseDevice(device);
  }
  void build_scene();
  void need_normals() const {
    std::call_once(normals_made, [this] { build_normals(); });
  }
  void build_normals() const;
  void sum_edge_normals(const std::vector<int>& representative) const;
  Vec3 corner(int triangle, int k) const { return mesh.vertices[mesh.triangles[triangle][k]]; }
  Vec3 pseudonormal(int triangle, const Vec3& barycentric) const;
};

void SurfaceQuery::State::build_scene() {
  const Bounds box = bounds(mesh.vertices);
  origin = box.centre();
  size = 0.5 * box.size().maxCoeff();
  device = made_by_embree(nullptr, rtcNewDevice("set_affinity=0"));
  scene = made_by_embree(device, rtcNewScene(device));
  rtcSetSceneFlags(scene, RTCSceneFlags(RTC_SCENE_FLAG_ROBUST | RTC_SCENE_FLAG_CONTEXT_FILTER_FUNCTION));
  const std::unique_ptr<RTCGeometryTy, decltype(&rtcReleaseGeometry)> geometry(
      made_by_embree(device, rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE)), rtcReleaseGeometry);
  auto* vertices = new_buffer<float>(device, geometry.get(), RTC_BUFFER_TYPE_VERTEX, RTC_FORMAT_FLOAT3,
                                     mesh.vertices.size());
  for (size_t i = 0; i < mesh.vertices.size(); ++i)
    for (int axis = 0; axis < 3; ++axis)
      vertices[3 * i + axis] = static_cast<float>(mesh.vertices[i][axis] - origin[axis]);
  auto* triangles = new_buffer<unsigned>(device, geometry.get(), RTC_BUFFER_TYPE_INDEX, RTC_FORMAT_UINT3,
                                         mesh.triangles.size());
  for (size_t i = 0; i < mesh.triangles.size(); ++i)
    for (int k = 0; k < 3; ++k)
      triangles[3 * i + k] = static_cast<unsigned>(mesh.triangles[i][k]);
  rtcCommitGeometry(geometry.get());
  rtcAttachGeometry(scene, geometry.get());
  rtcCommitScene(scene);
  check_embree(device);
}

void SurfaceQuery::State::build_normals() const {
  const std::vector<int> representative = merged_vertices(mesh.vertices);
  face_normals.resize(mesh.triangles.size());
  vertex_normals.assign(mesh.vertices.size(), Vec3::Zero());
  for (int t = 0; t < mesh.triangle_count(); ++t) {
    face_normals[t] = triangle_normal(mesh, t);
    for (int k = 0; k < 3; ++k) {
      const double angle = corner_angle(corner(t, k), corner(t, (k + 1) % 3), corner(t, (k + 2) % 3));
      vertex_normals[representative[mesh.triangles[t][k]]] += angle * face_normals[t];
    }
  }
  for (size_t v = 0; v < vertex_normals.size(); ++v)
    vertex_normals[v].normalize();
  for (size_t v = 0; v < vertex_normals.size(); ++v)
    vertex_normals[v] = vertex_normals[representative[v]];
  sum_edge_normals(representative);
}

void SurfaceQuery::State::sum_edge_normals(const std::vector<int>& representative) const {
  std::vector<Triangle> joined = mesh.triangles;
  for (Triangle& t : joined)
    for (int& v : t)
      v = representative[v];
  const std::vector<HalfEdge> edges = sorted_half_edges(joined, mesh.vertices.size());
  edge_normals.resize(mesh.triangles.size());
  for (size_t begin = 0, end = 0; begin < edges.size(); begin = end) {
    Vec3 sum = Vec3::Zero();
    while (end < edges.size() && edges[end].low == edges[begin].low && edges[end].high == edges[begin].high)
      sum += face_normals[edges[end++].triangle];
    for (size_t i = begin; i < end; ++i)
      edge_normals[edges[i].triangle][edges[i].edge] = sum.normalized();
  }
}

Vec3 SurfaceQuery::State::pseudonormal(int triangle, const Vec3& barycentric) const {
  int zeros = 0, zero = 0, at = 0;
  for (int k = 0; k < 3; ++k) {
    if (barycentric[k] <= 0) {
      ++zeros;
      zero = k;
    } else {
      at = k;
    }
  }
  if (zeros == 0) return face_normals[triangle];
  if (zeros == 1) return edge_normals[triangle][(zero + 1) % 3];  // side k joins corners k and k+1
  return vertex_normals[mesh.triangles[triangle][at]];
}

SurfaceQuery::SurfaceQuery(TriangleMesh mesh) {
  check(mesh);
  auto state = std::make_shared<State>();
  state->mesh = std::move(mesh);
  // By this thread alone, so that the tree is the same however many there are. (Embree's own "threads=1"
  // would hold all of the process to one thread for as long as the device lives.)
  tbb::task_arena(1).execute([&] { state->build_scene(); });
  state_ = std::move(state);
}

const TriangleMesh& SurfaceQuery::mesh() const {
  return state_->mesh;
}

ClosestPoint SurfaceQuery::closest(const Vec3& point, double range) const {
  ClosestPoint out = nearest_place(point, range);
  if (!out.found()) return out;
  state_->need_normals();
  out.pseudonormal = state_->pseudonormal(out.surface.triangle, out.surface.barycentric);
  out.signed_distance = (point - out.position).dot(out.pseudonormal) < 0 ? -out.distance : out.distance;
  return out;
}

ClosestPoint SurfaceQuery::nearest_place(const Vec3& point, double range) const {
  struct Search {
    const State* state;
    Vec3 point;
    double best;  // squared
    int triangle;
    Vec3 barycentric;
    float slack;
  };
  const State& s = *state_;
  const Vec3 local = point - s.origin;
  if (!local.allFinite()) throw Error("surface query: the query point is not finite");
  // Single precision may misplace boxes by this much; candidates that near are all compared in double.
  const double slack = 4e-7 * (s.size + local.cwiseAbs().maxCoeff()) + 1e-30;
  Search search{&s, point, range * range, -1, Vec3::Zero(), static_cast<float>(slack)};
  RTCPointQuery query;
  query.x = static_cast<float>(local.x());
  query.y = static_cast<float>(local.y());
  query.z = static_cast<float>(local.z());
  query.time = 0;
  query.radius = static_cast<float>(range + slack);
  RTCPointQueryContext context;
  rtcInitPointQueryContext(&context);
  const auto visit = [](RTCPointQueryFunctionArguments* arguments) -> bool {
    auto& found = *static_cast<Search*>(arguments->userPtr);
    const int triangle = static_cast<int>(arguments->primID);
    const State& surface = *found.state;
    const Vec3 a = surface.corner(triangle, 0), b = surface.corner(triangle, 1),
               c = surface.corner(triangle, 2);
    const Vec3 barycentric = closest_barycentric(found.point, a, b, c);
    const Vec3 at = barycentric[0] * a + barycentric[1] * b + barycentric[2] * c;
    const double squared = (at - found.point).squaredNorm();
    if (squared > found.best) return false;
    if (squared == found.best && found.triangle >= 0 && triangle > found.triangle) return false;
    found.best = squared;
    found.triangle = triangle;
    found.barycentric = barycentric;
    arguments->query->radius = static_cast<float>(std::sqrt(squared)) * 1.000001f + found.slack;
    return true;
  };
  rtcPointQuery(s.scene, &query, &context, visit, &search);

  ClosestPoint out;
  if (search.triangle < 0) return out;
  out.surface = {search.triangle, search.barycentric};
  out.position = fascia::position(s.mesh, out.surface);
  out.distance = std::sqrt(search.best);
  return out;
}

namespace {

RTCRay make_ray(const Vec3& origin, const Vec3& direction, double nearest, double range) {
  RTCRay ray{};
  ray.org_x = static_cast<float>(origin.x());
  ray.org_y = static_cast<float>(origin.y());
  ray.org_z = static_cast<float>(origin.z());
  ray.dir_x = static_cast<float>(direction.x());
  ray.dir_y = static_cast<float>(direction.y());
  ray.dir_z = static_cast<float>(direction.z());
  ray.tnear = static_cast<float>(nearest);
  ray.tfar = static_cast<float>(range);
  ray.mask = ~0u;
  return ray;
}

Vec3 unit_direction(const Vec3& direction) {
  const double length = direction.norm();
  if (!(length > 0) || !std::isfinite(length)) throw Error("surface query: the ray has no direction");
  return direction / length;
}

std::optional<RayHit> exact_hit(const TriangleMesh& mesh, int triangle, const Vec3& origin,
                                const Vec3& direction) {
  const Triangle& corners = mesh.triangles[triangle];
  RayHit hit;
  hit.surface.triangle = triangle;
  if (!intersect_plane(origin, direction, mesh.vertices[corners[0]], mesh.vertices[corners[1]],
                       mesh.vertices[corners[2]], hit.distance, hit.surface.barycentric))
    return std::nullopt;
  hit.position = position(mesh, hit.surface);
  hit.from_outside = triangle_normal(mesh, triangle).dot(direction) < 0;
  return hit;
}

}  // namespace

std::optional<RayHit> SurfaceQuery::first_hit(const Vec3& origin, const Vec3& direction, double range,
                                              double nearest) const {
  const State& s = *state_;
  const Vec3 unit = unit_direction(direction);
  RTCRayHit hit{};
  hit.ray = make_ray(origin - s.origin, unit, nearest, range);
  hit.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  rtcIntersect1(s.scene, &context, &hit);
  if (hit.hit.geomID == RTC_INVALID_GEOMETRY_ID) return std::nullopt;
  return exact_hit(s.mesh, static_cast<int>(hit.hit.primID), origin, unit);
}

bool SurfaceQuery::blocked(const Vec3& origin, const Vec3& direction, double range) const {
  RTCRay ray = make_ray(origin - state_->origin, unit_direction(direction), 0, range);
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  rtcOccluded1(state_->scene, &context, &ray);
  return ray.tfar < 0;
}

std::vector<RayHit> SurfaceQuery::all_hits(const Vec3& origin, const Vec3& direction, double range) const {
  struct Collector {
    RTCIntersectContext context;
    std::vector<int> triangles;
  };
  const State& s = *state_;
  const Vec3 unit = unit_direction(direction);
  Collector collector;
  rtcInitIntersectContext(&collector.context);
  collector.context.filter = [](const RTCFilterFunctionNArguments* arguments) {
    auto* self = reinterpret_cast<Collector*>(arguments->context);
    self->triangles.push_back(static_cast<int>(RTCHitN_primID(arguments->hit, 1, 0)));
    arguments->valid[0] = 0;  // go on behind it
  };
  RTCRayHit hit{};
  hit.ray = make_ray(origin - s.origin, unit, 0, range);
  hit.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  rtcIntersect1(s.scene, &collector.context, &hit);
  std::vector<int>& found = collector.triangles;
  std::sort(found.begin(), found.end());
  found.erase(std::unique(found.begin(), found.end()), found.end());
  std::vector<RayHit> out;
  for (int triangle : found)
    if (auto exact = exact_hit(s.mesh, triangle, origin, unit)) out.push_back(*exact);
  std::stable_sort(out.begin(), out.end(),
                   [](const RayHit& a, const RayHit& b) { return a.distance < b.distance; });
  return out;
}

double SurfaceQuery::winding_number(const Vec3& point) const {
  const State& s = *state_;
  double sum = 0;
  for (int t = 0; t < s.mesh.triangle_count(); ++t)
    sum += solid_angle(point, s.corner(t, 0), s.corner(t, 1), s.corner(t, 2));
  return sum / (4 * std::numbers::pi);
}

Vec3 SurfaceQuery::smooth_normal(const SurfacePoint& surface) const {
  const State& s = *state_;
  s.need_normals();
  Vec3 normal = Vec3::Zero();
  for (int k = 0; k < 3; ++k)
    normal += surface.barycentric[k] * s.vertex_normals[s.mesh.triangles[surface.triangle][k]];
  const double length = normal.norm();
  return length > 0 ? Vec3(normal / length) : s.face_normals[surface.triangle];
}

}  // namespace fascia::spatial
