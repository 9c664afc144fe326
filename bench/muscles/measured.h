#pragma once

#include "builder/muscles/muscles.h"

namespace fascia::bench {

/// Prints the lengths of our fibres beside those of a published finite-element face (ArtiSynth).
void print_lengths(const muscles::Result& built);

}  // namespace fascia::bench
