#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace fascia::runtime {

enum class Interpolation : uint8_t {
  linear,
  step,   ///< holds until the next key
  cubic,  ///< Hermite; tangents as given, else Catmull-Rom through the keys
};

/// One named value over time.
struct Curve {
  std::string name;
  std::vector<double> times;  ///< seconds, rising
  std::vector<float> values;  ///< #times
  Interpolation interpolation = Interpolation::linear;
  std::vector<float> tangents_in, tangents_out;  ///< #times or none, per second

  /// The value at `seconds`; before the first and after the last key theirs. 0 when there are no keys.
  float at(double seconds) const;
};

struct Curves {
  std::vector<Curve> curves;

  double start = 0.0;              ///< the file's own time of its first key, seconds; here that is 0
  double frames_per_second = 0.0;  ///< of the file's rows, where it says; 0 where it does not
  std::vector<std::string> notes;  ///< what was taken how, and what was mended: a sentence each

  /// Time of the last key of all, seconds.
  double duration() const;
};

/// What the file does not say, or says wrongly.
struct ReadOptions {
  double frames_per_second = 0.0;  ///< of rows and frames, instead of the file's; 0: as the file says
  double time_unit = 0.0;          ///< seconds in one unit of the file's times; 0: as the file says
};

/// Reads curves from the bytes of a file, whose kind is found from its content: a GLB, JSON, or a table of
/// text (CSV), in UTF-8 or UTF-16. Time counts from the first key of all. Values are shares of 1: percent and
/// action units from 0 to 5 are scaled, which `notes` says. Throws fascia::Error that says what is wrong and
/// in which row or channel.
Curves read_curves(std::span<const uint8_t> bytes, const ReadOptions& options = {});

/// A table with a column of times (`time`, `timestamp`, `time_ms`, ...) or timecodes (Live Link Face), or
/// without one where `frames_per_second` is given, and one column a name. Empty cells and NaN are left out:
/// the curve goes straight from the key before to the next, and holds its ends from the first row to the
/// last.
Curves read_csv_curves(std::string_view text, const ReadOptions& options = {});

/// {"fps": F, "channels": {NAME: [values]}}, {NAME: {"times": [], "values": [], "interpolation": ""}}, or
/// what a capture program wrote (see `read_captured_json`).
Curves read_json_curves(std::string_view text, const ReadOptions& options = {});

/// Animations of a GLB file: channels that point at /extensions/FASCIA_actuation/channels/N/value through
/// KHR_animation_pointer, named as in the file's own FASCIA_actuation, or "#N" when it has none; where there
/// are none of them, the weights of meshes whose extras.targetNames name them.
Curves read_gltf_curves(std::span<const uint8_t> bytes);

/// Makes time count from the first key, scales percent and intensities to shares and leaves out what says
/// nothing of the face. Throws fascia::Error when the curves last longer than any take.
void settle(Curves& curves);

}  // namespace fascia::runtime
