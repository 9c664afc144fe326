#include "view/video.h"

#include <csignal>
#include <cstdio>
#include <cstdlib>

#include "formats/new_file.h"
#include "geometry/error.h"
#include "geometry/text.h"

namespace fascia::view {

struct Video::State {
  std::filesystem::path path;
  formats::NewFile file;  ///< what ffmpeg writes
  int width = 0, height = 0;
  FILE* pipe = nullptr;
  bool is_broken = false;
  explicit State(const std::filesystem::path& film) : path(film), file(formats::NewFile::nameless(film)) {}
};

namespace {

/// A path as one word for the shell.
std::string quoted(const std::string& path) {
  std::string word = "'";
  for (char c : path)
    word += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return word + "'";
}

/// What ffmpeg is told of the film itself; the same frames give the same bytes.
std::string encoding_of(const std::string& extension) {
  if (extension == ".gif")
    return " -f gif -filter_complex "
           "'[0:v]split[a][b];[a]palettegen=stats_mode=diff[p];[b][p]paletteuse=dither=bayer:bayer_scale=4'"
           " -loop 0";
  if (extension == ".webp") return " -f webp -c:v libwebp_anim -quality 82 -loop 0";
  return " -f mp4 -c:v libx264 -crf 18 -preset medium -pix_fmt yuv420p -movflags +faststart";
}

}  // namespace

bool is_film(const std::filesystem::path& path) {
  const std::string extension = extension_of(path);
  return extension == ".mp4" || extension == ".gif" || extension == ".webp";
}

Video::Video(const std::filesystem::path& path, int width, int height, double frames_per_second) {
  if (std::system("command -v ffmpeg >/dev/null 2>&1") != 0)
    throw Error("films are made by ffmpeg, which is not installed (Debian: apt-get install ffmpeg)");
  state_ = std::make_unique<State>(path);
  state_->width = width;
  state_->height = height;
  std::signal(SIGPIPE, SIG_IGN);
  const std::string command =
      "ffmpeg -y -loglevel error -f rawvideo -pix_fmt rgb24 -s " + std::to_string(width) + "x" +
      std::to_string(height) + " -r " + std::to_string(frames_per_second) + " -i - -an" +
      encoding_of(is_film(path) ? extension_of(path) : ".mp4") +
      " -fflags +bitexact -flags:v +bitexact -threads 1 " + quoted(state_->file.opened().string());
  state_->pipe = popen(command.c_str(), "w");
  if (!state_->pipe) throw Error("ffmpeg cannot be started");
}

Video::~Video() {
  if (state_->pipe) pclose(state_->pipe);
}

void Video::add(const Image& frame) {
  if (frame.width != state_->width || frame.height != state_->height)
    throw Error("a frame has another size than its film");
  state_->is_broken |=
      std::fwrite(frame.pixels.data(), 1, frame.pixels.size(), state_->pipe) != frame.pixels.size();
}

void Video::finish() {
  const int status = pclose(state_->pipe);
  state_->pipe = nullptr;
  if (status != 0 || state_->is_broken)
    throw Error("'" + state_->path.string() + "' cannot be written: ffmpeg failed");
  state_->file.put_in_place();
}

}  // namespace fascia::view
