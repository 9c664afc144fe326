#pragma once

#include <memory>
#include <vector>

#include "runtime/asset.h"
#include "runtime/bound_mesh.h"
#include "runtime/solver.h"

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
  void set_acceleration(const sim::Vec3& acceleration) { acceleration_ = acceleration; }

  void pose();
  /// False when the solver's watchdog had to put the face back.
  bool step(double seconds);
  void reset();

  BoundMesh& mesh(std::size_t index) { return meshes_[index]; }
  std::size_t mesh_count() const { return meshes_.size(); }
  const std::vector<Vec3f>& fibre_points();
  const sim::RigidTransform& jaw() const { return bones_.jaw; }

 private:
  /// Adds up own values, members and curves into `effective_` and uses the curves up.
  void gather();
  sim::Drive drive() const;
  /// Takes displacements, jaw and eyes to the meshes.
  void follow();
  float effective(int32_t channel) const {
    return channel < 0 ? 0.0F : effective_[static_cast<std::size_t>(channel)];
  }

  std::shared_ptr<const Asset> asset_;
  std::size_t level_ = 0;
  const sim::FaceModel* model_ = nullptr;
  std::unique_ptr<Solver> solver_;
  std::vector<float> values_, members_, curve_channels_, curve_members_, effective_;
  sim::Vec3 acceleration_ = sim::Vec3::Zero();
  std::vector<Vec3f> displacements_, fibre_points_;
  BonePose bones_;
  std::vector<BoundMesh> meshes_;
};

}  // namespace fascia::runtime

struct fascia_face {
  std::unique_ptr<fascia::runtime::Face> face;
};
