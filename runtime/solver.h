#pragma once

#include <memory>
#include <span>

#include "fascia/fascia.h"
#include "sim/face.h"

namespace fascia::runtime {

/// What moves the lattice of one face. Displacements are #nodes, metres from rest; at rest exactly zero.
class Solver {
 public:
  virtual ~Solver() = default;
  virtual void pose(const sim::Drive& drive, std::span<sim::Vec3f> displacements) = 0;
  /// False when the watchdog put the face back to its bones.
  virtual bool step(double seconds, const sim::Drive& drive, std::span<sim::Vec3f> displacements) = 0;
  virtual void reset(const sim::Drive& drive, std::span<sim::Vec3f> displacements) = 0;
};

class Asset;

/// Makes a solver on a level of `asset`, which must outlive it. Throws Failure when the options are at fault
/// or the solver's module is not there.
std::unique_ptr<Solver> make_solver(const fascia_face_options& options, const Asset& asset,
                                    std::size_t level);

}  // namespace fascia::runtime
