#include "app/engine/face_session.h"

#include <fascia/research.h>

#include <algorithm>
#include <chrono>
#include <cmath>

#include "geometry/error.h"

namespace fascia::app {

namespace {

template <class T>
T described() {
  T value = {};
  value.struct_size = sizeof value;
  return value;
}

void check(fascia_result result, const std::string& what) {
  if (result != FASCIA_OK) throw Error(what + ": " + fascia_last_message());
}

std::vector<Triangle> triangles_of(const uint32_t* corners, uint32_t count) {
  std::vector<Triangle> triangles(count);
  for (uint32_t t = 0; t < count; ++t)
    for (size_t k = 0; k < 3; ++k)
      triangles[t][k] = static_cast<int>(corners[3 * t + k]);
  return triangles;
}

FaceSurface surface_of(const fascia_asset* asset, const char* name) {
  auto surface = described<fascia_surface>();
  check(fascia_asset_surface(asset, name, &surface), name);
  FaceSurface result;
  for (uint32_t v = 0; v < surface.vertex_count; ++v)
    result.positions.push_back(Eigen::Map<const Eigen::Vector3f>(surface.positions + 3 * v).cast<double>());
  result.triangles = triangles_of(surface.triangles, surface.triangle_count);
  return result;
}

struct FaceRelease {
  void operator()(fascia_face* face) const { fascia_face_release(face); }
};

void copy(const fascia_vectors& from, std::vector<float>& to) {
  to.assign(from.data, from.data + static_cast<size_t>(from.count) * 3);
}

}  // namespace

FaceAsset::FaceAsset(const std::vector<uint8_t>& bytes, const std::string& name) {
  fascia_asset* loaded = nullptr;
  check(fascia_asset_load(bytes.data(), bytes.size(), &loaded), "'" + name + "'");
  asset_.reset(loaded);
  auto info = described<fascia_asset_info>();
  check(fascia_asset_get_info(loaded, &info), name);
  input_to_metres = Eigen::Map<const Eigen::Matrix4f>(info.input_to_metres).cast<double>();
  auto list = described<fascia_channels>();
  check(fascia_asset_get_channels(loaded, &list), name);
  for (uint32_t c = 0; c < list.count; ++c)
    channels.push_back(
        {list.names[c], list.groups[c], list.units[c], list.minimum[c], list.maximum[c], list.rest[c]});
  for (uint32_t s = 0; s < info.set_count; ++s) {
    auto set = described<fascia_set_info>();
    check(fascia_asset_get_set(loaded, s, &set), name);
    sets.push_back({set.name, {set.members, set.members + set.member_count}});
  }
  for (uint32_t l = 0; l < info.level_count; ++l) {
    auto level = described<fascia_level_info>();
    check(fascia_asset_get_level(loaded, l, &level), name);
    levels.emplace_back(level.name);
  }
  cranium = surface_of(loaded, "cranium");
  mandible = surface_of(loaded, "mandible");
  teeth_upper = surface_of(loaded, "teeth_upper");
  teeth_lower = surface_of(loaded, "teeth_lower");
  smas = surface_of(loaded, "smas");
  auto fibres = described<fascia_fibres>();
  check(fascia_asset_fibres(loaded, info.level_count - 1, &fibres), name);
  fibre_offsets.assign(fibres.offsets, fibres.offsets + fibres.fibre_count + 1);
  fibre_channels.assign(fibres.channels, fibres.channels + fibres.fibre_count);
  fibre_muscles.assign(fibres.muscles, fibres.muscles + fibres.fibre_count);
  auto lattice = described<fascia_lattice>();
  check(fascia_asset_lattice(loaded, info.level_count - 1, &lattice), name);
  lattice_columns = lattice.column_count;
  lattice_prisms = triangles_of(lattice.triangles, lattice.triangle_count);
  read_parts(info.mesh_count);
}

void FaceAsset::read_parts(uint32_t count) {
  fascia_face_options options = fascia_default_face_options();
  options.space = FASCIA_SPACE_METRES;
  fascia_face* made = nullptr;
  check(fascia_face_create(asset_.get(), &options, &made), "face");
  const std::unique_ptr<fascia_face, FaceRelease> face(made);
  for (uint32_t m = 0; m < count; ++m) {
    auto mesh = described<fascia_mesh_info>();
    check(fascia_asset_get_mesh(asset_.get(), m, &mesh), "mesh");
    auto positions = described<fascia_vectors>();
    check(fascia_face_positions(made, m, &positions), "mesh");
    FacePart part{mesh.name,
                  mesh.part,
                  mesh.mesh,
                  mesh.primitive,
                  mesh.vertex_count,
                  triangles_of(mesh.triangles, mesh.triangle_count),
                  {}};
    copy(positions, part.rest);
    parts.push_back(std::move(part));
  }
}

int FaceAsset::channel(const std::string& name) const {
  return fascia_asset_find_channel(asset_.get(), name.c_str());
}

FaceChannel FaceAsset::range_of(const std::string& name) const {
  const int index = channel(name);
  if (index >= 0) return channels[static_cast<size_t>(index)];
  return {name, "set", "1", 0.0F, 1.0F, 0.0F};
}

FaceSession::FaceSession(std::shared_ptr<const FaceAsset> asset, fascia_solver solver)
    : asset_(std::move(asset)) {
  fascia_face_options options = fascia_default_face_options();
  options.space = FASCIA_SPACE_METRES;
  options.solver = solver;
  fascia_face* made = nullptr;
  check(fascia_face_create(asset_->handle(), &options, &made), "face");
  face_.reset(made);
  // The first frame is the face at rest, with all there is to see of it.
  FaceInputs all;
  all.wants_nodes = all.wants_compression = true;
  read_frame(all);
}

void FaceSession::apply(const FaceInputs& inputs) {
  fascia_face* face = face_.get();
  if (inputs.resets != resets_) check(fascia_face_reset(face), "reset");
  resets_ = inputs.resets;
  check(fascia_face_clear(face), "clear");
  // A name of another rig or of a later version is left out; so are captured ones that this rig does not
  // know.
  for (const auto* values : {&inputs.live, &inputs.pose})
    for (const auto& [name, value] : *values)
      fascia_face_set(face, name.c_str(), static_cast<float>(value));
  for (const PlayedTake& played : inputs.takes)
    check(
        fascia_curves_apply(played.take->handle(), inputs.take_time, static_cast<float>(played.weight), face),
        "take");
  check(fascia_face_clear_touches(face), "touch");
  const size_t most_touches = 64;
  for (size_t t = 0; t < std::min(inputs.touches.size(), most_touches); ++t) {
    const Touch& touch = inputs.touches[t];
    // The strongest come first; what finds no place any more is left out.
    if (fascia_face_touch(face, touch.mesh, touch.vertex, touch.force.data()) != FASCIA_OK) break;
  }
  check(fascia_face_set_acceleration(face, inputs.acceleration.data()), "acceleration");
  check(fascia_face_move_head(face, inputs.head.data(), 1.0F), "head");
}

void FaceSession::advance(const FaceInputs& inputs, double seconds) {
  const auto started = std::chrono::steady_clock::now();
  apply(inputs);
  const fascia_result result = seconds > 0.0
                                   ? fascia_face_step(face_.get(), static_cast<float>(std::min(seconds, 0.1)))
                                   : fascia_face_pose(face_.get());
  if (result != FASCIA_ERROR_DIVERGED) check(result, "simulation");
  frame_.was_reset = result == FASCIA_ERROR_DIVERGED;
  frame_.step_milliseconds =
      std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - started).count();
  read_frame(inputs);
}

void FaceSession::read_frame(const FaceInputs& inputs) {
  fascia_face* face = face_.get();
  const auto count = static_cast<uint32_t>(asset_->parts.size());
  frame_.positions.resize(count);
  frame_.normals.resize(count);
  frame_.compression.resize(inputs.wants_compression ? count : 0);
  float motion = 0.0F;
  for (uint32_t m = 0; m < count; ++m) {
    auto vectors = described<fascia_vectors>();
    check(fascia_face_positions(face, m, &vectors), "positions");
    std::vector<float>& positions = frame_.positions[m];
    const size_t numbers = static_cast<size_t>(vectors.count) * 3;
    if (positions.size() == numbers)
      for (size_t i = 0; i < numbers; ++i)
        motion = std::max(motion, std::abs(positions[i] - vectors.data[i]));
    else
      motion = 1.0F;
    copy(vectors, positions);
    check(fascia_face_normals(face, m, &vectors), "normals");
    copy(vectors, frame_.normals[m]);
    if (!inputs.wants_compression) continue;
    check(fascia_face_compression(face, m, &vectors), "compression");
    copy(vectors, frame_.compression[m]);
  }
  auto points = described<fascia_vectors>();
  check(fascia_face_fibre_points(face, &points), "fibres");
  copy(points, frame_.fibre_points);
  frame_.nodes.clear();
  if (inputs.wants_nodes) {
    check(fascia_face_nodes(face, &points), "nodes");
    copy(points, frame_.nodes);
  }
  const float* values = fascia_face_effective_values(face);
  frame_.values.assign(values, values + asset_->channels.size());
  check(fascia_face_jaw(face, frame_.jaw.data()), "jaw");
  frame_.largest_motion = static_cast<double>(motion);
  ++frame_.number;
}

}  // namespace fascia::app
