#pragma once

namespace fascia::bench {

/// Prints every row of the check for heads with sculpted or measured shapes, played as if they were a rig's
/// own, with the least and largest value of each. Returns how many rows fail their bounds.
int print_reference();

}  // namespace fascia::bench
