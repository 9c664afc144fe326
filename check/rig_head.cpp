#include "check/rig_head.h"

#include <fascia/fascia.hpp>

#include <Eigen/LU>

#include <algorithm>
#include <cmath>
#include <mutex>

#include "geometry/error.h"
#include "rig/read/read.h"

namespace fascia::check {
namespace {

using api::sized;

std::optional<Eye> eye_of(const rig::Eye& eye) {
  if (!(eye.radius > 0.0F)) return {};
  return Eye{eye.centre.cast<double>(), static_cast<double>(eye.radius), eye.gaze.cast<double>()};
}

}  // namespace

using FaceHandle = std::unique_ptr<fascia_face, decltype(&fascia_face_release)>;

struct RigHead::State {
  /// Where the vertices of a Part come from.
  struct Source {
    uint32_t mesh = 0;               ///< as the runtime counts
    std::vector<uint32_t> vertices;  ///< of it
  };

  std::string name;
  rig::RigFile file;
  std::unique_ptr<fascia_asset, decltype(&fascia_asset_release)> asset{nullptr, fascia_asset_release};
  FaceHandle face{nullptr, fascia_face_release};  ///< at rest, while the parts are made
  int32_t level = -1;
  Head head;
  std::vector<Source> sources;
  std::mutex mutex;
  std::vector<FaceHandle> idle;  ///< faces that no pose is played on

  void require(fascia_result result) const {
    if (result != FASCIA_OK) throw Error(name + ": " + fascia_last_message());
  }

  FaceHandle new_face(fascia_space space) const {
    fascia_face_options options = fascia_default_face_options();
    options.space = space;
    options.level = level;
    fascia_face* made = nullptr;
    require(fascia_face_create(asset.get(), &options, &made));
    return {made, fascia_face_release};
  }

  /// A face that no other thread uses.
  FaceHandle take_face() {
    {
      const std::lock_guard lock(mutex);
      if (!idle.empty()) {
        FaceHandle taken = std::move(idle.back());
        idle.pop_back();
        return taken;
      }
    }
    return new_face(FASCIA_SPACE_METRES);
  }

  void give_back(FaceHandle taken) {
    const std::lock_guard lock(mutex);
    idle.push_back(std::move(taken));
  }

  std::vector<Vec3> positions(fascia_face* from, uint32_t mesh) const {
    auto vectors = sized<fascia_vectors>();
    require(fascia_face_positions(from, mesh, &vectors));
    std::vector<Vec3> out(vectors.count);
    for (size_t v = 0; v < out.size(); ++v)
      out[v] = Vec3(static_cast<double>(vectors.data[3 * v]), static_cast<double>(vectors.data[3 * v + 1]),
                    static_cast<double>(vectors.data[3 * v + 2]));
    return out;
  }

  /// The triangles of a primitive whose vertices all satisfy `belongs`, as a part of their own.
  template <class Belongs>
  void add_part(const std::string& part_name, uint32_t mesh, const std::vector<Vec3>& rest,
                const fascia_mesh_info& info, Belongs belongs, const std::vector<bool>& still) {
    Part part{part_name, {}, {}};
    Source source{mesh, {}};
    std::vector<int> map(rest.size(), -1);
    for (uint32_t t = 0; t < info.triangle_count; ++t) {
      const uint32_t* corner = info.triangles + size_t{3} * t;
      if (!(belongs(corner[0]) && belongs(corner[1]) && belongs(corner[2]))) continue;
      Triangle now;
      for (size_t k = 0; k < 3; ++k) {
        int& v = map[corner[k]];
        if (v < 0) {
          v = part.mesh.vertex_count();
          part.mesh.vertices.push_back(rest[corner[k]]);
          source.vertices.push_back(corner[k]);
        }
        now[k] = v;
      }
      part.mesh.triangles.push_back(now);
    }
    if (part.mesh.triangles.empty()) return;
    for (const uint32_t v : source.vertices)
      part.is_still.push_back(still[v]);
    head.parts.push_back(std::move(part));
    sources.push_back(std::move(source));
  }

  void add_mesh(uint32_t index) {
    auto info = sized<fascia_mesh_info>();
    require(fascia_asset_get_mesh(asset.get(), index, &info));
    const std::vector<Vec3> rest = positions(face.get(), index);
    const rig::Binding* binding = nullptr;
    const auto& bindings = file.rig.tissue.bindings[static_cast<size_t>(level)];
    for (const rig::Binding& one : bindings)
      if (one.mesh == info.mesh && one.primitive == info.primitive) binding = &one;
    std::vector<bool> still(rest.size(), true);
    for (size_t v = 0; binding && v < still.size() && v < binding->vertex_count; ++v)
      still[v] =
          binding->eye[v] == 0 && binding->jaw_weights[v] == 0.0F &&
          std::all_of(binding->weights.begin() + static_cast<std::ptrdiff_t>(v * binding->influences),
                      binding->weights.begin() + static_cast<std::ptrdiff_t>((v + 1) * binding->influences),
                      [](float weight) { return weight == 0.0F; });
    const auto eye = [&](uint32_t v) { return binding ? binding->eye[v] : uint8_t{0}; };
    for (const uint8_t side : {uint8_t{1}, uint8_t{2}})
      add_part(
          side == 1 ? "eye_left" : "eye_right", index, rest, info, [&](uint32_t v) { return eye(v) == side; },
          still);
    add_part(
        info.part, index, rest, info, [&](uint32_t v) { return eye(v) == 0; }, still);
  }
};

RigHead::RigHead(std::span<const uint8_t> bytes, const std::string& name, const std::string& level)
    : state_(std::make_unique<State>()) {
  State& state = *state_;
  state.name = name;
  state.file = rig::read(bytes, name);
  fascia_asset* asset = nullptr;
  state.require(fascia_asset_load(bytes.data(), bytes.size(), &asset));
  state.asset.reset(asset);
  const auto& levels = state.file.rig.tissue.levels;
  state.level = static_cast<int32_t>(levels.size()) - 1;
  for (size_t i = 0; i < levels.size(); ++i)
    if (levels[i].name == level) state.level = static_cast<int32_t>(i);
  if (!level.empty() && (levels.empty() || levels[static_cast<size_t>(state.level)].name != level))
    throw Error(name + ": the rig has no level '" + level + "'; 'fascia info' lists those it has");
  state.face = state.new_face(FASCIA_SPACE_METRES);
  auto info = sized<fascia_asset_info>();
  state.require(fascia_asset_get_info(asset, &info));
  for (uint32_t m = 0; m < info.mesh_count; ++m)
    state.add_mesh(m);
  for (const rig::Landmark& landmark : state.file.rig.skull.landmarks)
    state.head.landmarks[landmark.name] = landmark.skin.cast<double>();
  state.head.eyes = {eye_of(state.file.rig.skull.eye_left), eye_of(state.file.rig.skull.eye_right)};
  state.give_back(std::move(state.face));
}

RigHead::~RigHead() = default;

const Head& RigHead::head() const {
  return state_->head;
}

Player RigHead::player() {
  return [this](const Weights& weights) -> std::optional<Shape> {
    State& state = *state_;
    FaceHandle face = state.take_face();
    state.require(fascia_face_clear(face.get()));
    for (const auto& [name, value] : weights) {
      const fascia_result result =
          fascia_face_set(face.get(), ("arkit:" + name).c_str(), static_cast<float>(value));
      if (result == FASCIA_ERROR_NAME) return std::nullopt;
      state.require(result);
    }
    state.require(fascia_face_pose(face.get()));
    Shape shape;
    uint32_t mesh = UINT32_MAX;
    std::vector<Vec3> whole;
    for (const State::Source& source : state.sources) {
      if (source.mesh != mesh) whole = state.positions(face.get(), mesh = source.mesh);
      std::vector<Vec3>& vertices = shape.emplace_back();
      vertices.reserve(source.vertices.size());
      for (const uint32_t v : source.vertices)
        vertices.push_back(whole[v]);
    }
    state.give_back(std::move(face));
    return shape;
  };
}

double RigHead::rest_motion() const {
  const State& state = *state_;
  const FaceHandle face = state.new_face(FASCIA_SPACE_MESH);
  state.require(fascia_face_pose(face.get()));
  double most = 0.0;
  for (size_t p = 0; p < state.file.primitives.size(); ++p) {
    const rig::Primitive& primitive = state.file.primitives[p];
    double scale = 1.0;
    for (const rig::Binding& binding : state.file.rig.tissue.bindings[static_cast<size_t>(state.level)])
      if (binding.mesh == primitive.mesh && binding.primitive == primitive.primitive)
        scale = std::cbrt(std::abs(static_cast<double>(binding.to_rig.topLeftCorner<3, 3>().determinant())));
    const std::vector<Vec3> now = state.positions(face.get(), static_cast<uint32_t>(p));
    for (size_t v = 0; v < now.size() && v < primitive.positions.size(); ++v)
      most = std::max(most, scale * (now[v] - primitive.positions[v].cast<double>()).norm());
  }
  return most;
}

}  // namespace fascia::check
