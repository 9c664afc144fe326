#include "cli/fit_target.h"

#include <Eigen/Geometry>
#include <Eigen/SVD>
#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <map>
#include <memory>
#include <set>

#include "builder/rigging/gltf_source.h"
#include "cli/fit_shapes.h"
#include "formats/obj_lines.h"
#include "formats/scene.h"
#include "geometry/error.h"

namespace fascia::cli {

namespace {

/// Where the vertices of one of the rig's primitives stand among a target's points.
struct Match {
  size_t primitive = 0;
  size_t mesh = 0;              ///< of the scene
  std::vector<uint32_t> point;  ///< by vertex of the primitive, into the mesh or the cache
};

std::vector<uint32_t> counted(size_t first, size_t count) {
  std::vector<uint32_t> list(count);
  for (size_t i = 0; i < count; ++i)
    list[i] = static_cast<uint32_t>(first + i);
  return list;
}

[[noreturn]] void fail_topology(const std::filesystem::path& path, const fit::Subject& subject,
                                const std::string& holds) {
  throw Error("'" + path.string() + "' " + holds + ", but the rig's meshes have " +
              std::to_string(subject.vertex_count()) + " vertices in " +
              std::to_string(subject.file().primitives.size()) +
              " parts: give meshes of the rig's own topology, as `fascia pose` writes them, or one scan with "
              "--as scan");
}

/// Finds each of the rig's primitives in a scene: by its place in the file, by its name, or in one mesh of
/// all. Empty when there are none.
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
    if (best >= 0) found.push_back({p, static_cast<size_t>(best), counted(0, count)});
  }
  if (found.empty() && scene.meshes.size() == 1 && scene.meshes[0].positions.size() == subject.vertex_count())
    for (size_t p = 0; p < primitives.size(); ++p)
      found.push_back({p, 0, counted(subject.first_vertex(p), primitives[p].positions.size())});
  return found;
}

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

/// Builds targets from points in the rig's input space.
class TargetMaker {
 public:
  TargetMaker(const fit::Subject& subject, bool takes_out_head)
      : subject_(subject),
        takes_out_head_(takes_out_head),
        offset_(rigging::input_offset(subject.file().source)),
        to_metres_(subject.file().rig.input_to_metres.cast<double>()) {}

  fit::Target none() const {
    return {Eigen::VectorXd::Zero(subject_.rest().size()), std::vector<double>(subject_.vertex_count(), 0.0)};
  }

  /// A vertex that should stand at `place`, in the input's axes and units.
  void put(fit::Target& target, size_t vertex, const Vec3& place) const {
    put_metres(target, vertex, transform_point(to_metres_, place - offset_));
  }

  Mat4 to_metres(const formats::Scene& scene) const { return scene_to_metres(subject_, scene); }

  /// The target with the head's own motion taken out where asked for. Throws fascia::Error when it is another
  /// place or size than the rig's head.
  fit::Target finished(fit::Target target) const {
    if (takes_out_head_) target = without_head(std::move(target));
    double sum = 0.0;
    size_t count = 0;
    for (size_t v = 0; v < subject_.vertex_count(); ++v) {
      if (target.trust[v] <= 0.0) continue;
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

  const fit::Subject& subject() const { return subject_; }

  /// Takes the motion out of those vertices that nothing in the face moves (Kabsch 1976).
  fit::Target without_head(fit::Target target) const {
    std::vector<Eigen::Index> still;
    Vec3 from = Vec3::Zero(), to = Vec3::Zero();
    double moved = 0.0;
    for (size_t v = 0; v < subject_.vertex_count(); ++v) {
      if (target.trust[v] <= 0.0 || subject_.eyes()[v] != 0 || subject_.follows(v)) continue;
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
    const Eigen::JacobiSVD<Mat3> svd(sum, Eigen::ComputeFullU | Eigen::ComputeFullV);
    Mat3 flip = Mat3::Identity();
    flip(2, 2) = (svd.matrixU() * svd.matrixV().transpose()).determinant() < 0.0 ? -1.0 : 1.0;
    const Mat3 back = svd.matrixU() * flip * svd.matrixV().transpose();
    for (size_t v = 0; v < subject_.vertex_count(); ++v) {
      if (target.trust[v] <= 0.0) continue;
      const auto at = static_cast<Eigen::Index>(3 * v);
      const Vec3 rest = subject_.rest().segment<3>(at);
      target.displacements.segment<3>(at) =
          back * (rest + Vec3(target.displacements.segment<3>(at)) - to) + from - rest;
    }
    return target;
  }

  fit::Target of_scene(const formats::Scene& scene) const {
    fit::Target target = none();
    const Mat4 map = to_metres(scene);
    for (const Match& match : matches(scene, subject_))
      for (size_t v = 0; v < match.point.size(); ++v)
        put_metres(target, subject_.first_vertex(match.primitive) + v,
                   transform_point(map, scene.meshes[match.mesh].positions[match.point[v]]));
    return finished(std::move(target));
  }

 private:
  void put_metres(fit::Target& target, size_t vertex, const Vec3& place) const {
    const auto at = static_cast<Eigen::Index>(3 * vertex);
    if (!place.allFinite()) return;
    target.displacements.segment<3>(at) = place - Vec3(subject_.rest().segment<3>(at));
    target.trust[vertex] = 1.0;
  }

  const fit::Subject& subject_;
  bool takes_out_head_;
  Vec3 offset_;  ///< of the rig's input, in its units
  Mat4 to_metres_;
};

/// Points by frame of a PC2 or MDD cache.
struct PointCache {
  std::vector<uint8_t> bytes;
  size_t points = 0, frames = 0, first = 0;  ///< `first`: where the points begin
  bool is_big_endian = false;
  std::vector<double> times;

  uint32_t word(size_t at) const {
    uint32_t value = 0;
    std::memcpy(&value, bytes.data() + at, 4);
    if (is_big_endian) value = value << 24 | (value & 0xFF00U) << 8 | (value >> 8 & 0xFF00U) | value >> 24;
    return value;
  }
  double real(size_t at) const { return static_cast<double>(std::bit_cast<float>(word(at))); }
  Vec3 point(size_t frame, size_t index) const {
    const size_t at = first + 12 * (frame * points + index);
    return {real(at), real(at + 4), real(at + 8)};
  }
};

PointCache read_cache(const std::filesystem::path& path, double fps) {
  PointCache cache;
  cache.bytes = formats::read_bytes(path);
  const auto fail = [&](const std::string& what) { throw Error("'" + path.string() + "': " + what); };
  if (cache.bytes.size() >= 32 && std::memcmp(cache.bytes.data(), "POINTCACHE2", 12) == 0) {
    cache.points = cache.word(16);
    cache.frames = cache.word(28);
    cache.first = 32;
    for (size_t f = 0; f < cache.frames && f < cache.bytes.size(); ++f)
      cache.times.push_back(static_cast<double>(f) / fps);
  } else if (path.extension() == ".mdd" && cache.bytes.size() >= 8) {
    cache.is_big_endian = true;
    cache.frames = cache.word(0);
    cache.points = cache.word(4);
    cache.first = 8 + 4 * cache.frames;
    for (size_t f = 0; f < cache.frames && 12 + 4 * f <= cache.bytes.size(); ++f)
      cache.times.push_back(cache.real(8 + 4 * f));
  } else {
    fail("it is not a PC2 or MDD point cache");
  }
  if (cache.frames == 0 || cache.points == 0) fail("the point cache holds no frames");
  if ((cache.bytes.size() - std::min(cache.bytes.size(), cache.first)) / 12 / cache.points < cache.frames)
    fail("the point cache is shorter than its header says: it is damaged or truncated");
  for (size_t f = 1; f < cache.times.size(); ++f)
    if (!(cache.times[f] > cache.times[f - 1])) fail("the times of its frames do not rise");
  return cache;
}

/// An object of the rig's source whose vertices a cache may hold: OBJ files count each `v` once.
struct CachePart {
  size_t points = 0;
  std::vector<Match> matches;
};

std::vector<CachePart> cache_parts(const fit::Subject& subject) {
  std::map<uint32_t, CachePart> parts;
  const rig::RigFile& file = subject.file();
  formats::Scene source;
  if (file.source.format == "obj") source = formats::read("source.obj", file.source.bytes);
  for (size_t p = 0; p < file.primitives.size(); ++p) {
    const uint32_t mesh = file.primitives[p].mesh;
    CachePart& part = parts[mesh];
    const size_t count = file.primitives[p].positions.size();
    Match match{p, mesh, counted(part.points, count)};
    if (mesh < source.meshes.size() && source.meshes[mesh].source_vertices.size() >= count) {
      const std::vector<int>& lines = source.meshes[mesh].source_vertices;
      const std::set<int> sorted(lines.begin(), lines.end());
      const std::vector<int> order(sorted.begin(), sorted.end());
      for (size_t v = 0; v < count; ++v)
        match.point[v] =
            static_cast<uint32_t>(std::lower_bound(order.begin(), order.end(), lines[v]) - order.begin());
      part.points = order.size();
    } else {
      part.points += count;
    }
    part.matches.push_back(std::move(match));
  }
  std::vector<CachePart> list;
  for (auto& [mesh, part] : parts)
    list.push_back(std::move(part));
  return list;
}

/// The rig's vertices among all `v` lines of its OBJ source, where there are `points` of them; else none.
std::vector<Match> obj_matches(size_t points, const fit::Subject& subject) {
  const rig::RigFile& file = subject.file();
  if (file.source.format != "obj") return {};
  const std::string text(file.source.bytes.begin(), file.source.bytes.end());
  if (formats::obj_vertices(text).size() != points) return {};
  const formats::Scene source = formats::read("source.obj", file.source.bytes);
  std::vector<Match> found;
  for (size_t p = 0; p < file.primitives.size(); ++p) {
    const size_t mesh = file.primitives[p].mesh, count = file.primitives[p].positions.size();
    if (mesh >= source.meshes.size() || source.meshes[mesh].source_vertices.size() < count) continue;
    const std::vector<int>& lines = source.meshes[mesh].source_vertices;
    found.push_back({p, mesh, {lines.begin(), lines.begin() + static_cast<std::ptrdiff_t>(count)}});
  }
  return found;
}

/// What a cache of `points` points holds: the whole OBJ, one object, or all of them one after the other.
std::vector<Match> cache_matches(const std::filesystem::path& path, size_t points,
                                 const fit::Subject& subject) {
  if (std::vector<Match> whole = obj_matches(points, subject); !whole.empty()) return whole;
  const std::vector<CachePart> parts = cache_parts(subject);
  std::vector<Match> all;
  size_t sum = 0;
  for (const CachePart& part : parts) {
    for (Match match : part.matches) {
      for (uint32_t& point : match.point)
        point += static_cast<uint32_t>(sum);
      all.push_back(std::move(match));
    }
    sum += part.points;
  }
  if (sum == points) return all;
  const CachePart* found = nullptr;
  for (const CachePart& part : parts) {
    if (part.points != points) continue;
    if (found != nullptr)
      throw Error("'" + path.string() + "': more than one of the rig's meshes has its " +
                  std::to_string(points) + " points: give a cache of all meshes");
    found = &part;
  }
  if (found == nullptr) fail_topology(path, subject, "has " + std::to_string(points) + " points a frame");
  return found->matches;
}

FitTargets cache_targets(const std::filesystem::path& path, const TargetMaker& maker, double fps) {
  const auto cache = std::make_shared<PointCache>(read_cache(path, fps));
  const auto found =
      std::make_shared<std::vector<Match>>(cache_matches(path, cache->points, maker.subject()));
  FitTargets targets;
  targets.kind = FitTargets::Kind::take;
  targets.times = cache->times;
  for (size_t f = 0; f < cache->frames; ++f)
    targets.names.push_back("frame " + std::to_string(f));
  targets.target = [cache, found, maker](size_t frame) {
    fit::Target target = maker.none();
    for (const Match& match : *found)
      for (size_t v = 0; v < match.point.size(); ++v)
        maker.put(target, maker.subject().first_vertex(match.primitive) + v,
                  cache->point(frame, match.point[v]));
    return maker.finished(std::move(target));
  };
  return targets;
}

FitTargets sequence_targets(const std::filesystem::path& folder, const TargetMaker& maker, double fps) {
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    const std::string extension = entry.path().extension().string();
    if (entry.is_regular_file() && (extension == ".obj" || extension == ".ply" || extension == ".glb"))
      files.push_back(entry.path());
  }
  if (files.empty()) throw Error("the folder '" + folder.string() + "' holds no OBJ, PLY or GLB frames");
  std::sort(files.begin(), files.end());
  FitTargets targets;
  targets.kind = FitTargets::Kind::take;
  for (size_t f = 0; f < files.size(); ++f) {
    targets.names.push_back(files[f].filename().string());
    targets.times.push_back(static_cast<double>(f) / fps);
  }
  targets.target = [files, maker](size_t frame) { return maker.of_scene(formats::read(files[frame])); };
  return targets;
}

/// Targets of a glTF file's morph targets, alone or as its animation weighs them.
struct MorphTargets {
  std::vector<fit::Target> shapes;  ///< displacements from the file's base mesh
  fit::Target base;

  MorphTargets(const formats::Scene& scene, const std::vector<Shape>& list, const TargetMaker& maker)
      : base(maker.of_scene(scene)) {
    const fit::Subject& subject = maker.subject();
    const std::vector<Match> found = matches(scene, subject);
    for (const Shape& shape : list) {
      fit::Target target = base;
      target.displacements.setZero();
      for (const ShapePart& part : shape.parts)
        for (const Match& match : found) {
          const formats::SceneMesh& mesh = scene.meshes[match.mesh];
          if (mesh.mesh != part.mesh || mesh.primitive != part.primitive) continue;
          if (part.displacements.size() != mesh.positions.size())
            throw Error("'" + scene.path.string() + "': the morph target '" + shape.name +
                        "' has another number of vertices than its mesh");
          const Mat3 linear =
              maker.to_metres(scene).topLeftCorner<3, 3>() * mesh.to_file.topLeftCorner<3, 3>();
          for (size_t v = 0; v < match.point.size(); ++v)
            target.displacements.segment<3>(
                static_cast<Eigen::Index>(3 * (subject.first_vertex(match.primitive) + v))) =
                linear * part.displacements[match.point[v]];
        }
      shapes.push_back(std::move(target));
    }
  }

  double base_motion() const {
    return base.displacements.size() > 0 ? base.displacements.cwiseAbs().maxCoeff() : 0.0;
  }
};

}  // namespace

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

FitTargets open_fit_targets(const Common& common, const std::filesystem::path& path,
                            const fit::Subject& subject, const FitTargetOptions& options) {
  const TargetMaker maker(subject, options.head_pose != "fixed");
  std::string extension = path.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  if (std::filesystem::is_directory(path)) return sequence_targets(path, maker, options.fps);
  if (extension == ".pc2" || extension == ".mdd") return cache_targets(path, maker, options.fps);
  const auto scene = std::make_shared<formats::Scene>(formats::read(path));
  const std::vector<Shape> shapes = morph_shapes(*scene);
  FitTargets targets;
  if ((options.as == "shapes" || options.as == "take") && shapes.empty())
    throw Error("'" + path.string() + "' has no morph targets to fit: use --as mesh");
  if (shapes.empty() || options.as == "mesh") {
    targets.names = {path.filename().string()};
    targets.target = [scene, maker](size_t) { return maker.of_scene(*scene); };
    return targets;
  }
  const auto morphs = std::make_shared<MorphTargets>(*scene, shapes, maker);
  const auto curves = std::make_shared<ShapeCurves>(shape_curves(*scene, shapes));
  if (options.as == "take" && curves->times.empty())
    throw Error("'" + path.string() + "' has no animation of morph weights: use --as shapes");
  if (options.as == "take" || (options.as == "auto" && curves->times.size() > 1)) {
    targets.kind = FitTargets::Kind::take;
    targets.times = curves->times;
    for (size_t f = 0; f < curves->times.size(); ++f)
      targets.names.push_back("frame " + std::to_string(f));
    targets.target = [morphs, curves, maker](size_t frame) {
      fit::Target target = morphs->base;
      for (size_t s = 0; s < morphs->shapes.size(); ++s)
        if (curves->weights[frame][s] != 0.0)
          target.displacements += curves->weights[frame][s] * morphs->shapes[s].displacements;
      return maker.finished(std::move(target));
    };
    return targets;
  }
  if (options.as == "auto" && morphs->base_motion() > 1e-4) {  // a posed head that has morph targets besides
    common.warn("'" + path.string() +
                "' is posed and has morph targets: the pose is fitted; use --as shapes for the "
                "morph targets");
    targets.names = {path.filename().string()};
    targets.target = [morphs](size_t) { return morphs->base; };
    return targets;
  }
  targets.kind = FitTargets::Kind::shapes;
  for (const Shape& shape : shapes)
    targets.names.push_back(shape.name);
  targets.target = [morphs](size_t index) { return morphs->shapes[index]; };
  return targets;
}

}  // namespace fascia::cli
