#include "cli/fit_target.h"

#include <algorithm>
#include <cctype>
#include <memory>

#include "cli/fit_cache.h"
#include "cli/fit_match.h"
#include "formats/morph_shapes.h"
#include "formats/scene.h"
#include "geometry/error.h"
#include "geometry/text.h"

namespace fascia::cli {

namespace {

FitTargets cache_targets(const Common& common, const std::filesystem::path& path, const TargetMaker& maker,
                         double fps) {
  const auto caches =
      std::make_shared<const std::vector<FitCache>>(open_caches(common, path, fps, maker.subject()));
  FitTargets targets;
  targets.kind = FitTargets::Kind::take;
  targets.times = caches->front().cache.times;
  for (size_t f = 0; f < targets.times.size(); ++f)
    targets.names.push_back("frame " + std::to_string(f));
  targets.target = [caches, maker](size_t frame) {
    fit::Target target = maker.none();
    for (const FitCache& file : *caches)
      for (const Match& match : file.matches)
        for (size_t v = 0; v < match.point.size(); ++v)
          maker.put(target, maker.subject().first_vertex(match.primitive) + v,
                    file.cache.point(frame, match.point[v]));
    return maker.finished(std::move(target));
  };
  return targets;
}

/// Names in the order of the numbers in them: frame_2 before frame_10.
bool comes_before(const std::filesystem::path& first, const std::filesystem::path& second) {
  const std::string a = first.filename().string(), b = second.filename().string();
  const auto is_digit = [](char c) { return c >= '0' && c <= '9'; };
  for (size_t i = 0, j = 0; i < a.size() && j < b.size();) {
    if (!is_digit(a[i]) || !is_digit(b[j])) {
      if (a[i] != b[j]) return a[i] < b[j];
      ++i, ++j;
      continue;
    }
    const auto number = [&](const std::string& text, size_t& at) {
      while (at + 1 < text.size() && text[at] == '0' && is_digit(text[at + 1]))
        ++at;
      const size_t from = at;
      while (at < text.size() && is_digit(text[at]))
        ++at;
      return text.substr(from, at - from);
    };
    const std::string m = number(a, i), n = number(b, j);
    if (m != n) return m.size() != n.size() ? m.size() < n.size() : m < n;
  }
  return a.size() != b.size() ? a.size() < b.size() : a < b;
}

FitTargets sequence_targets(const std::filesystem::path& folder, const TargetMaker& maker,
                            const FitTargetOptions& options) {
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    const std::string extension = extension_of(entry.path());
    if (entry.is_regular_file() && (extension == ".obj" || extension == ".ply" || extension == ".glb"))
      files.push_back(entry.path());
  }
  if (files.empty()) throw Error("the folder '" + folder.string() + "' holds no OBJ, PLY or GLB frames");
  std::sort(files.begin(), files.end(), comes_before);
  FitTargets targets;
  targets.kind = FitTargets::Kind::take;
  for (size_t f = 0; f < files.size(); ++f) {
    targets.names.push_back(files[f].filename().string());
    targets.times.push_back(static_cast<double>(f) / options.fps);
  }
  targets.target = [files, maker, reading = reading_options(options.allow_outside)](size_t frame) {
    return maker.of_scene(formats::read(files[frame], reading));
  };
  return targets;
}

/// Targets of a glTF file's morph targets, alone or as its animation weighs them.
class MorphTargets {
 public:
  MorphTargets(const formats::Scene& scene, const std::vector<formats::Shape>& list, const TargetMaker& maker)
      : base(maker.of_scene(scene)) {
    const std::vector<Match> found = matches(scene, maker.subject());
    for (const formats::Shape& shape : list) {
      shapes_.emplace_back();
      for (const formats::ShapePart& part : shape.parts)
        for (const Match& match : found)
          add(scene, shape.name, part, match, maker);
    }
  }

  /// Adds the displacements of a shape, `weight` times.
  void add(size_t shape, double weight, fit::Target& target) const {
    for (const Piece& piece : shapes_[shape])
      target.displacements.segment(piece.first, piece.moved.size()) += weight * piece.moved;
  }
  fit::Target of_shape(size_t shape) const {
    fit::Target target = base;
    target.displacements.setZero();
    add(shape, 1.0, target);
    return target;
  }
  double base_motion() const {
    return base.displacements.size() > 0 ? base.displacements.cwiseAbs().maxCoeff() : 0.0;
  }

  fit::Target base;

 private:
  struct Piece {
    Eigen::Index first;     ///< coordinate of the subject
    Eigen::VectorXd moved;  ///< from the file's base mesh
  };

  void add(const formats::Scene& scene, const std::string& name, const formats::ShapePart& part,
           const Match& match, const TargetMaker& maker) {
    const formats::SceneMesh& mesh = scene.meshes[match.mesh];
    if (mesh.mesh != part.mesh || mesh.primitive != part.primitive) return;
    if (part.displacements.size() != mesh.positions.size())
      throw Error("'" + scene.path.string() + "': the morph target '" + name +
                  "' has another number of vertices than its mesh");
    const Mat3 linear = maker.to_metres(scene).topLeftCorner<3, 3>() * mesh.to_file.topLeftCorner<3, 3>();
    Piece piece{static_cast<Eigen::Index>(3 * maker.subject().first_vertex(match.primitive)),
                Eigen::VectorXd(3 * static_cast<Eigen::Index>(match.point.size()))};
    for (size_t v = 0; v < match.point.size(); ++v)
      piece.moved.segment<3>(static_cast<Eigen::Index>(3 * v)) = linear * part.displacements[match.point[v]];
    shapes_.back().push_back(std::move(piece));
  }

  std::vector<std::vector<Piece>> shapes_;
};

/// A target for every key of a file's animated morph targets.
FitTargets animation_targets(const formats::Scene& scene, formats::ShapeCurves&& read,
                             const TargetMaker& maker) {
  const auto curves = std::make_shared<const formats::ShapeCurves>(std::move(read));
  const auto morphs = std::make_shared<const MorphTargets>(scene, curves->shapes, maker);
  FitTargets targets;
  targets.kind = FitTargets::Kind::take;
  targets.times = curves->times;
  for (size_t f = 0; f < curves->times.size(); ++f)
    targets.names.push_back("frame " + std::to_string(f));
  targets.target = [morphs, curves, maker](size_t frame) {
    fit::Target target = morphs->base;
    for (size_t s = 0; s < curves->shapes.size(); ++s)
      if (curves->weights[frame][s] != 0.0) morphs->add(s, curves->weights[frame][s], target);
    return maker.finished(std::move(target));
  };
  return targets;
}

}  // namespace

FitTargets open_fit_targets(const Common& common, const std::filesystem::path& path,
                            const fit::Subject& subject, const FitTargetOptions& options) {
  const TargetMaker maker(subject, options.head_pose != "fixed");
  const std::string extension = extension_of(path);
  if (std::filesystem::is_directory(path)) return sequence_targets(path, maker, options);
  if (extension == ".pc2" || extension == ".mdd") return cache_targets(common, path, maker, options.fps);
  const auto scene =
      std::make_shared<formats::Scene>(formats::read(path, reading_options(options.allow_outside)));
  if (options.as == "take" || options.as == "auto")
    if (formats::ShapeCurves curves = formats::shape_curves(*scene);
        curves.times.size() > (options.as == "take" ? 0 : 1))
      return animation_targets(*scene, std::move(curves), maker);
  const std::vector<formats::Shape> shapes = formats::morph_shapes(*scene);
  FitTargets targets;
  if ((options.as == "shapes" || options.as == "take") && shapes.empty())
    throw Error("'" + path.string() + "' has no morph targets to fit: use --as mesh");
  if (options.as == "take")
    throw Error("'" + path.string() + "' has no animation of morph weights: use --as shapes");
  if (shapes.empty() || options.as == "mesh") {
    targets.names = {path.filename().string()};
    targets.target = [scene, maker](size_t) { return maker.of_scene(*scene); };
    return targets;
  }
  const auto morphs = std::make_shared<const MorphTargets>(*scene, shapes, maker);
  if (options.as == "auto" && morphs->base_motion() > 1e-4) {  // a posed head that has morph targets besides
    common.warn("'" + path.string() +
                "' is posed and has morph targets: the pose is fitted; use --as shapes for the "
                "morph targets");
    targets.names = {path.filename().string()};
    targets.target = [morphs](size_t) { return morphs->base; };
    return targets;
  }
  targets.kind = FitTargets::Kind::shapes;
  for (const formats::Shape& shape : shapes)
    targets.names.push_back(shape.name);
  targets.target = [morphs](size_t index) { return morphs->of_shape(index); };
  return targets;
}

}  // namespace fascia::cli
