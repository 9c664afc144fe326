#pragma once

#include <atomic>
#include <chrono>
#include <filesystem>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "app/engine/face_session.h"
#include "builder/rigging/build_rig.h"
#include "rig/model/rig.h"
#include "view/face/appearance.h"

namespace fascia::app {

/// A rig with what the window shows of it.
struct LoadedRig {
  std::filesystem::path file;
  std::shared_ptr<const FaceAsset> asset;
  std::shared_ptr<const rig::Rig> rig;
  std::shared_ptr<const view::Appearance> appearance;  ///< the file's materials and textures
  std::optional<rigging::BuildReport> report;          ///< when it has just been built
  Mat4 head_to_metres = Mat4::Identity();  ///< from the axes and units of the head it was built from
  std::filesystem::path head;              ///< what to build from: see load_rig()
};

/// Reads a rig file. What it was built from is taken out of it and laid down beside `cache` when it has to be
/// built again. Throws fascia::Error.
LoadedRig load_rig(const std::filesystem::path& file, const std::filesystem::path& cache);

/// What to build, or to open.
struct BuildOrder {
  std::filesystem::path head;   ///< a mesh; a file that holds a rig is loaded unless it is to be built anew
  std::filesystem::path cache;  ///< folder for the rig that is built, and the head that a rig was built from
  std::filesystem::path edits;  ///< empty: none
  std::string detail = "medium";
  bool builds_anew = false;
};

/// A build (or the loading of a rig) on a thread of its own, to be watched and given up from the window's.
class BuildTask {
 public:
  explicit BuildTask(BuildOrder order);
  ~BuildTask();
  BuildTask(const BuildTask&) = delete;
  BuildTask& operator=(const BuildTask&) = delete;

  struct Progress {
    std::string stage;     ///< as people say it
    double share = 0.0;    ///< 0..1, by how long the stages take as a rule
    double seconds = 0.0;  ///< since it began
    bool is_done = false;  ///< take_result() or fault() has what came of it
  };
  Progress progress() const;

  /// Gives up at the end of the stage that runs; progress() says when.
  void cancel() { is_cancelled_ = true; }
  const std::filesystem::path& cache() const { return cache_; }
  bool was_cancelled() const { return is_cancelled_; }

  /// The rig, once; nothing when it failed, was given up, or is not done.
  std::optional<LoadedRig> take_result();
  /// Why there is none; empty when there is one, or when it was given up.
  std::string fault() const;

 private:
  void enter(const std::string& stage);
  LoadedRig build(const BuildOrder& order);
  LoadedRig open(const BuildOrder& order);
  void run(const BuildOrder& order);

  std::filesystem::path cache_;
  mutable std::mutex mutex_;
  std::atomic<bool> is_cancelled_ = false;
  Progress progress_;
  std::chrono::steady_clock::time_point started_;
  std::optional<LoadedRig> result_;
  std::string fault_;
  std::thread thread_;
};

}  // namespace fascia::app
