#pragma once

#include <stdexcept>
#include <string>

namespace fascia {

/// The exception that all modules except `sim` and the C interface throw for invalid input.
///
/// The message says what is wrong, where (file, mesh, landmark, muscle) and what to do about it; the `fascia`
/// tool prints it unchanged and exits with 1.
class Error : public std::runtime_error {
 public:
  explicit Error(const std::string& message) : std::runtime_error(message) {}
};

}  // namespace fascia
