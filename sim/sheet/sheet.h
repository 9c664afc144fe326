#pragma once

#include <cstdint>
#include <vector>

#include "sim/lanes/instruction_set.h"
#include "sim/sheet/sheet_state.h"
#include "sim/vector.h"

namespace fascia::sim {

/// A rectangular sheet of particles held together along its fibres.
struct SheetOptions {
  uint32_t rows = 100, columns = 100;
  float spacing = 0.01F;                                            ///< metres between neighbours
  Vec3f corner = Vec3f::Zero();                                     ///< place of row 0, column 0
  Vec3f along_row = Vec3f::UnitX(), along_column = Vec3f::UnitZ();  ///< unit
  Vec3f gravity = Vec3f(0.0F, -9.81F, 0.0F);
  int substeps = 10;
  lanes::InstructionSet instructions = lanes::instruction_set();
};

/// A sheet of inextensible springs, its first row pinned: structural springs along rows and columns, shear
/// springs along both diagonals, and skip-one springs against bending.
///
/// Substeps of position-based dynamics (Macklin et al. 2019, "Small steps in physics simulation"). Columns,
/// which carry the weight, are solved as whole chains: one Newton step of all their lengths together, a
/// tridiagonal system each, sixteen columns at once (Goldenthal et al. 2007 on direct solves of inextensible
/// threads); the other springs are relaxed by Gauss-Seidel, sixteen at once, no two of which share a
/// particle. Bit-identical on every processor.
class Sheet {
 public:
  explicit Sheet(const SheetOptions& options);
  Sheet(Sheet&&) = default;  // its state points into its own memory: moved, not copied
  Sheet& operator=(Sheet&&) = default;

  /// Advances by `seconds` in the number of substeps given by the options. Does not allocate.
  void step(float seconds);

  uint32_t spring_count() const;
  Vec3f position(uint32_t row, uint32_t column) const;
  /// Mean over all springs of |length / rest length - 1|.
  double mean_stretch() const;

 private:
  size_t index(uint32_t row, uint32_t column) const;

  SheetOptions options_;
  std::vector<float> memory_;
  sheet::State state_;
  sheet::StepFunction step_;
};

}  // namespace fascia::sim
