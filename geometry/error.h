#pragma once

#include <stdexcept>
#include <string>

namespace fascia {

/// What every room but `sim` and the C ABI throws when its input is at fault.
///
/// The message says what is wrong, where (file, mesh, landmark, muscle) and what to do about it;
/// the `fascia` tool prints it as it is and exits with 1.
class Error : public std::runtime_error {
 public:
  explicit Error(const std::string& message) : std::runtime_error(message) {}
};

}  // namespace fascia
