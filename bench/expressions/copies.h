#pragma once

#include <string>

namespace fascia::bench {

/// Cuts a person of the measured model into other triangles, half as many and uneven ones, and prints for
/// each shape what the copy explains of it and how far its poses lie from the head's own (mean and 95th
/// percentile where either moves by more than 0.5 mm).
void run_copies(const std::string& person, const std::string& level);

}  // namespace fascia::bench
