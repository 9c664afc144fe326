#pragma once

#include <memory>

namespace fascia::view {

/// An OpenGL 3.3 core context without a display: EGL's surfaceless platform.
class OffscreenContext {
 public:
  /// Makes it and makes it current. Throws fascia::Error when there is no EGL or OpenGL 3.3 to be had.
  OffscreenContext();
  ~OffscreenContext();
  OffscreenContext(const OffscreenContext&) = delete;
  OffscreenContext& operator=(const OffscreenContext&) = delete;

  void make_current() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace fascia::view
