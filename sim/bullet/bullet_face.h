#pragma once

#include <memory>

#include "sim/solver.h"

namespace fascia::sim {

struct BulletOptions {
  double substep = 1.0 / 2400.0;  ///< seconds; Bullet's links are stiff as asked only while steps are short
  double damping = 0.02;          ///< share of velocity lost a substep
  double length_scale = 100.0;  ///< Bullet units a metre: its margins are made for bodies of some units' size
  double settle_seconds = 3.0;  ///< how long a static pose is waited for at most
  double settle_speed = 5e-5;   ///< metres a second below which it is reached
};

/// A face in Bullet: head and mandible are rigid bodies, the mandible on a joint at the condyles whose frame
/// follows the closed form; the lattice is a btSoftBody. Two-sided springs are its links; bones' nodes have
/// no mass and are carried; every other energy acts as a force on the nodes. docs/solvers.md says what that
/// leaves out.
class BulletFace final : public Solver {
 public:
  BulletFace(const FaceModel& model, size_t channels, const BulletOptions& options = {});
  ~BulletFace() override;

  StepResult step(double seconds, const Controls& controls) override;
  /// Waits until Bullet's tissue has come to rest.
  MinimiseResult settle(const Controls& controls) override;
  void reset(const Controls& controls) override;
  void displacements(std::span<Vec3f> out) const override;
  double longest_frame() const override { return 0.2; }

  /// Where Bullet's mandible stands: what its constraint made of the closed form.
  RigidTransform mandible() const;

 private:
  struct World;
  std::unique_ptr<World> world_;
};

}  // namespace fascia::sim
