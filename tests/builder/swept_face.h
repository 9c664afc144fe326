#pragma once

#include <array>
#include <memory>
#include <random>

#include "runtime/asset.h"
#include "runtime/bound_mesh.h"
#include "sim/realtime/solver.h"
#include "tests/builder/crossings.h"

namespace fascia::testing {

/// A face of a rig under random activations, and what must hold whatever they are.
class SweptFace {
 public:
  /// `level` is an index into the rig's levels of detail.
  SweptFace(std::shared_ptr<const runtime::Asset> asset, size_t level)
      : SweptFace(asset, level, asset->rig().tissue.levels[level]) {}
  /// The same; what faces what is read from `marks`, of the same columns.
  SweptFace(std::shared_ptr<const runtime::Asset> asset, size_t level, const rig::TissueLevel& marks);

  /// Random activations: half of the time a few members of the ARKit set together, else a quarter of all
  /// channels, each anywhere in its range. Stays as it is until the next.
  void draw(std::mt19937& random);
  /// More of a channel or a set's member, such as "arkit:jawOpen", as what drives it.
  void add(const std::string& name, float value);
  std::vector<std::string> shapes() const;  ///< names of the ARKit set's members
  /// Nothing as what drives it.
  void relax();
  sim::Controls drive() const;
  /// Lets the jaw go towards where the drive wants it; `step` does it itself.
  void pass(double seconds);

  void pose();                ///< where the drive's forces balance
  bool step(double seconds);  ///< false when the watchdog put the face back
  void add_force(const sim::Vec3& acceleration) {
    acceleration_ = acceleration;
  }  ///< on all loose tissue, m/s^2
  void touch(std::span<const sim::NodeForce> touches) { touches_ = touches; }

  struct State {
    bool is_finite = true;
    int turned_prisms = 0;                              ///< of negative volume
    std::array<Crossings::Worst, 3> lattice, rendered;  ///< lips, left lids, right lids
    void take(const State& other);
  };
  /// `tolerance` as in Crossings::find.
  State state(double tolerance) const;
  int turned_prisms() const;
  /// The skin of the mesh as it stands, metres.
  TriangleMesh skin() const;
  std::span<const sim::Vec3f> displacements() const { return displacements_; }
  const std::vector<float>& values() const { return values_; }
  const runtime::Asset& asset() const { return *asset_; }
  const sim::FaceModel& model() const { return *model_; }

 private:
  sim::JawPose wanted_jaw() const;
  void add(const runtime::Target& target, float value);
  void follow();

  std::shared_ptr<const runtime::Asset> asset_;
  const sim::FaceModel* model_;
  sim::realtime::Solver face_;
  std::vector<float> values_;
  sim::JawPose jaw_;
  sim::Vec3 acceleration_ = sim::Vec3::Zero();
  std::span<const sim::NodeForce> touches_;
  std::vector<sim::Vec3f> displacements_;
  runtime::BonePose bones_;
  mutable std::vector<runtime::BoundMesh> meshes_;  ///< the skin's primitives
  std::vector<Triangle> triangles_;                 ///< of all of them
  std::unique_ptr<Crossings> lattice_, rendered_;
};

}  // namespace fascia::testing
