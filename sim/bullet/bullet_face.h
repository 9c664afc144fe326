#pragma once

#include <memory>

#include "sim/solver.h"

namespace fascia::sim {

struct BulletOptions {
  double substep = 1.0 / 2400.0;  ///< seconds; Bullet's links reach their stiffness only with short steps
  double damping = 0.02;          ///< fraction of velocity lost per substep
  double length_scale =
      100.0;  ///< Bullet units per metre: its margins are intended for bodies of a few units in size
  double settle_seconds = 3.0;  ///< maximum simulated time for a static pose
  double settle_speed = 5e-5;   ///< metres per second below which it counts as reached
};

/// A face in Bullet: head and mandible are rigid bodies, the mandible on a joint at the condyles whose frame
/// follows the closed form; the lattice is a btSoftBody. Two-sided springs are its links; nodes on bones are
/// kinematic; every other energy acts as a force on the nodes. docs/solvers.md describes the limitations.
class BulletFace final : public Solver {
 public:
  BulletFace(const FaceModel& model, size_t channels, const BulletOptions& options = {});
  ~BulletFace() override;

  StepResult step(double seconds, const Controls& controls) override;
  /// Steps until Bullet's tissue is at rest.
  MinimiseResult settle(const Controls& controls) override;
  void reset(const Controls& controls) override;
  void displacements(std::span<Vec3f> out) const override;
  double longest_frame() const override { return 0.2; }

  /// Pose of Bullet's mandible, as its constraint follows the closed form.
  RigidTransform mandible() const;

 private:
  struct World;
  std::unique_ptr<World> world_;
};

}  // namespace fascia::sim
