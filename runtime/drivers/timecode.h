#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace fascia::runtime {

/// An SMPTE timecode, hh:mm:ss:ff with a fraction of the frame as in Live Link Face (hh:mm:ss:ff.sub).
struct Timecode {
  int hours = 0, minutes = 0, seconds = 0;
  double frame = 0.0;
  bool marks_drop_frame = false;  ///< `;` or `.` before the frame
};

/// Nothing when `text` is no timecode.
std::optional<Timecode> timecode(std::string_view text);

/// Rows' times from their timecodes.
struct TimecodeTimes {
  std::vector<double> seconds;  ///< from the first row; past midnight they go on
  double rate = 0.0;            ///< frames a second: 30000/1001 and its kin where frames are dropped
  bool is_drop_frame = false;
  bool rate_is_known = false;  ///< false when the take shows no whole second to count by
};

/// Counts frames: how many a second has is seen where one second follows another (last frame, step, first
/// frame). `given` frames a second go before what is seen; 0 for none. Dropped frames (SMPTE ST 12-1: two of
/// each minute but every tenth at 30, four at 60) are known by their mark, or by the minutes that lack them.
/// Without a whole second to see, the rate is 60, which is what a phone records.
TimecodeTimes timecode_times(const std::vector<Timecode>& codes, double given);

}  // namespace fascia::runtime
