#pragma once

#include <cstdint>
#include <random>

#include "app/panels/screen.h"
#include "app/window/window.h"
#include "app/workspace.h"

namespace fascia::app {

/// Random mouse and keys, to find what nobody thought of. The same seed and timing do the same.
class Monkey {
 public:
  explicit Monkey(uint64_t seed) : random_(seed) {}

  /// The next frame's input; now and then it opens a head, loads nonsense or changes the window's size.
  void advance(Workspace& work, Screen& screen, Window& window);
  const SyntheticInput& input() const { return input_; }

 private:
  int upto(int count) { return static_cast<int>(random_() % static_cast<uint64_t>(count)); }
  float share() { return static_cast<float>(random_() % 10000) / 10000.0F; }
  void choose_place(const Window& window);

  std::mt19937_64 random_;
  SyntheticInput input_;
  int rest_ = 0;  ///< frames until the next thought
};

}  // namespace fascia::app
