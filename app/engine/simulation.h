#pragma once

#include <condition_variable>
#include <memory>
#include <mutex>
#include <string>
#include <thread>

#include "app/engine/face_session.h"

namespace fascia::app {

/// A face that lives on a thread of its own: the window hands in what is wanted and takes the newest frame,
/// and never waits. When nothing moves any more the thread sleeps.
class Simulation {
 public:
  enum class Pace {
    real_time,  ///< on its own thread, by the clock
    lockstep    ///< in submit(), a sixtieth of a second each: the same every time
  };

  /// Throws fascia::Error when the face or its solver cannot be made.
  Simulation(std::shared_ptr<const FaceAsset> asset, fascia_solver solver, Pace pace);
  ~Simulation();
  Simulation(const Simulation&) = delete;
  Simulation& operator=(const Simulation&) = delete;

  /// What is wanted from now on.
  void submit(const FaceInputs& inputs);

  /// The newest frame; never null. It does not change any more.
  std::shared_ptr<const FaceFrame> frame() const;

  /// True while the face still moves or has not yet seen the last inputs.
  bool is_moving() const;

  /// What went wrong in the thread, once; empty when nothing did.
  std::string take_fault();

  const FaceAsset& asset() const { return session_.asset(); }

 private:
  void run();
  void publish();

  FaceSession session_;
  const Pace pace_;
  mutable std::mutex mutex_;
  std::condition_variable wake_;
  FaceInputs wanted_;
  std::shared_ptr<const FaceFrame> frame_;
  bool is_moving_ = false, has_news_ = false, ends_ = false;
  std::string fault_;
  int still_frames_ = 0;
  std::thread thread_;
};

}  // namespace fascia::app
