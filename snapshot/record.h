#pragma once

#include <functional>
#include <span>
#include <string>
#include <vector>

#include "snapshot/face_regions.h"
#include "snapshot/snapshot.h"

namespace fascia::snapshot {

/// A take's curves: the bytes of its file.
struct TakeFile {
  std::string name;  ///< name in messages
  std::string path;  ///< path stored in the snapshot
  std::vector<uint8_t> bytes;
};

/// What to record.
struct Request {
  std::string level;                  ///< low, medium, high; empty: the finest
  std::vector<Pose> poses;            ///< none: Player::all_poses
  std::vector<WantedRegion> regions;  ///< none: those of `kept_regions`
  std::vector<Region> kept_regions;   ///< of an earlier snapshot; none: face_regions
  std::vector<Mesh> kept_meshes;      ///< of that snapshot too
  std::vector<TakeFile> takes;
  double frames_per_second = 60.0;  ///< of takes
  size_t frames_kept = 24;          ///< of each take at most, spread evenly
  RegionOptions region_options;
  int threads = 0;  ///< 0: as many as the machine has
  /// Progress callback: number of finished poses and takes, and total; called from any thread, serialised.
  std::function<void(size_t done, size_t all)> progress;
};

/// Plays the requested poses and takes on the rig and records them. `name` is the rig's file, for messages.
/// The numbers are the same at any number of threads. Throws fascia::Error.
Snapshot record(std::span<const uint8_t> rig, const std::string& name, const Request& request);

/// Records the regions, poses and frames of `wanted` on `rig`. `takes` has a file for each of wanted's takes,
/// in order. Throws fascia::Error if the rig lacks the meshes, channels or level, or if a take's file has
/// changed.
Snapshot replay(std::span<const uint8_t> rig, const std::string& name, const Snapshot& wanted,
                const std::vector<TakeFile>& takes, int threads,
                const std::function<void(size_t done, size_t all)>& progress);

}  // namespace fascia::snapshot
