#pragma once

#include <string>

namespace fascia::cli {

/// What `fascia --version` prints: the version on the first line, then how this program was built (commit as
/// configured, compiler, build type and flags), the vector unit it uses on this processor, and the versions
/// of the libraries compiled in. For reports of faults; nothing in it names a place on the builder's machine.
std::string version_text();

}  // namespace fascia::cli
