#pragma once

#include <array>
#include <filesystem>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "cli/common.h"
#include "cli/posing.h"

namespace fascia::cli {

/// Curves loaded from a file.
class Curves {
 public:
  /// `frames_per_second` and `time_unit` as in fascia_curves_options; 0 as the file says.
  explicit Curves(const std::filesystem::path& path, double frames_per_second = 0.0, double time_unit = 0.0);

  /// Multiplies what the curves hold, those of layers apart.
  void scale(double weight) { weight_ = weight; }
  /// Adds `layer`, from the same beginning, to what these curves hold; the longest of all tells the duration.
  /// Only these curves turn the head.
  void add(Curves layer);
  /// Values by name that hold all the time, under the curves.
  void hold(std::vector<std::pair<std::string, double>> values) { held_ = std::move(values); }

  /// Leaves only the piece from `from` to `to` seconds, counted from the first key; `to` below 0: to the end.
  /// Times count from `from` afterwards. Throws fascia::Error when there is no such piece.
  void trim(double from, double to);

  double duration() const { return to_ - from_; }  ///< seconds, of the piece
  double start() const { return info_.start + from_; }
  bool turns_head() const { return info_.has_head != 0; }
  /// Whether the head is ever turned away from straight ahead.
  bool head_moves() const;
  const std::vector<std::string>& names() const { return names_; }
  /// How the file was taken and what was mended, a sentence each.
  std::vector<std::string> notes() const { return {info_.notes, info_.notes + info_.note_count}; }
  /// Names that the face's rig has nothing for.
  std::vector<std::string> unmatched(const Face& face) const;
  /// Sets the face's channels to what the curves hold at `seconds`, at the piece's end beyond it.
  void apply(double seconds, const Face& face) const;
  /// How the head is turned: a quaternion, x y z w.
  std::array<float, 4> head(double seconds) const;

 private:
  struct Release {
    void operator()(fascia_curves* curves) const { fascia_curves_release(curves); }
  };
  std::unique_ptr<fascia_curves, Release> curves_;
  fascia_curves_info info_ = {};
  double from_ = 0.0, to_ = 0.0, length_ = 0.0;  ///< seconds; of all layers
  double weight_ = 1.0;
  std::vector<Curves> layers_;
  std::vector<std::pair<std::string, double>> held_;
  std::vector<std::string> names_;
};

/// What of the curves' names the rig knows. Says on stderr how the file was taken, and sums up the names that
/// drive nothing in one line. Throws fascia::Error when none drives anything.
struct MatchedNames {
  std::vector<std::string> matched, unmatched;
};
MatchedNames match(const Common& common, const Curves& curves, const Face& face,
                   const std::filesystem::path& path);

}  // namespace fascia::cli
