#pragma once

#include <memory>

#include "fascia/fascia.h"
#include "sim/solver.h"

namespace fascia::runtime {

class Asset;

/// Makes a solver on a level of `asset`, which must outlive it. Throws Failure when the options are at fault
/// or the solver's module is not there.
std::unique_ptr<sim::Solver> make_solver(const fascia_face_options& options, const Asset& asset,
                                         std::size_t level);

}  // namespace fascia::runtime
