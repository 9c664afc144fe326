#pragma once

#include <string>

namespace fascia::bench {

/// What the machine can do at most.
struct Machine {
  double gigaflops = 0.0;        ///< multiplied and added, not fused, by one thread
  double near = 0.0, far = 0.0;  ///< gigabytes a second from the second-level cache and from memory
};

/// Prints how near the loops of a rig's levels come to it. Throws what the rig's fault is.
void print_face_limits(const std::string& rig, const Machine& machine);

}  // namespace fascia::bench
