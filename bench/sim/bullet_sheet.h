#pragma once

#include <memory>

#include "sim/vector.h"

namespace fascia::bench {

/// The sheet of sim/sheet as Bullet's soft body: the same particles and springs, stiffness 1, no damping, no
/// collisions.
class BulletSheet {
 public:
  /// `n` by `n` particles `spacing` metres apart, the first row pinned, level at first.
  BulletSheet(int n, double spacing, int substeps, int iterations);
  ~BulletSheet();
  void step(double seconds);
  double mean_stretch() const;

 private:
  struct World;
  std::unique_ptr<World> world_;
};

}  // namespace fascia::bench
