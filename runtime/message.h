#pragma once

#include <cstring>
#include <memory>
#include <new>
#include <stdexcept>
#include <string>

#include "fascia/fascia.h"
#include "geometry/arithmetic_mode.h"
#include "geometry/error.h"
#include "runtime/allocator.h"

namespace fascia::runtime {

/// A failure with the result that the C interface returns for it.
class Failure : public std::runtime_error {
 public:
  Failure(fascia_result result, const std::string& message) : std::runtime_error(message), result_(result) {}
  fascia_result result() const { return result_; }

 private:
  fascia_result result_;
};

/// Keeps `message` for this thread, tells the log, and returns `result`. Never throws.
fascia_result report(fascia_result result, const char* message) noexcept;

/// The same of what was thrown, by its kind; of memory when that had run out before.
fascia_result report_fault(const std::exception& fault) noexcept;

/// Throws FASCIA_ERROR_ARGUMENT with `message` unless `condition` holds.
inline void require(bool condition, const char* message) {
  if (!condition) throw Failure(FASCIA_ERROR_ARGUMENT, message);
}

/// Runs `body` in the usual mode of arithmetic and turns whatever it throws, and memory that was refused,
/// into a result: the wall between C++ and the C interface.
template <class Body>
fascia_result guarded(const Body& body) noexcept {
  const ArithmeticMode mode;
  const RefusalsDeferred refusals;
  try {
    const fascia_result result = body();
    refusals.finish();
    return result;
  } catch (const std::bad_alloc&) {
    return report(FASCIA_ERROR_MEMORY, "out of memory");
  } catch (const std::exception& fault) {
    return report_fault(fault);
  } catch (...) {
    return report(FASCIA_ERROR_INTERNAL, "an unknown fault");
  }
}

/// Gives the caller what was made for it, unless memory was refused in the making: last in a guarded body.
template <class Handle>
void hand_over(std::unique_ptr<Handle> made, Handle** to) {
  if (has_run_out()) throw std::bad_alloc();
  *to = made.release();
}

/// Takes back what was handed over; null does nothing.
template <class Handle>
void released(Handle* handle) noexcept {
  const ArithmeticMode mode;
  const RefusalsDeferred refusals;
  delete handle;
}

/// Copies `value` to the caller's structure, as much of it as the caller knows. `to->struct_size` says how
/// much.
template <class Struct>
void hand_out(const Struct& value, Struct* to) {
  require(to != nullptr, "the structure to fill is null");
  require(to->struct_size >= sizeof(uint32_t) * 2, "struct_size is not set: it must be sizeof the structure");
  const std::size_t size = to->struct_size < sizeof(Struct) ? to->struct_size : sizeof(Struct);
  const uint32_t kept = to->struct_size;
  std::memcpy(static_cast<void*>(to), &value, size);
  to->struct_size = kept;
}

}  // namespace fascia::runtime
