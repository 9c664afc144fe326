#pragma once

#include <memory>
#include <vector>

#include "runtime/asset.h"
#include "runtime/bound_mesh.h"
#include "runtime/mixer.h"
#include "runtime/solver.h"
#include "sim/sensitivity.h"
#include "sim/strain.h"

namespace fascia::runtime {

/// One head: its values, its state in time and its meshes. For one thread at a time.
class Face {
 public:
  /// Throws Failure when the options name no level or no solver that is there.
  Face(std::shared_ptr<const Asset> asset, const fascia_face_options& options);

  const Asset& asset() const { return *asset_; }
  std::size_t level() const { return level_; }

  Mixer& mixer() { return mixer_; }
  const Mixer& mixer() const { return mixer_; }
  void set_acceleration(const sim::Vec3& acceleration) { acceleration_ = acceleration; }

  /// Where the head stands from the next step on; see fascia_face_move_head.
  void move_head(const Eigen::Matrix4f& place, float inertia_scale);
  /// Adds a force on a vertex; false when there is no room.
  bool touch(std::size_t mesh, std::size_t vertex, const sim::Vec3& force);
  void clear_touches() { touches_.clear(); }

  void pose();
  /// False when the solver's watchdog had to put the face back.
  bool step(double seconds);
  void reset();

  /// Goes on at another level of detail, at the pose of its present values; the vertices shown go from where
  /// they are to where that has them over `seconds` of steps. Throws Failure when there is no such level.
  void set_level(int32_t level, float seconds);

  /// See sim::StateBytes; false when the solver cannot, or what was read is no state of such a face.
  bool exchange_state(sim::StateBytes& bytes);
  /// False when a state was that of a face with other layers.
  bool has_layers_of(const uint8_t* bytes, std::size_t size) const;
  /// Tells apart faces whose states cannot be exchanged.
  uint64_t state_kind() const;

  const std::vector<Vec3f>& positions(std::size_t mesh) { return meshes_[mesh].positions(bones_); }
  const std::vector<Vec3f>& normals(std::size_t mesh) { return meshes_[mesh].normals(bones_); }
  const std::vector<Vec4f>& tangents(std::size_t mesh) { return meshes_[mesh].tangents(bones_); }
  const MeshShape& shape(std::size_t mesh) const { return meshes_[mesh].shape(); }
  std::size_t vertex_count(std::size_t mesh) const { return meshes_[mesh].vertex_count(); }
  std::size_t mesh_count() const { return meshes_.size(); }
  const std::vector<Vec3f>& fibre_points();
  /// #vertices of the mesh: see fascia_face_compression.
  const std::vector<Vec3f>& compression(std::size_t mesh);
  const sim::RigidTransform& jaw() const { return bones_.jaw; }
  const BonePose& bones() const { return bones_; }

  // For looking into the simulation; these may allocate.
  /// Places of the lattice's nodes as shown, metres. Until the level changes the list stays where it is.
  const std::vector<Vec3f>& nodes();
  const sim::FaceModel& model() const { return *model_; }
  /// What the last pose or step drove the tissue with; spans of it are this face's.
  sim::Controls controls() const;
  /// Where the jaw goes under `channels` (one value each).
  sim::JawPose wanted_jaw(std::span<const float> channels) const;
  const sim::JawPose& shown_jaw() const { return shown_jaw_; }
  /// The equilibrium's derivatives where the face stands, kept until it moves. Throws Failure when they have
  /// none.
  const sim::Sensitivity& sensitivity();

 private:
  /// Takes up a level: its model and a solver on it. The meshes are left as they are.
  void take_level(std::size_t level);
  /// What the head's own motion over `seconds` does to loose tissue, m/s^2 in its frame.
  sim::Vec3 inertia(double seconds);
  /// Takes displacements, jaw and eyes from the solver and the channels.
  void find_bones();
  /// The same, and takes them to the meshes.
  void follow();
  /// How much of where the last level of detail had the vertices is still shown, 1 .. 0.
  float held_share() const;
  std::shared_ptr<const Asset> asset_;
  fascia_face_options options_;
  std::size_t level_ = 0;
  const sim::FaceModel* model_ = nullptr;
  std::unique_ptr<sim::Solver> solver_;
  Mixer mixer_;
  sim::Vec3 acceleration_ = sim::Vec3::Zero(), inertia_ = sim::Vec3::Zero();
  struct HeadMotion {
    Eigen::Matrix4d place = Eigen::Matrix4d::Identity();
    double scale = 0.0;
    sim::Vec3 centre = sim::Vec3::Zero(),
              velocity = sim::Vec3::Zero();  ///< of the face's middle, in the world
    int known = 0;                           ///< how many of place and velocity are
    bool is_moved = false;
  } head_;
  sim::Vec3 face_centre_ = sim::Vec3::Zero();
  std::vector<sim::NodeForce> touches_;
  std::vector<sim::Strain> strain_;
  std::vector<std::vector<Vec3f>> compression_;  ///< of each mesh, where it was asked for
  std::vector<Vec3f> displacements_, fibre_points_, nodes_;
  std::unique_ptr<sim::Sensitivity> sensitivity_;
  bool is_linearised_ = false;
  BonePose bones_;
  sim::JawPose jaw_;        ///< where the frame's drive has it
  sim::JawPose shown_jaw_;  ///< where the tissue shown has it: up to a substep before
  std::vector<BoundMesh> meshes_;
  float fade_length_ = 0.0F, fade_passed_ = 0.0F;  ///< seconds: of the change of level
};

/// Rotation of an eye: yaw to the subject's left about +Y, then pitch upward about the head's lateral axis.
Eigen::Matrix3f eye_rotation(float yaw, float pitch);

}  // namespace fascia::runtime

struct fascia_face {
  std::unique_ptr<fascia::runtime::Face> face;
  bool is_listed = false;  ///< while a list of faces is looked through
  fascia::runtime::CountedHandle counted{};
};
