#pragma once

#include "sim/solver.h"

namespace fascia::runtime {

/// The entry of the module libfascia_bullet, which is looked for beside this library and on the loader's
/// path, loaded once and kept. Throws Failure when it is not there.
sim::MakeSolver bullet_entry();

}  // namespace fascia::runtime
