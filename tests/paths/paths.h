#pragma once

#include <filesystem>

namespace fascia::test {

/// Where tests and benchmarks find what they read. They are functions rather than macros so that objects of
/// one checkout serve another from the compiler's cache.
std::filesystem::path data();       ///< tests/data: small fixtures of the project's own
std::filesystem::path snapshots();  ///< tests/snapshots
std::filesystem::path
measured_data();               ///< measured heads, FASCIA_MEASURED or beside the project; without, tests skip
std::filesystem::path tool();  ///< the `fascia` program of this build

}  // namespace fascia::test
