// The loops of a face, included once by each source that is compiled for one instruction set (see
// sim/lanes/lanes.h), which define FASCIA_LOOPS. Everything else here is local to the including source.

#include "sim/realtime/energy_loops.h"
#include "sim/realtime/place_loops.h"
#include "sim/realtime/solve_loops.h"
#include "sim/realtime/step_loops.h"

namespace fascia::sim::realtime {

const Loops& FASCIA_LOOPS() {
  static constexpr Loops loops{
      place, total_energy<true>, total_energy<false>, volume_ratios, multiply, subtract, collect, scale,
      solve, take_steps,         begin_step,          dot_of,        add,      largest};
  return loops;
}

}  // namespace fascia::sim::realtime
