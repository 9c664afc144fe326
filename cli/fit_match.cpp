#include "cli/fit_match.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "builder/rigging/gltf_source.h"
#include "geometry/alignment.h"
#include "geometry/error.h"

namespace fascia::cli {

std::vector<uint32_t> counted(size_t first, size_t count) {
  std::vector<uint32_t> list(count);
  for (size_t i = 0; i < count; ++i)
    list[i] = static_cast<uint32_t>(first + i);
  return list;
}

void fail_topology(const std::filesystem::path& path, const fit::Subject& subject, const std::string& holds) {
  throw Error("'" + path.string() + "' " + holds + ", but the rig's meshes have " +
              std::to_string(subject.vertex_count()) + " vertices in " +
              std::to_string(subject.file().primitives.size()) +
              " parts: give meshes of the rig's own topology, as `fascia pose` writes them, or one scan with "
              "--as scan");
}

namespace {

/// The mesh's vertices in the rig's order. A rig from an OBJ has them as its faces first name them, any other
/// as they stand in its file, and so do the `v` lines of an OBJ that shows it.
std::vector<uint32_t> in_order_of_rig(const formats::SceneMesh& mesh, const fit::Subject& subject) {
  std::vector<uint32_t> points = counted(0, mesh.positions.size());
  if (subject.file().source.format != "obj" && mesh.source_vertices.size() == points.size())
    std::stable_sort(points.begin(), points.end(), [&](uint32_t a, uint32_t b) {
      return mesh.source_vertices[a] < mesh.source_vertices[b];
    });
  return points;
}

/// As `matches`, but empty when none is there.
std::vector<Match> matches_or_none(const formats::Scene& scene, const fit::Subject& subject) {
  const auto& primitives = subject.file().primitives;
  const bool is_gltf = scene.kind == formats::FileKind::glb || scene.kind == formats::FileKind::gltf;
  std::vector<Match> found;
  for (size_t p = 0; p < primitives.size(); ++p) {
    const size_t count = primitives[p].positions.size();
    int best = -1, best_rank = 0;
    for (size_t m = 0; m < scene.meshes.size(); ++m) {
      const formats::SceneMesh& mesh = scene.meshes[m];
      if (mesh.positions.size() != count) continue;
      const bool in_place = is_gltf ? mesh.mesh == static_cast<int>(primitives[p].mesh) &&
                                          mesh.primitive == static_cast<int>(primitives[p].primitive)
                                    : m == primitives[p].mesh;
      const int rank = (mesh.name == primitives[p].name ? 2 : 0) + (in_place ? 1 : 0);
      if (rank > best_rank || (rank == 0 && best < 0 && primitives.size() == 1)) {
        best = static_cast<int>(m);
        best_rank = rank;
      }
    }
    if (best >= 0) {
      const auto at = static_cast<size_t>(best);
      found.push_back({p, at, in_order_of_rig(scene.meshes[at], subject)});
    }
  }
  if (found.empty() && scene.meshes.size() == 1 && scene.meshes[0].positions.size() == subject.vertex_count())
    for (size_t p = 0; p < primitives.size(); ++p)
      found.push_back({p, 0, counted(subject.first_vertex(p), primitives[p].positions.size())});
  return found;
}

}  // namespace

std::vector<Match> matches(const formats::Scene& scene, const fit::Subject& subject) {
  std::vector<Match> found = matches_or_none(scene, subject);
  if (found.empty()) {
    size_t vertices = 0;
    for (const formats::SceneMesh& mesh : scene.meshes)
      vertices += mesh.positions.size();
    fail_topology(scene.path, subject,
                  "has " + std::to_string(vertices) + " vertices in " + std::to_string(scene.meshes.size()) +
                      " meshes");
  }
  return found;
}

TargetMaker::TargetMaker(const fit::Subject& subject, bool takes_out_head)
    : subject_(subject),
      takes_out_head_(takes_out_head),
      offset_(rigging::input_offset(subject.file().source)),
      to_metres_(subject.file().rig.input_to_metres.cast<double>()) {}

fit::Target TargetMaker::finished(fit::Target target) const {
  if (takes_out_head_) target = without_head(std::move(target));
  double sum = 0.0;
  size_t count = 0;
  for (size_t v = 0; v < subject_.vertex_count(); ++v) {
    if (target.confidence[v] <= 0.0) continue;
    sum += target.displacements.segment<3>(static_cast<Eigen::Index>(3 * v)).norm();
    ++count;
  }
  constexpr double farthest = 0.05;  // metres: no face moves so far on average
  if (count > 0 && sum > farthest * static_cast<double>(count))
    throw Error("the target lies " + std::to_string(std::lround(1e3 * sum / static_cast<double>(count))) +
                " mm from the rig's head on average: give it in the axes and units of the file the rig was "
                "built from");
  return target;
}

fit::Target TargetMaker::without_head(fit::Target target) const {
  std::vector<Eigen::Index> still;
  Vec3 from = Vec3::Zero(), to = Vec3::Zero();
  double moved = 0.0;
  for (size_t v = 0; v < subject_.vertex_count(); ++v) {
    if (target.confidence[v] <= 0.0 || subject_.eyes()[v] != 0 || subject_.follows(v)) continue;
    const auto at = static_cast<Eigen::Index>(3 * v);
    still.push_back(at);
    from += subject_.rest().segment<3>(at);
    to += subject_.rest().segment<3>(at) + target.displacements.segment<3>(at);
    moved += target.displacements.segment<3>(at).squaredNorm();
  }
  constexpr size_t enough = 50;
  constexpr double least = 2e-4;  // metres
  if (still.size() < enough || moved < least * least * static_cast<double>(still.size())) return target;
  from /= static_cast<double>(still.size());
  to /= static_cast<double>(still.size());
  Mat3 sum = Mat3::Zero();
  for (const Eigen::Index at : still) {
    const Vec3 rest = subject_.rest().segment<3>(at);
    sum += (rest - from) * (rest + Vec3(target.displacements.segment<3>(at)) - to).transpose();
  }
  const Mat3 back = nearest_rotation(sum);
  for (size_t v = 0; v < subject_.vertex_count(); ++v) {
    if (target.confidence[v] <= 0.0) continue;
    const auto at = static_cast<Eigen::Index>(3 * v);
    const Vec3 rest = subject_.rest().segment<3>(at);
    target.displacements.segment<3>(at) =
        back * (rest + Vec3(target.displacements.segment<3>(at)) - to) + from - rest;
  }
  return target;
}

fit::Target TargetMaker::of_scene(const formats::Scene& scene) const {
  fit::Target target = none();
  const Mat4 map = to_metres(scene);
  for (const Match& match : matches(scene, subject_))
    for (size_t v = 0; v < match.point.size(); ++v)
      put_metres(target, subject_.first_vertex(match.primitive) + v,
                 transform_point(map, scene.meshes[match.mesh].positions[match.point[v]]));
  return finished(std::move(target));
}

void TargetMaker::put_metres(fit::Target& target, size_t vertex, const Vec3& place) const {
  const auto at = static_cast<Eigen::Index>(3 * vertex);
  if (!place.allFinite()) return;
  target.displacements.segment<3>(at) = place - Vec3(subject_.rest().segment<3>(at));
  target.confidence[vertex] = 1.0;
}

Mat4 scene_to_metres(const fit::Subject& subject, const formats::Scene& scene) {
  const bool is_gltf = scene.kind == formats::FileKind::glb || scene.kind == formats::FileKind::gltf;
  const std::string& source = subject.file().source.format;
  if (is_gltf && (source == "obj" || source == "ply" || source == "stl")) return Mat4::Identity();
  Mat4 map = subject.file().rig.input_to_metres.cast<double>();
  const Vec3 apart = scene.offset - rigging::input_offset(subject.file().source);
  map.topRightCorner<3, 1>() += map.topLeftCorner<3, 3>() * apart;
  return map;
}

bool has_rig_topology(const fit::Subject& subject, const formats::Scene& scene) {
  return !matches_or_none(scene, subject).empty();
}

}  // namespace fascia::cli
