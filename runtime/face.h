#pragma once

#include <memory>
#include <vector>

#include "runtime/asset.h"
#include "runtime/bound_mesh.h"
#include "runtime/solver.h"
#include "sim/strain.h"

namespace fascia::runtime {

/// One head: its values, its state in time and its meshes. For one thread at a time.
class Face {
 public:
  /// Throws Failure when the options name no level or no solver that is there.
  Face(std::shared_ptr<const Asset> asset, const fascia_face_options& options);

  const Asset& asset() const { return *asset_; }
  std::size_t level() const { return level_; }

  std::vector<float>& values() { return values_; }
  const std::vector<float>& effective_values() const { return effective_; }
  void set(const Target& target, float value);
  float get(const Target& target) const;
  void clear();
  /// Adds to what the next pose or step uses.
  void add(const Target& target, float value, float weight);
  /// The same for a channel that `value` has to itself, as far as `weight` (0..1) goes.
  void take_over(uint32_t channel, float value, float weight);
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

  const std::vector<Vec3f>& positions(std::size_t mesh) { return meshes_[mesh].positions(bones_); }
  const std::vector<Vec3f>& normals(std::size_t mesh) { return meshes_[mesh].normals(bones_); }
  std::size_t vertex_count(std::size_t mesh) const { return meshes_[mesh].vertex_count(); }
  std::size_t mesh_count() const { return meshes_.size(); }
  const std::vector<Vec3f>& fibre_points();
  /// #vertices of the mesh: see fascia_face_compression.
  const std::vector<Vec3f>& compression(std::size_t mesh);
  const sim::RigidTransform& jaw() const { return bones_.jaw; }

 private:
  /// Adds up own values, members and curves into `effective_` and uses the curves up.
  void gather();
  sim::Controls controls() const;
  /// Where channels and masticatory muscles want the jaw.
  sim::JawPose wanted_jaw() const;
  /// What the head's own motion over `seconds` does to loose tissue, m/s^2 in its frame.
  sim::Vec3 inertia(double seconds);
  /// Takes displacements, jaw and eyes to the meshes.
  void follow();
  float effective(int32_t channel) const {
    return channel < 0 ? 0.0F : effective_[static_cast<std::size_t>(channel)];
  }

  std::shared_ptr<const Asset> asset_;
  std::size_t level_ = 0;
  const sim::FaceModel* model_ = nullptr;
  std::unique_ptr<sim::Solver> solver_;
  std::vector<float> values_, members_, curve_channels_, curve_members_, effective_;
  std::vector<float> taken_, taken_weight_;  ///< by channel: what has it to itself, and how far
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
  std::vector<Vec3f> compression_;
  std::vector<Vec3f> displacements_, fibre_points_;
  BonePose bones_;
  sim::JawPose jaw_;        ///< where the frame's drive has it
  sim::JawPose shown_jaw_;  ///< where the tissue shown has it: up to a substep before
  std::vector<BoundMesh> meshes_;
};

}  // namespace fascia::runtime

struct fascia_face {
  std::unique_ptr<fascia::runtime::Face> face;
};
