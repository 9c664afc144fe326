#include "app/engine/simulation.h"

#include <chrono>
#include <exception>
#include <utility>

namespace fascia::app {

namespace {

using Clock = std::chrono::steady_clock;
constexpr double frame_seconds = 1.0 / 60.0;
constexpr double still_metres = 4e-6;  ///< a frame; below what a pixel shows
constexpr int still_frames = 15;       ///< slow creep would stop short with fewer

}  // namespace

Simulation::Simulation(std::shared_ptr<const FaceAsset> asset, fascia_solver solver, Pace pace)
    : session_(std::move(asset), solver), pace_(pace) {
  publish();
  if (pace_ == Pace::real_time) thread_ = std::thread([this] { run(); });
}

Simulation::~Simulation() {
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    ends_ = true;
  }
  wake_.notify_all();
  if (thread_.joinable()) thread_.join();
}

void Simulation::submit(const FaceInputs& inputs) {
  if (pace_ == Pace::lockstep) {
    const bool is_news = !(inputs == wanted_);
    wanted_ = inputs;
    if (is_news) still_frames_ = 0;
    is_moving_ = still_frames_ < still_frames;
    if (!is_moving_) return;
    session_.advance(inputs, frame_seconds);
    still_frames_ = session_.frame().largest_motion < still_metres ? still_frames_ + 1 : 0;
    publish();
    return;
  }
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    if (inputs == wanted_) return;
    wanted_ = inputs;
    has_news_ = true;
    is_moving_ = true;
  }
  wake_.notify_all();
}

std::shared_ptr<const FaceFrame> Simulation::frame() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  return frame_;
}

bool Simulation::is_moving() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  return is_moving_;
}

std::string Simulation::take_fault() {
  const std::lock_guard<std::mutex> lock(mutex_);
  return std::exchange(fault_, {});
}

void Simulation::publish() {
  auto copy = std::make_shared<const FaceFrame>(session_.frame());
  const std::lock_guard<std::mutex> lock(mutex_);
  frame_ = std::move(copy);
}

void Simulation::run() {
  auto last = Clock::now();
  for (;;) {
    FaceInputs inputs;
    {
      std::unique_lock<std::mutex> lock(mutex_);
      if (still_frames_ >= still_frames && !has_news_) {
        is_moving_ = false;
        wake_.wait(lock, [this] { return has_news_ || ends_; });
        last = Clock::now();
      }
      if (ends_) return;
      if (std::exchange(has_news_, false)) still_frames_ = 0;
      inputs = wanted_;
    }
    try {
      const auto now = Clock::now();
      const double passed = std::chrono::duration<double>(now - last).count();
      last = now;
      session_.advance(inputs, std::max(passed, 1e-3));
      still_frames_ = session_.frame().largest_motion < still_metres ? still_frames_ + 1 : 0;
    } catch (const std::exception& error) {
      const std::lock_guard<std::mutex> lock(mutex_);
      fault_ = error.what();
      still_frames_ = still_frames;
    }
    publish();
    std::this_thread::sleep_until(
        last + std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(frame_seconds)));
  }
}

}  // namespace fascia::app
