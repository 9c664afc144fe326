#include <fascia/snapshot.h>

#include <cmath>
#include <cstdio>
#include <new>
#include <string_view>

#include "geometry/arithmetic_mode.h"
#include "geometry/error.h"
#include "snapshot/compare.h"
#include "snapshot/file.h"

namespace {

thread_local char message[1024] = "";

fascia_result fail(fascia_result result, const char* text) {
  std::snprintf(message, sizeof message, "%s", text);
  return result;
}

std::span<const uint8_t> bytes_of(const void* bytes, size_t size) {
  return {static_cast<const uint8_t*>(bytes), size};
}

uint32_t check(std::span<const uint8_t> rig, std::string_view text, const fascia_snapshot_options& options) {
  using namespace fascia::snapshot;
  std::vector<TakeFile> takes;
  for (size_t i = 0; i < options.curve_count; ++i) {
    const auto bytes = bytes_of(options.curves[i].bytes, options.curves[i].size);
    takes.push_back({"curves " + std::to_string(i), "", {bytes.begin(), bytes.end()}});
  }
  const Snapshot then = from_text(text, "the snapshot");
  const Snapshot now = replay(rig, "the rig", then, takes, static_cast<int>(options.threads), {});
  const Comparison comparison = compare(then, now, options.tolerance_mm);
  if (options.difference)
    for (const Difference& found : comparison.differences) {
      fascia_snapshot_difference difference = {};
      difference.struct_size = sizeof difference;
      difference.ok = found.ok;
      difference.state = then.states[found.state].name.c_str();
      difference.region = then.regions[found.region].name.c_str();
      difference.mean_mm = found.mean_mm;
      difference.largest_mm = found.largest_mm;
      difference.mesh = then.meshes[found.vertex.mesh].mesh;
      difference.vertex = found.vertex.vertex;
      options.difference(options.user, &difference);
    }
  return static_cast<uint32_t>(comparison.failed);
}

}  // namespace

fascia_result fascia_snapshot_check(const void* rig, size_t rig_size, const void* snapshot,
                                    size_t snapshot_size, const fascia_snapshot_options* options,
                                    uint32_t* failed) {
  if (!rig || !snapshot || !failed) return fail(FASCIA_ERROR_ARGUMENT, "a pointer is null");
  fascia_snapshot_options chosen = {};
  if (options) {
    if (options->struct_size != sizeof chosen)
      return fail(FASCIA_ERROR_ARGUMENT, "struct_size of the options is not their size");
    chosen = *options;
  }
  if (chosen.threads > 1024 || !std::isfinite(chosen.tolerance_mm) || chosen.tolerance_mm < 0.0)
    return fail(FASCIA_ERROR_ARGUMENT, "threads above 1024, or a tolerance that is negative or no number");
  if (chosen.curve_count > 0 && !chosen.curves) return fail(FASCIA_ERROR_ARGUMENT, "curves is null");
  for (size_t i = 0; i < chosen.curve_count; ++i)
    if (!chosen.curves[i].bytes) return fail(FASCIA_ERROR_ARGUMENT, "a file of curves is null");
  // Worker threads take it over from this one.
  const fascia::ArithmeticMode mode;
  try {
    *failed = check(bytes_of(rig, rig_size), {static_cast<const char*>(snapshot), snapshot_size}, chosen);
    return FASCIA_OK;
  } catch (const std::bad_alloc&) {
    return fail(FASCIA_ERROR_MEMORY, "out of memory");
  } catch (const fascia::Error& error) {
    return fail(FASCIA_ERROR_FORMAT, error.what());
  } catch (const std::exception& error) {
    return fail(FASCIA_ERROR_INTERNAL, error.what());
  } catch (...) {
    return fail(FASCIA_ERROR_INTERNAL, "an unknown fault");
  }
}

const char* fascia_snapshot_message(void) {
  return message;
}
