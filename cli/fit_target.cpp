#include "cli/fit_target.h"

#include <algorithm>
#include <cctype>
#include <memory>

#include "cli/fit_cache.h"
#include "cli/fit_match.h"
#include "cli/fit_shapes.h"
#include "formats/scene.h"
#include "geometry/error.h"
#include "geometry/text.h"

namespace fascia::cli {

namespace {

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
    const std::string extension = extension_of(entry.path());
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

FitTargets open_fit_targets(const Common& common, const std::filesystem::path& path,
                            const fit::Subject& subject, const FitTargetOptions& options) {
  const TargetMaker maker(subject, options.head_pose != "fixed");
  const std::string extension = extension_of(path);
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
