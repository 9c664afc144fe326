/// \file
/// Fascia's runtime for C++20: faces. Included by fascia/fascia.hpp.
#ifndef FASCIA_FACE_HPP
#define FASCIA_FACE_HPP

#include "fascia/asset.hpp"

namespace fascia::api {

/// One instance of a rig; movable, not copyable. For one thread at a time.
class Face {
 public:
  /// Creates a face at rest: see fascia_face_create.
  explicit Face(const Asset& asset, const fascia_face_options& options = fascia_default_face_options())
      : asset_(asset) {
    fascia_face* handle = nullptr;
    check(fascia_face_create(asset.handle(), &options, &handle));
    handle_.reset(handle);
    channel_count_ = asset.channels().count;
  }

  /// The rig of the face.
  const Asset& asset() const { return asset_; }

  /// The face's own channel values, which may be read and written; valid during its lifetime.
  std::span<float> values() { return {fascia_face_values(handle()), channel_count_}; }
  /// The channel values used by the last pose, step or reset; valid during the face's lifetime.
  std::span<const float> effective_values() const {
    return {fascia_face_effective_values(handle()), channel_count_};
  }
  /// Sets a channel or a member ("arkit:jawOpen") by name: see fascia_face_set. Throws Error if the rig has
  /// neither.
  void set(const std::string& name, float value) { check(fascia_face_set(handle(), name.c_str(), value)); }
  /// Sets a member of a set by their indices (see Asset::set).
  void set_member(std::uint32_t set, std::uint32_t member, float value) {
    check(fascia_face_set_member(handle(), set, member, value));
  }
  /// The value last set by that name. Throws Error if the rig has no such channel or member.
  float get(const std::string& name) const {
    float value = 0.0F;
    check(fascia_face_get(handle(), name.c_str(), &value));
    return value;
  }
  /// Sets every channel to its rest value and every member to 0.
  void clear() { check(fascia_face_clear(handle())); }

  /// Adds layer `index` (1 to 7), or changes how it is combined: see fascia_face_set_layer. `mask` has a
  /// weight for each channel, or is empty.
  void set_layer(std::uint32_t index, fascia_combine combine, float weight = 1.0F,
                 std::span<const float> mask = {}) {
    if (!mask.empty() && mask.size() != channel_count_)
      throw Error(FASCIA_ERROR_ARGUMENT, "the mask has not one weight a channel");
    auto layer = sized<fascia_layer>();
    layer.combine = combine;
    layer.weight = weight;
    layer.mask = mask.empty() ? nullptr : mask.data();
    check(fascia_face_set_layer(handle(), index, &layer));
  }
  /// A layer's own values; empty if there is no such layer. Valid during the face's lifetime.
  std::span<float> layer_values(std::uint32_t layer) {
    float* const values = fascia_face_layer_values(handle(), layer);
    return {values, values == nullptr ? 0 : channel_count_};
  }
  /// Sets a value of a layer by name, as set. Throws Error if there is no such layer or name.
  void layer_set(std::uint32_t layer, const std::string& name, float value) {
    check(fascia_face_layer_set(handle(), layer, name.c_str(), value));
  }
  /// Sets a member in a layer by its set's index and its own. Throws Error if there is no such layer.
  void layer_set_member(std::uint32_t layer, std::uint32_t set, std::uint32_t member, float value) {
    check(fascia_face_layer_set_member(handle(), layer, set, member, value));
  }
  /// Sets every channel of a layer to rest and every member to 0. Throws Error if there is no such layer.
  void layer_clear(std::uint32_t layer) { check(fascia_face_layer_clear(handle(), layer)); }
  /// Removes a layer (1 to 7): see fascia_face_layer_remove. Throws Error if there is no such layer.
  void layer_remove(std::uint32_t layer) { check(fascia_face_layer_remove(handle(), layer)); }
  /// Adds the curves' values at `seconds`, times `weight`, to the input of the next pose or step: see
  /// fascia_curves_apply. Throws Error if there is no such layer.
  void apply(const Curves& curves, double seconds, float weight = 1.0F, std::uint32_t layer = 0) {
    check(fascia_curves_apply_to_layer(curves.handle(), seconds, weight, handle(), layer));
  }
  /// Rotates both eyes toward a point, metres in the head's frame, to the extent of `weight` (0 to 1), from
  /// the next pose or step on.
  void look_at(const Vector3& point, float weight = 1.0F) {
    check(fascia_face_look_at(handle(), point.data(), weight));
  }
  /// Ends the effect of look_at.
  void look_nowhere() { check(fascia_face_look_at(handle(), nullptr, 0.0F)); }
  /// Changes the factor applied to all inputs to `share` (0, at rest, to 1) over `seconds` of steps.
  void blend(float share, float seconds) { check(fascia_face_blend(handle(), share, seconds)); }

  /// Solves for the static equilibrium at the current values.
  void pose() { check(fascia_face_pose(handle())); }
  /// Advances the simulation by `seconds` (0 to 1). False if it was reset to rest (FASCIA_ERROR_DIVERGED).
  bool step(float seconds) {
    const fascia_result result = fascia_face_step(handle(), seconds);
    if (result == FASCIA_ERROR_DIVERGED) return false;
    check(result);
    return true;
  }
  /// Removes all motion and resets the tissue to rest on the jaw: after a cut or a teleport.
  void reset() { check(fascia_face_reset(handle())); }
  /// Sets the pose of the head in the world, metres, from the head's frame: see fascia_face_move_head.
  /// `inertia_scale` 1 is physical, 0 none.
  void move_head(const Matrix4& place, float inertia_scale = 1.0F) {
    check(fascia_face_move_head(handle(), place.data(), inertia_scale));
  }
  /// Inertial acceleration of the tissue in the head's frame, m/s^2; kept until it is set again: zeros for
  /// none.
  void set_acceleration(const Vector3& acceleration) {
    check(fascia_face_set_acceleration(handle(), acceleration.data()));
  }
  /// Applies a force in newtons, in the rig's axes, to a vertex until touches are cleared: see
  /// fascia_face_touch. Throws Error if there are too many.
  void touch(std::uint32_t mesh, std::uint32_t vertex, const Vector3& force) {
    check(fascia_face_touch(handle(), mesh, vertex, force.data()));
  }
  /// Removes the forces of touch.
  void clear_touches() { check(fascia_face_clear_touches(handle())); }
  /// Switches to another level of detail (-1 the finest), blending the vertices over `seconds` of steps.
  void set_level(std::int32_t level, float seconds = 0.25F) {
    check(fascia_face_set_level(handle(), level, seconds));
  }
  /// The current level of detail.
  std::int32_t level() const { return fascia_face_level(handle()); }

  /// The complete state on which the next steps depend: see fascia_face_save. Throws Error with Bullet.
  std::vector<std::uint8_t> save() {
    std::size_t size = 0;
    check(fascia_face_save(handle(), nullptr, 0, &size));
    std::vector<std::uint8_t> bytes(size);
    check(fascia_face_save(handle(), bytes.data(), bytes.size(), &size));
    return bytes;
  }
  /// Restores a saved state. Throws Error if the bytes are damaged or of another kind of face.
  void restore(std::span<const std::uint8_t> bytes) {
    check(fascia_face_restore(handle(), bytes.data(), bytes.size()));
  }

  /// Vertex positions of a mesh in the face's space. Like the two following, a view of the face's memory,
  /// valid during its lifetime, whose contents change with each pose or step.
  std::span<const Vector3> positions(std::uint32_t mesh) {
    return view<Vector3>(fascia_face_positions, mesh);
  }
  /// Unit vertex normals; call it again after a pose or step.
  std::span<const Vector3> normals(std::uint32_t mesh) { return view<Vector3>(fascia_face_normals, mesh); }
  /// Unit tangents with their handedness, empty if the mesh has none; call it again after a pose or step.
  std::span<const Vector4> tangents(std::uint32_t mesh) { return view<Vector4>(fascia_face_tangents, mesh); }
  /// Compression of the skin at each vertex: see fascia_face_compression. There is one list for each mesh,
  /// valid during the face's lifetime, which the next call for the same mesh updates.
  std::span<const Vector3> compression(std::uint32_t mesh) {
    return view<Vector3>(fascia_face_compression, mesh);
  }
  /// Copies positions to `to`, which has space for at least the mesh's vertices. Throws Error if it has less.
  void write_positions(std::uint32_t mesh, std::span<Vector3> to) {
    write_positions(mesh, to.data(), sizeof(Vector3), to.size());
  }
  /// The same every `stride` bytes (12 or more) into memory for `capacity` vertices.
  void write_positions(std::uint32_t mesh, void* to, std::size_t stride, std::size_t capacity) {
    check(fascia_face_write_positions(handle(), mesh, to, stride, capacity));
  }
  /// Copies normals, as write_positions.
  void write_normals(std::uint32_t mesh, std::span<Vector3> to) {
    write_normals(mesh, to.data(), sizeof(Vector3), to.size());
  }
  /// The same every `stride` bytes (12 or more) into memory for `capacity` vertices.
  void write_normals(std::uint32_t mesh, void* to, std::size_t stride, std::size_t capacity) {
    check(fascia_face_write_normals(handle(), mesh, to, stride, capacity));
  }
  /// Copies tangents, as write_positions; nothing if the mesh has none.
  void write_tangents(std::uint32_t mesh, std::span<Vector4> to) {
    write_tangents(mesh, to.data(), sizeof(Vector4), to.size());
  }
  /// The same every `stride` bytes (16 or more) into memory for `capacity` vertices.
  void write_tangents(std::uint32_t mesh, void* to, std::size_t stride, std::size_t capacity) {
    check(fascia_face_write_tangents(handle(), mesh, to, stride, capacity));
  }

  /// Points of the level's fibres (see Asset::fibres), metres; call it again after a pose or step. Valid
  /// until the level changes, like nodes.
  std::span<const Vector3> fibre_points() { return listed(fascia_face_fibre_points); }
  /// Positions of the level's nodes (see Asset::lattice), metres; call it again after a pose or step.
  std::span<const Vector3> nodes() { return listed(fascia_face_nodes); }
  /// Potential energy in the current state, joules, by element type.
  fascia_energies energies() {
    auto energies = sized<fascia_energies>();
    check(fascia_face_energies(handle(), &energies));
    return energies;
  }
  /// The sum of all forces on each node, newtons: see fascia_face_node_forces.
  std::vector<Vector3> node_forces() {
    std::vector<Vector3> forces(asset_.level(static_cast<std::uint32_t>(level())).node_count);
    check(fascia_face_node_forces(handle(), forces.empty() ? nullptr : forces.front().data(), forces.size()));
    return forces;
  }
  /// Tension of each fibre, newtons.
  std::vector<float> fibre_forces() {
    std::vector<float> forces(asset_.level(static_cast<std::uint32_t>(level())).fibre_count);
    check(fascia_face_fibre_forces(handle(), forces.data(), forces.size()));
    return forces;
  }
  /// The derivative of a loss by every channel after a pose: see fascia_face_gradient. `slopes` has an entry
  /// for each mesh: the loss's derivative by that mesh's positions, or nothing. Throws Error if a size is
  /// wrong.
  std::vector<float> gradient(std::span<const std::span<const Vector3>> slopes) {
    std::vector<const float*> lists;
    for (std::uint32_t mesh = 0; mesh < slopes.size(); ++mesh) {
      if (!slopes[mesh].empty() && slopes[mesh].size() != asset_.mesh(mesh).vertex_count)
        throw Error(FASCIA_ERROR_ARGUMENT, "the slopes of a mesh are not one for each vertex");
      lists.push_back(slopes[mesh].empty() ? nullptr : slopes[mesh].front().data());
    }
    if (lists.size() != asset_.info().mesh_count)
      throw Error(FASCIA_ERROR_ARGUMENT, "the slopes are not one list for each mesh");
    std::vector<float> by_channel(channel_count_);
    check(fascia_face_gradient(handle(), lists.data(), by_channel.data()));
    return by_channel;
  }
  /// Those derivatives by the members of a set: see fascia_face_member_gradient. `by_channel` is what
  /// gradient returned.
  std::vector<float> member_gradient(std::uint32_t set, std::span<const float> by_channel) const {
    if (by_channel.size() != channel_count_)
      throw Error(FASCIA_ERROR_ARGUMENT, "the derivatives are not one for each channel");
    std::vector<float> by_member(asset_.set(set).member_count);
    check(fascia_face_member_gradient(handle(), set, by_channel.data(), by_member.data()));
    return by_member;
  }

  /// Pose of the mandible: a rigid transform in metres.
  Matrix4 jaw() const {
    Matrix4 matrix{};
    check(fascia_face_jaw(handle(), matrix.data()));
    return matrix;
  }

  /// The face in the C interface; not to be released.
  fascia_face* handle() const { return handle_.get(); }

 private:
  template <class Vector, class Function>
  std::span<const Vector> view(Function function, std::uint32_t mesh) {
    auto vectors = sized<fascia_vectors>();
    check(function(handle(), mesh, &vectors));
    return {reinterpret_cast<const Vector*>(vectors.data), vectors.count};
  }

  template <class Function>
  std::span<const Vector3> listed(Function function) {
    auto vectors = sized<fascia_vectors>();
    check(function(handle(), &vectors));
    return {reinterpret_cast<const Vector3*>(vectors.data), vectors.count};
  }

  struct Release {
    void operator()(fascia_face* face) const { fascia_face_release(face); }
  };
  Asset asset_;
  std::unique_ptr<fascia_face, Release> handle_;
  std::size_t channel_count_ = 0;
};

/// Advances many faces by `seconds` (0 to 1) through the host's tasks, or on this thread: see
/// fascia_faces_step. `faces` are handles, so that a frame allocates nothing. False if any face was reset to
/// rest (FASCIA_ERROR_DIVERGED).
inline bool faces_step(std::span<fascia_face* const> faces, float seconds,
                       const fascia_tasks* tasks = nullptr) {
  const fascia_result result =
      fascia_faces_step(faces.data(), static_cast<std::uint32_t>(faces.size()), seconds, tasks);
  if (result == FASCIA_ERROR_DIVERGED) return false;
  check(result);
  return true;
}

}  // namespace fascia::api

#endif
