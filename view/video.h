#pragma once

#include <filesystem>
#include <memory>

#include "view/image.h"

namespace fascia::view {

/// Whether a path's extension is that of a film: .mp4, .gif or .webp.
bool is_film(const std::filesystem::path& path);

/// A film, made by the `ffmpeg` program: H.264 in MP4, or a looping GIF or WebP, by the path's extension.
class Video {
 public:
  /// Throws fascia::Error when ffmpeg is not installed.
  Video(const std::filesystem::path& path, int width, int height, double frames_per_second);
  ~Video();
  Video(const Video&) = delete;
  Video& operator=(const Video&) = delete;

  void add(const Image& frame);

  /// Ends the film and renames it into place. Throws fascia::Error when ffmpeg failed.
  void finish();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace fascia::view
