#pragma once

#include <fascia/fascia.h>

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

namespace fascia::app {

/// A recording of a face, read by the runtime: any file of docs/curves.md.
class Take {
 public:
  /// Throws fascia::Error naming the file and what is wrong with it.
  explicit Take(const std::filesystem::path& file);

  const std::filesystem::path& file() const { return file_; }
  double duration() const { return duration_; }
  double frames_per_second() const { return frames_per_second_; }
  const std::vector<std::string>& names() const { return names_; }
  const std::vector<std::string>& notes() const { return notes_; }
  const fascia_curves* handle() const { return curves_.get(); }

  /// Which of the curves the rig has a name for.
  std::vector<bool> matched(const fascia_asset* asset) const;

 private:
  struct Release {
    void operator()(fascia_curves* curves) const { fascia_curves_release(curves); }
  };
  std::filesystem::path file_;
  std::unique_ptr<fascia_curves, Release> curves_;
  double duration_ = 0.0, frames_per_second_ = 0.0;
  std::vector<std::string> names_, notes_;
};

}  // namespace fascia::app
