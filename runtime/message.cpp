#include "runtime/message.h"

#include "rig/read/read.h"

namespace fascia::runtime {
namespace {

// Of a fixed size: a failure to report must not need memory.
thread_local char last_message[2048];
fascia_log_function log_function = nullptr;
void* log_user = nullptr;

}  // namespace

fascia_result report(fascia_result result, const char* message) noexcept {
  std::size_t length = 0;
  while (length + 1 < sizeof last_message && message[length] != 0)
    ++length;
  while (message[length] != 0 && length > 0 && (message[length] & 0xC0) == 0x80)
    --length;  // not within a character of UTF-8
  std::memmove(last_message, message, length);
  last_message[length] = 0;
  if (log_function != nullptr) log_function(log_user, result, message);
  return result;
}

fascia_result report_fault(const std::exception& fault) noexcept {
  if (has_run_out()) return report(FASCIA_ERROR_MEMORY, "out of memory");
  fascia_result result = FASCIA_ERROR_INTERNAL;
  if (const auto* failure = dynamic_cast<const Failure*>(&fault))
    result = failure->result();
  else if (dynamic_cast<const rig::VersionError*>(&fault) != nullptr)
    result = FASCIA_ERROR_VERSION;
  else if (dynamic_cast<const rig::MismatchError*>(&fault) != nullptr)
    result = FASCIA_ERROR_MISMATCH;
  else if (dynamic_cast<const Error*>(&fault) != nullptr)
    result = FASCIA_ERROR_FORMAT;
  return report(result, fault.what());
}

}  // namespace fascia::runtime

extern "C" {

uint32_t fascia_version(void) {
  return FASCIA_VERSION_MAJOR << 16 | FASCIA_VERSION_MINOR << 8 | FASCIA_VERSION_PATCH;
}

const char* fascia_result_name(fascia_result result) {
  switch (result) {
    case FASCIA_OK:
      return "FASCIA_OK";
    case FASCIA_ERROR_ARGUMENT:
      return "FASCIA_ERROR_ARGUMENT";
    case FASCIA_ERROR_FORMAT:
      return "FASCIA_ERROR_FORMAT";
    case FASCIA_ERROR_VERSION:
      return "FASCIA_ERROR_VERSION";
    case FASCIA_ERROR_MISMATCH:
      return "FASCIA_ERROR_MISMATCH";
    case FASCIA_ERROR_NAME:
      return "FASCIA_ERROR_NAME";
    case FASCIA_ERROR_MEMORY:
      return "FASCIA_ERROR_MEMORY";
    case FASCIA_ERROR_DIVERGED:
      return "FASCIA_ERROR_DIVERGED";
    case FASCIA_ERROR_MODULE:
      return "FASCIA_ERROR_MODULE";
    case FASCIA_ERROR_INTERNAL:
      return "FASCIA_ERROR_INTERNAL";
    case FASCIA_RESULT_32:
      break;
  }
  return "unknown result";
}

const char* fascia_last_message(void) {
  return fascia::runtime::last_message;
}

void fascia_set_log(fascia_log_function function, void* user) {
  fascia::runtime::log_function = function;
  fascia::runtime::log_user = user;
}

}  // extern "C"
