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

  /// Time of the last key of all, seconds.
  double duration() const;
};

/// Reads curves from the bytes of a file, whose kind is found from its content: a GLB, JSON, Live Link Face
/// CSV or CSV. Throws fascia::Error that says what is wrong and in which row or channel.
Curves read_curves(std::span<const uint8_t> bytes);

/// CSV with a `time` column in seconds and one column a name; empty cells are left out. Live Link Face files
/// (`Timecode` hh:mm:ss:ff.sub and `BlendShapeCount`) are known by their header: time counts from the first
/// row, at 60 frames a second unless a higher frame number shows more.
Curves read_csv_curves(std::string_view text);

/// {"fps": F, "channels": {NAME: [values]}} or {NAME: {"times": [], "values": [], "interpolation": ""}}.
Curves read_json_curves(std::string_view text);

/// Animations of a GLB file whose channels point at /extensions/FASCIA_actuation/channels/N/value through
/// KHR_animation_pointer. Names are those of the file's own FASCIA_actuation, or "#N" when it has none.
Curves read_gltf_curves(std::span<const uint8_t> bytes);

}  // namespace fascia::runtime
