#include "cli/play_file.h"

#include <algorithm>
#include <chrono>
#include <cmath>

#include "cli/gltf_edit.h"
#include "cli/motion.h"
#include "formats/scene.h"
#include "geometry/error.h"
#include "rig/write/write.h"

namespace fascia::cli {

namespace {

using Json = nlohmann::ordered_json;

/// Which coordinates of all meshes move at all during the animation.
struct MovingPart {
  size_t mesh;  // in Face::meshes
  std::vector<uint32_t> vertices;
};

struct Recording {
  std::vector<float> times;
  std::vector<std::vector<std::vector<float>>> frames;  // frame, mesh, coordinates: displacement
  std::vector<std::vector<float>> values;               // frame, channel
  std::vector<double> milliseconds;
  int resets = 0;
};

Recording record(const Common& common, Face& face, const Curves& curves, double frames_per_second) {
  Recording recording;
  const size_t channels = face.channel_names().size();
  const int count = static_cast<int>(std::floor(curves.duration() * frames_per_second + 1e-6)) + 1;
  curves.apply(0.0, face);
  face.pose();
  for (int f = 0; f < count; ++f) {
    const double time = f / frames_per_second;
    if (f % 60 == 0) common.progress("playing " + std::to_string(f) + " of " + std::to_string(count));
    if (f > 0) {
      curves.apply(time, face);
      const auto started = std::chrono::steady_clock::now();
      if (!face.step(1.0 / frames_per_second)) ++recording.resets;
      recording.milliseconds.push_back(
          std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - started).count());
    }
    std::vector<std::vector<float>> frame;
    for (size_t m = 0; m < face.meshes().size(); ++m) {
      const std::span<const float> now = face.positions(m), rest = face.rest(m);
      frame.emplace_back(now.size());
      for (size_t i = 0; i < now.size(); ++i)
        frame.back()[i] = now[i] - rest[i];
    }
    recording.times.push_back(static_cast<float>(time));
    recording.frames.push_back(std::move(frame));
    const float* effective = fascia_face_effective_values(face.handle());
    recording.values.emplace_back(effective, effective + channels);
  }
  return recording;
}

std::vector<MovingPart> moving_parts(const Recording& recording) {
  std::vector<MovingPart> parts;
  for (size_t m = 0; m < recording.frames[0].size(); ++m) {
    MovingPart part{m, {}};
    for (size_t v = 0; 3 * v < recording.frames[0][m].size(); ++v) {
      bool moves = false;
      for (const auto& frame : recording.frames)
        moves |= frame[m][3 * v] != 0 || frame[m][3 * v + 1] != 0 || frame[m][3 * v + 2] != 0;
      if (moves) part.vertices.push_back(static_cast<uint32_t>(v));
    }
    if (!part.vertices.empty()) parts.push_back(std::move(part));
  }
  return parts;
}

std::vector<std::vector<float>> gathered(const Recording& recording, const std::vector<MovingPart>& parts) {
  std::vector<std::vector<float>> frames;
  for (const auto& frame : recording.frames) {
    std::vector<float> all;
    for (const MovingPart& part : parts)
      for (uint32_t v : part.vertices)
        all.insert(all.end(), &frame[part.mesh][3 * v], &frame[part.mesh][3 * v] + 3);
    frames.push_back(std::move(all));
  }
  return frames;
}

std::vector<PrimitiveMotion> scattered(const std::vector<float>& shape, const Face& face,
                                       const std::vector<MovingPart>& parts) {
  std::vector<PrimitiveMotion> motions;
  size_t at = 0;
  for (const MovingPart& part : parts) {
    const FaceMesh& mesh = face.meshes()[part.mesh];
    PrimitiveMotion motion{mesh.mesh, mesh.primitive,
                           std::vector<rig::Vec3f>(mesh.vertex_count, rig::Vec3f::Zero())};
    for (uint32_t v : part.vertices) {
      motion.displacement[v] = rig::Vec3f(shape[at], shape[at + 1], shape[at + 2]);
      at += 3;
    }
    motions.push_back(std::move(motion));
  }
  return motions;
}

void add_pointer_channels(GltfEdit& edit, const Recording& recording, size_t time, Json& animation) {
  bool any = false;
  for (size_t c = 0; c < recording.values[0].size(); ++c) {
    std::vector<float> values;
    bool moves = false;
    for (const auto& frame : recording.values) {
      values.push_back(frame[c]);
      moves |= frame[c] != recording.values[0][c];
    }
    if (!moves) continue;
    any = true;
    animation["samplers"].push_back(
        {{"input", time}, {"output", edit.add_floats(values, 1, false)}, {"interpolation", "LINEAR"}});
    const std::string pointer = "/extensions/FASCIA_actuation/channels/" + std::to_string(c) + "/value";
    animation["channels"].push_back(
        {{"sampler", animation["samplers"].size() - 1},
         {"target",
          {{"path", "pointer"}, {"extensions", {{"KHR_animation_pointer", {{"pointer", pointer}}}}}}}});
  }
  if (!any) return;
  Json& used = edit.json["extensionsUsed"];
  if (std::find(used.begin(), used.end(), "KHR_animation_pointer") == used.end())
    used.push_back("KHR_animation_pointer");
}

}  // namespace

Curves::Curves(const std::filesystem::path& path) {
  const std::vector<uint8_t> bytes = formats::read_bytes(path);
  fascia_curves* curves = nullptr;
  check(fascia_curves_load(bytes.data(), bytes.size(), &curves), "'" + path.string() + "'");
  curves_.reset(curves);
  fascia_curves_info info = {};
  info.struct_size = sizeof info;
  check(fascia_curves_get_info(curves, &info), "'" + path.string() + "'");
  names_.assign(info.names, info.names + info.count);
  duration_ = info.duration;
}

double Curves::duration() const {
  return duration_;
}

std::vector<std::string> Curves::unmatched(const Face& face) const {
  std::vector<uint8_t> matched(names_.size());
  uint32_t count = 0;
  check(fascia_curves_match(curves_.get(), face.asset(), &count, matched.data()), "curves");
  std::vector<std::string> names;
  for (size_t i = 0; i < names_.size(); ++i)
    if (!matched[i]) names.push_back(names_[i]);
  return names;
}

void Curves::apply(double seconds, const Face& face) const {
  check(fascia_curves_apply(curves_.get(), seconds, 1.0F, face.handle()), "curves");
}

PlayFigures play_file(const Common& common, const PlayRequest& request) {
  check_output(request.output, {request.rig, request.curves});
  if (request.output.extension() != ".glb")
    throw Error("'" + request.output.string() + "': an animation is written as .glb");
  const Curves curves(request.curves);
  Face face(request.rig, {FASCIA_SPACE_MESH, request.solver, request.level});
  PlayFigures figures;
  figures.unmatched = curves.unmatched(face);
  for (const std::string& name : curves.names())
    if (std::find(figures.unmatched.begin(), figures.unmatched.end(), name) == figures.unmatched.end())
      figures.matched.push_back(name);
  if (figures.matched.empty())
    throw Error("'" + request.curves.string() + "': none of its " + std::to_string(curves.names().size()) +
                " curves has a name that the rig knows; 'fascia info --channels' lists them");
  for (const std::string& name : figures.unmatched)
    common.warn("curve '" + name + "' has no channel in the rig");

  Recording recording = record(common, face, curves, request.frames_per_second);
  figures.frames = static_cast<int>(recording.times.size());
  figures.duration = recording.times.back();
  figures.resets = recording.resets;
  if (!recording.milliseconds.empty()) {
    std::nth_element(
        recording.milliseconds.begin(),
        recording.milliseconds.begin() + static_cast<std::ptrdiff_t>(recording.milliseconds.size() / 2),
        recording.milliseconds.end());
    figures.milliseconds_a_frame = recording.milliseconds[recording.milliseconds.size() / 2];
  }
  if (recording.resets > 0)
    common.warn("the simulation had to be put back to rest " + std::to_string(recording.resets) + " times");

  fascia_asset_info info = {};
  info.struct_size = sizeof info;
  check(fascia_asset_get_info(face.asset(), &info), "rig");
  const double metres = Eigen::Map<const Eigen::Vector3f>(info.input_to_metres).norm();
  const std::vector<MovingPart> parts = moving_parts(recording);
  common.progress("finding principal components");
  const Components components = principal_components(gathered(recording, parts), 64, 1e-4 / metres);
  figures.components = components.shapes.size();
  figures.largest_error_mm = 1e3 * metres * components.largest_error;

  const std::vector<uint8_t> bytes = formats::read_bytes(request.rig);
  GltfEdit edit(rig::glb_source(bytes, request.rig.string()));
  std::vector<std::string> names;
  std::vector<std::vector<PrimitiveMotion>> shapes;
  for (size_t k = 0; k < components.shapes.size(); ++k) {
    names.push_back("motion_" + std::to_string(k));
    shapes.push_back(scattered(components.shapes[k], face, parts));
  }
  gltf::MorphOptions morphs;
  morphs.is_linear = true;
  std::vector<std::string> warnings;
  const std::vector<gltf::MeshTargets> targets =
      gltf::add_morph_targets(edit, names, shapes, morphs, &warnings);
  for (const std::string& warning : warnings)
    common.warn(warning);
  Json animation = {
      {"name", request.curves.stem().string()}, {"samplers", Json::array()}, {"channels", Json::array()}};
  const size_t time = edit.add_floats(recording.times, 1, true);
  gltf::add_weight_channels(edit, targets, components.weights, time, animation);
  add_pointer_channels(edit, recording, time, animation);
  if (!animation["channels"].empty()) edit.json["animations"].push_back(animation);
  const std::vector<uint8_t> out = edit.bytes();
  formats::write_bytes(request.output, out.data(), out.size());
  return figures;
}

}  // namespace fascia::cli
