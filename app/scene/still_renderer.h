#pragma once

#include <condition_variable>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "view/renderer.h"

namespace fascia::app {

/// Draws pictures with everything on a thread of its own, in an OpenGL context of its own: where there is no
/// graphics card that takes longer than a window may stand still.
class StillRenderer {
 public:
  struct Order {
    /// One picture, or one for each half beside each other.
    struct Shot {
      view::DrawList list;
      view::Camera camera;
    };
    std::string key;  ///< what the picture is of
    std::vector<Shot> shots;
    view::Look look;
    int width = 0, height = 0;
  };
  struct Picture {
    std::string key;
    view::Image image;
  };

  StillRenderer();
  ~StillRenderer();
  StillRenderer(const StillRenderer&) = delete;
  StillRenderer& operator=(const StillRenderer&) = delete;

  /// Orders a picture; one that is not begun yet is dropped for it.
  void order(Order order);
  /// The key of the picture last ordered.
  const std::string& ordered() const { return ordered_; }
  /// The picture, once, when it is there.
  std::optional<Picture> take();
  /// False where there is no second context to be had.
  bool works() const;

 private:
  void run();

  std::string ordered_;
  mutable std::mutex mutex_;
  std::condition_variable wake_;
  std::optional<Order> next_;
  std::optional<Picture> done_;
  bool ends_ = false, works_ = true;
  std::thread thread_;
};

}  // namespace fascia::app
