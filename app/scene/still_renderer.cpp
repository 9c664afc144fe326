#include "app/scene/still_renderer.h"

#include <algorithm>
#include <exception>
#include <utility>

namespace fascia::app {

StillRenderer::StillRenderer() : thread_([this] { run(); }) {}

StillRenderer::~StillRenderer() {
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    ends_ = true;
  }
  wake_.notify_all();
  thread_.join();
}

void StillRenderer::order(Order order) {
  ordered_ = order.key;
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    next_ = std::move(order);
  }
  wake_.notify_all();
}

std::optional<StillRenderer::Picture> StillRenderer::take() {
  const std::lock_guard<std::mutex> lock(mutex_);
  return std::exchange(done_, std::nullopt);
}

bool StillRenderer::works() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  return works_;
}

void StillRenderer::run() {
  std::unique_ptr<view::Renderer> renderer;
  int width = 0, height = 0;
  for (;;) {
    Order order;
    {
      std::unique_lock<std::mutex> lock(mutex_);
      wake_.wait(lock, [this] { return next_ || ends_; });
      if (ends_) return;
      order = *std::exchange(next_, std::nullopt);
    }
    try {
      const int count = static_cast<int>(order.shots.size()), part = order.width / std::max(count, 1);
      // The last one has the odd pixel, and the others are drawn that wide too.
      const int widest = order.width - (count - 1) * part;
      if (!renderer || widest != width || order.height != height) {
        renderer.reset();
        renderer = std::make_unique<view::Renderer>(widest, order.height);
        width = widest;
        height = order.height;
      }
      Picture picture{std::move(order.key), view::Image(order.width, order.height, order.look.background)};
      for (int i = 0; i < count; ++i) {
        const Order::Shot& shot = order.shots[static_cast<size_t>(i)];
        view::paste(picture.image, renderer->draw_with(shot.list, shot.camera, order.look), i * part, 0);
      }
      const std::lock_guard<std::mutex> lock(mutex_);
      done_ = std::move(picture);
    } catch (const std::exception&) {
      // The window's own picture stays: plainer, but there.
      const std::lock_guard<std::mutex> lock(mutex_);
      works_ = false;
      renderer.reset();
    }
  }
}

}  // namespace fascia::app
