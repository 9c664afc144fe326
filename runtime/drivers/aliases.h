#pragma once

#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace fascia::runtime {

/// What the values of a name mean.
enum class Measure : unsigned char {
  share,        ///< 0 to 1
  rotation,     ///< radians, and in place of what other names say of its channel
  head,         ///< radians of the head's yaw, pitch or roll: no channel of the rig
  intensity,    ///< 0 to 5 (FACS A to E)
  presence,     ///< 0 or 1; where the same thing's intensity is given, that counts
  action_unit,  ///< 0 to 1, or 0 to 5 when values above 1 show it
  none,         ///< says nothing of the face
};

/// A name that another program gives to channels or members, with the share of each.
struct Alias {
  std::string name;
  std::string vocabulary;
  Measure measure = Measure::share;
  std::vector<std::pair<std::string, float>> targets;  ///< of Measure::head: yaw, pitch, roll
};

/// The table of anatomy/data/aliases.json, which this library carries.
const std::vector<Alias>& aliases();

/// The table's entry for `name`: as it stands there; else in any case; else in any spelling (see
/// `readings`). Null when there is none.
const Alias* find_alias(std::string_view name);

/// The names of a program's columns that come without their names, in its order: one of the table's "orders".
const std::vector<std::string>& named_order(const std::string& program);

/// A name for comparison: lower case, without blanks, `_`, `-`, `.` and `:`; a side at its end that stands
/// apart (_L, .R, " left") is written out. "mouthSmile_L", "MouthSmileLeft" and "mouth_smile_left" are one.
std::string spelled(std::string_view name);

/// What `name` may be under the prefixes that programs put before names: itself first, then without what
/// stands before a `.`, `:`, `|`, `/` or `__`, then without one of the table's prefixes. Then the same with
/// a side that stands first (L_mouthSmile) at the end.
std::vector<std::string> readings(std::string_view name);

}  // namespace fascia::runtime
