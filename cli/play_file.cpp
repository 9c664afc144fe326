#include "cli/play_file.h"

#include <algorithm>
#include <cmath>

#include "cli/gltf_edit.h"
#include "cli/take/point_cache.h"
#include "cli/take/take_animation.h"
#include "formats/scene.h"
#include "geometry/error.h"
#include "geometry/text.h"
#include "rig/read/read.h"
#include "rig/write/write.h"

namespace fascia::cli {

namespace {

constexpr double tolerance_mm = 0.1;  ///< of the written motion, at any vertex of any frame

void write_caches(const Common& common, const PlayRequest& request, CacheKind kind, const Take& take,
                  Face& face, PlayFigures& figures) {
  std::vector<float> times;
  for (size_t f = 0; f < take.frames(); ++f)
    times.push_back(static_cast<float>(take.time(f)));
  PointCaches caches(request.output, kind, cached_objects(common, request.rig, face), times);
  {
    Progress progress(common, "frame", take.frames());
    const PerformanceFigures played = perform(take, face, progress, [&](size_t) { caches.add(face); });
    figures.resets = played.resets;
    figures.milliseconds_a_frame = played.milliseconds_a_frame;
  }
  figures.files = caches.finish();
}

/// The largest error of all meshes, and what more targets would do.
void look_at_errors(const Take& take, const Recording& recording, PlayFigures& figures) {
  bool is_known = true;
  for (const MeshMotion& motion : recording.meshes) {
    figures.components = std::max(figures.components, static_cast<size_t>(motion.weights.rows()));
    if (motion.wanted == 0) is_known = false;
    figures.wanted = std::max(figures.wanted, motion.wanted);
    figures.keys = std::max(figures.keys, motion.keys.size());
    if (1e3 * motion.largest_error <= figures.largest_error_mm) continue;
    figures.largest_error_mm = 1e3 * motion.largest_error;
    figures.largest_error_seconds = take.time(motion.largest_error_frame);
  }
  if (!is_known) figures.wanted = 0;
}

/// The head turns about the joint of the jaw, which lies a little before and above the joint of the neck.
std::vector<NodeMotion> turned_nodes(const PlayRequest& request, const Take& take, const Face& face,
                                     GltfEdit& edit) {
  const rig::RigFile file = rig::read(formats::read_bytes(request.rig), request.rig.string());
  fascia_asset_info info = {};
  info.struct_size = sizeof info;
  check(fascia_asset_get_info(face.asset(), &info), "rig");
  const Mat4 to_metres = Eigen::Map<const Eigen::Matrix4f>(info.input_to_metres).cast<double>();
  const Vec3 pivot = (to_metres.inverse() * file.rig.skull.jaw.origin.cast<double>().homogeneous()).head<3>();
  Eigen::Matrix3d axes = to_metres.topLeftCorner<3, 3>();
  axes /= axes.col(0).norm();
  std::vector<uint32_t> meshes;
  for (const FaceMesh& mesh : face.meshes())
    meshes.push_back(mesh.mesh);
  return head_motion(edit.json, take, meshes, axes, pivot);
}

void write_animation(const Common& common, const PlayRequest& request, const Take& take, Face& face,
                     PlayFigures& figures) {
  // The second face is gone when the take is played: it takes memory.
  std::vector<MeshOfFile> meshes =
      meshes_of_file(face, Face(request.rig, {FASCIA_SPACE_METRES, request.solver, request.level}));
  Recording recording =
      record(common, take, face, std::move(meshes), {request.most_targets, 1e-3 * tolerance_mm});
  look_at_errors(take, recording, figures);
  figures.resets = recording.figures.resets;
  figures.milliseconds_a_frame = recording.figures.milliseconds_a_frame;

  common.progress("writing");
  GltfEdit edit(rig::glb_source(face.file(), request.rig.string()));
  std::vector<std::string> warnings;
  std::vector<NodeMotion> nodes;
  if (request.keeps_head) nodes = turned_nodes(request, take, face, edit);
  add_take(edit, request.curves.stem().string(), take, face, std::move(recording), nodes, warnings);
  for (const std::string& warning : warnings)
    common.warn(warning);
  const GltfEdit::Parts parts = edit.parts();
  formats::write_parts(request.output, {parts.before, parts.binary, parts.after});
  figures.files = {request.output};
}

void say_how_far_off(const Common& common, const PlayRequest& request, const PlayFigures& figures) {
  if (figures.largest_error_mm <= tolerance_mm) return;
  const std::string more = figures.wanted > figures.components
                               ? "--targets " + std::to_string(figures.wanted) + " would be within 0.1 mm"
                               : "more (--targets) come closer";
  char line[320];
  std::snprintf(
      line, sizeof line,
      "%zu morph targets are up to %.2f mm off the simulated motion (at %.2f s); %s, a cache (-o %s.pc2) "
      "is exact",
      figures.components, figures.largest_error_mm, figures.largest_error_seconds, more.c_str(),
      request.output.stem().c_str());
  common.warn(line);
}

struct TakeLayer {
  std::filesystem::path file;
  double weight = 1.0;
};

/// FILE or FILE=WEIGHT. A file may have "=" in its name: what follows the last one is a weight if it is a
/// number.
TakeLayer layer_from(const std::string& word) {
  const size_t at = word.rfind('=');
  if (at != std::string::npos && at > 0 && at + 1 < word.size()) {
    char* end = nullptr;
    const double weight = std::strtod(word.c_str() + at + 1, &end);
    if (*end == 0) {
      if (!(weight >= 0.0 && weight <= 10.0)) throw Error("--layer '" + word + "': a weight is 0 to 10");
      return {word.substr(0, at), weight};
    }
  }
  return {word, 1.0};
}

std::vector<TakeLayer> take_layers(const PlayRequest& request) {
  std::vector<TakeLayer> layers;
  for (const std::string& word : request.layers)
    layers.push_back(layer_from(word));
  return layers;
}

/// What holds under the curves, and what is added to them.
void complete(const Common& common, const PlayRequest& request, const std::vector<TakeLayer>& layers,
              Face& face, Curves& curves, PlayFigures& figures) {
  std::vector<std::pair<std::string, double>> held = activations(request.set, request.values);
  set_all(common, face, held);
  curves.hold(std::move(held));
  curves.scale(request.weight);
  for (const TakeLayer& layer : layers) {
    Curves added(layer.file);
    added.scale(layer.weight);
    const MatchedNames names = match(common, added, face, layer.file);
    for (const auto& [from, to] :
         {std::pair(&names.matched, &figures.matched), std::pair(&names.unmatched, &figures.unmatched)})
      for (const std::string& name : *from)
        if (std::find(to->begin(), to->end(), name) == to->end()) to->push_back(name);
    curves.add(std::move(added));
  }
}

}  // namespace

PlayFigures play_file(const Common& common, const PlayRequest& request) {
  const std::vector<TakeLayer> layers = take_layers(request);
  std::vector<std::filesystem::path> inputs = {request.rig, request.curves, request.values};
  for (const TakeLayer& layer : layers)
    inputs.push_back(layer.file);
  check_output(request.output, inputs);
  CacheKind kind{};
  const bool wants_cache = is_cache(request.output, kind);
  if (!wants_cache && extension_of(request.output) != ".glb")
    throw Error("'" + request.output.string() + "': an animation is written as .glb, .pc2 or .mdd");
  Curves curves(request.curves, request.curve_frames_per_second, request.time_unit);
  PlayFigures figures;
  Face face(request.rig,
            {wants_cache ? FASCIA_SPACE_INPUT : FASCIA_SPACE_MESH, request.solver, request.level});
  const MatchedNames names = match(common, curves, face, request.curves);
  figures.matched = names.matched;
  figures.unmatched = names.unmatched;
  complete(common, request, layers, face, curves, figures);
  curves.trim(request.from, request.to);
  if (!request.keeps_head && !wants_cache && curves.head_moves())
    common.warn("the curves turn the head, which is left out; --head keeps it as motion of the file's nodes");
  if (request.keeps_head && (wants_cache || !curves.turns_head()))
    throw Error("--head: " + std::string(wants_cache
                                             ? "a point cache holds no nodes; write .glb"
                                             : "no curve turns the head (HeadYaw, HeadPitch, HeadRoll)"));
  const Take take{curves, request.frames_per_second};
  figures.frames = take.frames();
  figures.duration = take.time(take.frames() - 1);
  figures.start = curves.start();
  Progress progress(common, "play",
                    {{"simulation", 1.0},
                     {"principal components", wants_cache ? 0.0 : 0.2},
                     {"weights", wants_cache ? 0.0 : 1.0},
                     {"writing", 0.2}});
  progress.begin("simulation");
  if (wants_cache)
    write_caches(common, request, kind, take, face, figures);
  else
    write_animation(common, request, take, face, figures);
  if (figures.resets > 0)
    common.warn("the simulation had to be put back to rest " + std::to_string(figures.resets) + " times");
  say_how_far_off(common, request, figures);
  return figures;
}

}  // namespace fascia::cli
