#pragma once

#include <memory>
#include <string>
#include <vector>

#include "fascia/fit.h"
#include "fit/live/tracker.h"
#include "runtime/asset.h"

namespace fascia::runtime {

/// One observed face: points of a detector on their way to landmarks, and the tracker that follows them.
class Fit {
 public:
  /// Throws Failure when the landmarks or the options make no sense.
  Fit(std::shared_ptr<const Asset> asset, const fascia_fit_landmarks& landmarks,
      const fascia_fit_options& options);

  uint32_t point_count() const { return point_count_; }
  uint32_t dimensions() const { return tracker_->options().camera ? 2 : 3; }
  const std::vector<const char*>& names() const { return name_list_; }  ///< of landmarks

  void set_neutral(const float* points, const float* weights);
  /// The result's pointers are into this.
  fascia_fit_result push(const float* points, const float* weights);
  void reset() { tracker_->reset(); }

 private:
  /// A landmark of the tracker, and the points of a frame whose middle it is.
  struct Source {
    std::vector<uint32_t> points;
    std::string name;
  };
  void add(std::vector<fit::Landmark>& landmarks, const char* name, std::vector<uint32_t> points);
  void take(const float* points, const float* weights);

  std::shared_ptr<const Asset> asset_;
  std::size_t level_ = 0;
  uint32_t point_count_ = 0;
  std::vector<Source> sources_;
  std::vector<const char*> name_list_;
  std::unique_ptr<fit::Tracker> tracker_;
  std::vector<Vec3> places_;
  std::vector<double> weights_;
  std::vector<float> shown_;  ///< landmarks, as handed out
};

}  // namespace fascia::runtime

struct fascia_fit {
  std::unique_ptr<fascia::runtime::Fit> fit;
  fascia::runtime::CountedHandle counted{};
};
