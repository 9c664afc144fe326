#pragma once

#include <condition_variable>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "app/engine/face_session.h"
#include "geometry/landmarks.h"
#include "rig/model/rig.h"

namespace fascia::app {

/// How far the bones of a rig are from where they were built, metres, one entry a vertex.
struct SkullShift {
  std::vector<Vec3> cranium, mandible, teeth_upper, teeth_lower;
};

/// What a skull is fitted to: the head at rest, vertices at one place joined, metres.
struct HeadMeshes {
  TriangleMesh skin, teeth_upper, teeth_lower;  ///< no teeth: empty
};
HeadMeshes head_meshes(const FaceAsset& asset);

/// The skull of a rig while landmarks are moved by hand: fitted anew under them within a frame or two, on a
/// thread of its own, long before the rig is built again. The fit itself begins in the constructor, so that
/// it is there when the first landmark is moved.
class LiveSkull {
 public:
  enum class Pace { background, at_once };

  /// `head` is called on the fit's thread.
  LiveSkull(std::shared_ptr<const rig::Rig> rig, std::function<HeadMeshes()> head, Pace pace);
  ~LiveSkull();
  LiveSkull(const LiveSkull&) = delete;
  LiveSkull& operator=(const LiveSkull&) = delete;

  /// Where landmarks stand that are not where the rig has them, metres at rest; the others stand as it has
  /// them.
  void submit(const Landmarks& moved);

  /// The newest shift; null while nothing is moved, and where no skull can be fitted.
  std::shared_ptr<const SkullShift> shift() const;

 private:
  class Fit;
  void run();
  void follow(const Landmarks& moved);

  std::shared_ptr<const rig::Rig> rig_;
  std::function<HeadMeshes()> head_;
  const Pace pace_;
  std::unique_ptr<Fit> fit_;  // of the thread, where there is one
  mutable std::mutex mutex_;
  std::condition_variable wake_;
  Landmarks wanted_;
  bool has_news_ = false, ends_ = false;
  std::shared_ptr<const SkullShift> shift_;
  std::thread thread_;
};

}  // namespace fascia::app
