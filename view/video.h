#pragma once

#include <filesystem>
#include <memory>

#include "view/image.h"

namespace fascia::view {

/// An H.264 film in an MP4 file, made by the `ffmpeg` program.
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
