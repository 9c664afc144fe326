#pragma once

#include <span>

#include "fascia/fascia.h"
#include "runtime/face.h"

namespace fascia::runtime {

/// False when a face stands in the list twice. Allocates nothing; none null.
bool are_different(std::span<fascia_face* const> faces);

/// Lets `seconds` pass for every face, through the host's tasks or, with none, one after the other. `tasks`
/// complete. Returns how many had to be put back. Throws what a face throws, after all were tried.
std::size_t step_all(std::span<fascia_face* const> faces, double seconds, const fascia_tasks* tasks);

}  // namespace fascia::runtime
