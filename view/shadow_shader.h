#pragma once

#include <string>

namespace fascia::view {

/// GLSL of `lit_share`, the share of the key light that reaches a place: `searches` samples look for what
/// casts a shadow, `taps` filter it.
std::string soft_shadow_source(int searches, int taps);

}  // namespace fascia::view
