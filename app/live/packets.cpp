#include "app/live/packets.h"

#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <string_view>

namespace fascia::app {

namespace {

/// ARKit's coefficients in the order in which Live Link Face sends them; nine angles of head and eyes follow.
constexpr std::array<const char*, 61> live_link_names = {"arkit:eyeBlinkLeft",
                                                         "arkit:eyeLookDownLeft",
                                                         "arkit:eyeLookInLeft",
                                                         "arkit:eyeLookOutLeft",
                                                         "arkit:eyeLookUpLeft",
                                                         "arkit:eyeSquintLeft",
                                                         "arkit:eyeWideLeft",
                                                         "arkit:eyeBlinkRight",
                                                         "arkit:eyeLookDownRight",
                                                         "arkit:eyeLookInRight",
                                                         "arkit:eyeLookOutRight",
                                                         "arkit:eyeLookUpRight",
                                                         "arkit:eyeSquintRight",
                                                         "arkit:eyeWideRight",
                                                         "arkit:jawForward",
                                                         "arkit:jawLeft",
                                                         "arkit:jawRight",
                                                         "arkit:jawOpen",
                                                         "arkit:mouthClose",
                                                         "arkit:mouthFunnel",
                                                         "arkit:mouthPucker",
                                                         "arkit:mouthLeft",
                                                         "arkit:mouthRight",
                                                         "arkit:mouthSmileLeft",
                                                         "arkit:mouthSmileRight",
                                                         "arkit:mouthFrownLeft",
                                                         "arkit:mouthFrownRight",
                                                         "arkit:mouthDimpleLeft",
                                                         "arkit:mouthDimpleRight",
                                                         "arkit:mouthStretchLeft",
                                                         "arkit:mouthStretchRight",
                                                         "arkit:mouthRollLower",
                                                         "arkit:mouthRollUpper",
                                                         "arkit:mouthShrugLower",
                                                         "arkit:mouthShrugUpper",
                                                         "arkit:mouthPressLeft",
                                                         "arkit:mouthPressRight",
                                                         "arkit:mouthLowerDownLeft",
                                                         "arkit:mouthLowerDownRight",
                                                         "arkit:mouthUpperUpLeft",
                                                         "arkit:mouthUpperUpRight",
                                                         "arkit:browDownLeft",
                                                         "arkit:browDownRight",
                                                         "arkit:browInnerUp",
                                                         "arkit:browOuterUpLeft",
                                                         "arkit:browOuterUpRight",
                                                         "arkit:cheekPuff",
                                                         "arkit:cheekSquintLeft",
                                                         "arkit:cheekSquintRight",
                                                         "arkit:noseSneerLeft",
                                                         "arkit:noseSneerRight",
                                                         "arkit:tongueOut",
                                                         "HeadYaw",
                                                         "HeadPitch",
                                                         "HeadRoll",
                                                         "LeftEyeYaw",
                                                         "LeftEyePitch",
                                                         "LeftEyeRoll",
                                                         "RightEyeYaw",
                                                         "RightEyePitch",
                                                         "RightEyeRoll"};
constexpr size_t live_link_shapes = 52;  ///< the angles behind them are not the rig's

uint32_t big_endian(const uint8_t* at) {
  return uint32_t{at[0]} << 24 | uint32_t{at[1]} << 16 | uint32_t{at[2]} << 8 | uint32_t{at[3]};
}

float float_at(const uint8_t* at) {
  return std::bit_cast<float>(big_endian(at));
}

/// Reads on from the front of a datagram; every read says whether there was enough.
class Reader {
 public:
  explicit Reader(std::span<const uint8_t> bytes) : bytes_(bytes) {}
  size_t left() const { return bytes_.size() - at_; }

  bool number(uint32_t& value) {
    if (left() < 4) return false;
    value = big_endian(bytes_.data() + at_);
    at_ += 4;
    return true;
  }
  /// A text that ends with 0 and is filled up to a multiple of four.
  bool text(std::string_view& value) {
    const auto* begin = reinterpret_cast<const char*>(bytes_.data() + at_);
    const void* end = left() ? std::memchr(begin, 0, left()) : nullptr;
    if (!end) return false;
    value = {begin, static_cast<size_t>(static_cast<const char*>(end) - begin)};
    const size_t length = (value.size() / 4 + 1) * 4;
    if (length > left()) return false;
    at_ += length;
    return true;
  }
  bool skip(size_t count) {
    if (left() < count) return false;
    at_ += count;
    return true;
  }
  std::span<const uint8_t> rest() const { return bytes_.subspan(at_); }

 private:
  std::span<const uint8_t> bytes_;
  size_t at_ = 0;
};

bool read_message(std::span<const uint8_t> bytes, CapturedValues& values) {
  Reader reader(bytes);
  std::string_view address, types;
  if (!reader.text(address) || !reader.text(types) || address.size() < 2 || address[0] != '/' ||
      types.empty() || types[0] != ',')
    return false;
  std::string_view name = address.substr(address.rfind('/') + 1), said;
  bool has_value = false;
  double value = 0.0;
  for (const char type : types.substr(1)) {
    uint32_t bits = 0;
    if (type == 's') {
      if (!reader.text(said)) return false;
    } else if (type == 'f' || type == 'i') {
      if (!reader.number(bits)) return false;
      value = type == 'f' ? static_cast<double>(std::bit_cast<float>(bits))
                          : static_cast<double>(static_cast<int32_t>(bits));
      has_value = true;
    } else if (type == 'd' || type == 'h' || type == 't') {
      if (!reader.skip(8)) return false;
    } else if (type != 'T' && type != 'F' && type != 'N' && type != 'I') {
      return false;
    }
  }
  if (address.starts_with("/VMC/") && address != "/VMC/Ext/Blend/Val") return false;
  if (!said.empty()) name = said;
  if (!has_value || name.empty() || !std::isfinite(value)) return false;
  values[std::string(name)] = value;
  return true;
}

bool read_packet(std::span<const uint8_t> bytes, CapturedValues& values, int depth) {
  constexpr std::string_view bundle("#bundle\0", 8);
  if (bytes.size() < 16 ||
      std::string_view(reinterpret_cast<const char*>(bytes.data()), bundle.size()) != bundle)
    return read_message(bytes, values);
  const int deepest = 8;
  if (depth > deepest) return false;
  Reader reader(bytes);
  bool has_value = false;
  reader.skip(16);
  for (uint32_t size = 0; reader.number(size) && size <= reader.left(); reader.skip(size))
    has_value = read_packet(reader.rest().first(size), values, depth + 1) || has_value;
  return has_value;
}

}  // namespace

bool read_osc(std::span<const uint8_t> datagram, CapturedValues& values) {
  return read_packet(datagram, values, 0);
}

bool read_live_link(std::span<const uint8_t> datagram, CapturedValues& values) {
  // Version, 37 bytes of device id with its length, the subject's name by length, 16 bytes of frame time, a
  // count.
  constexpr size_t name_length_at = 41, longest_name = 256, time_bytes = 16;
  if (datagram.size() < name_length_at + 4) return false;
  const uint32_t name_length = big_endian(datagram.data() + name_length_at);
  if (name_length > longest_name) return false;
  const size_t count_at = name_length_at + 4 + name_length + time_bytes;
  if (datagram.size() < count_at + 1 + 4 * live_link_names.size()) return false;
  if (datagram[count_at] != live_link_names.size()) return false;
  for (size_t i = 0; i < live_link_shapes; ++i) {
    const auto value = static_cast<double>(float_at(datagram.data() + count_at + 1 + 4 * i));
    if (std::isfinite(value)) values[live_link_names[i]] = value;
  }
  return true;
}

}  // namespace fascia::app
