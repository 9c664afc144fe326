#pragma once

#include <chrono>
#include <future>
#include <optional>
#include <utility>
#include <vector>

namespace fascia::app {

/// Something that is made on a thread of its own. To order another one, or none, does not wait for the one
/// under way; only the end does.
template <class Result>
class Pending {
 public:
  template <class Make>
  void start(Make make) {
    give_up();
    under_way_ = std::async(std::launch::async, std::move(make));
  }
  void give_up() {
    if (under_way_.valid()) given_up_.push_back(std::move(under_way_));
  }
  bool is_running() const { return under_way_.valid(); }

  /// What has been made, once; nothing while it is being made, unless that is waited for. Throws what its
  /// making threw.
  std::optional<Result> take(bool waits = false) {
    std::erase_if(given_up_, is_done);
    if (!under_way_.valid() || (!waits && !is_done(under_way_))) return std::nullopt;
    return under_way_.get();
  }

 private:
  static bool is_done(const std::future<Result>& future) {
    return future.wait_for(std::chrono::seconds(0)) == std::future_status::ready;
  }
  std::future<Result> under_way_;
  std::vector<std::future<Result>> given_up_;
};

}  // namespace fascia::app
