#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "cli/posing.h"
#include "formats/new_file.h"

namespace fascia::cli {

/// One object of the user's file, whose vertices a cache holds in the file's own order: a glTF mesh with its
/// primitives one after the other, or an OBJ's object with each of its `v` once.
struct CachedObject {
  struct Point {
    size_t part;  ///< in Face::meshes
    uint32_t vertex;
  };
  std::string name;
  std::vector<Point> points;
};

/// The objects of a rig's file that its face moves; warns where the head lay far from the origin, at which
/// caches, in single precision, are written. Throws fascia::Error when the rig cannot be read.
std::vector<CachedObject> cached_objects(const Common& common, const std::filesystem::path& rig,
                                         const Face& face);

/// Where a take's caches stand: `path` itself for one object, else NAME.OBJECT.EXT for each, in the order of
/// `names`, which are those of the objects.
std::vector<std::filesystem::path> cache_paths(const std::filesystem::path& path,
                                               const std::vector<std::string>& names);

enum class CacheKind { pc2, mdd };

/// Point caches as modelling programs read them, frame by frame: PC2 (little-endian; the format of 3ds Max's
/// Point Cache 2, as Blender's Mesh Cache modifier reads it) or MDD (big-endian, with times; LightWave's).
/// One file an object, where `cache_paths` says. Files are written beside and renamed into place by `finish`;
/// without it nothing stays.
class PointCaches {
 public:
  /// `times` of all frames, seconds. Throws fascia::Error when a file cannot be made.
  PointCaches(const std::filesystem::path& path, CacheKind kind, std::vector<CachedObject> objects,
              const std::vector<float>& times);
  PointCaches(const PointCaches&) = delete;
  PointCaches& operator=(const PointCaches&) = delete;

  /// The next frame: every point where `face` has it now, in the face's space.
  void add(const Face& face);

  /// Puts the files in place and returns their paths. Throws fascia::Error when frames are missing or the
  /// disk is full.
  std::vector<std::filesystem::path> finish();

 private:
  struct File {
    std::filesystem::path path;
    CachedObject object;
    formats::NewFile stream;
  };

  CacheKind kind_;
  size_t frames_ = 0, written_ = 0;
  std::vector<File> files_;
  std::vector<float> points_;
};

/// The kind of cache that a path's extension asks for; nothing for another extension.
bool is_cache(const std::filesystem::path& path, CacheKind& kind);

}  // namespace fascia::cli
