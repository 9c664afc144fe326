#include "view/video.h"

#include <fcntl.h>
#include <unistd.h>
#include <csignal>
#include <cstdio>
#include <cstdlib>

#include "geometry/error.h"
#include "geometry/text.h"

namespace fascia::view {

struct Video::State {
  std::filesystem::path path, beside;
  int width = 0, height = 0;
  int nameless = -1;  ///< what ffmpeg writes, a file without a name: an interrupted film leaves nothing
  FILE* pipe = nullptr;
  bool is_broken = false;
  ~State() {
    if (nameless >= 0) close(nameless);
  }
};

namespace {

/// A path as one word for the shell.
std::string quoted(const std::string& path) {
  std::string word = "'";
  for (char c : path)
    word += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return word + "'";
}

/// A file in the folder of `path` that has no name until it is given one; -1 where there is no such thing.
int nameless_file(const std::filesystem::path& path) {
#ifdef O_TMPFILE
  const std::filesystem::path folder = path.has_parent_path() ? path.parent_path() : ".";
  return open(folder.c_str(), O_TMPFILE | O_RDWR, 0666);
#else
  (void)path;
  return -1;
#endif
}

/// The file as this and any other process that has inherited it can open it.
std::string opened(int file) {
  return "/proc/self/fd/" + std::to_string(file);
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

Video::Video(const std::filesystem::path& path, int width, int height, double frames_per_second)
    : state_(std::make_unique<State>()) {
  if (std::system("command -v ffmpeg >/dev/null 2>&1") != 0)
    throw Error("films are made by ffmpeg, which is not installed (Debian: apt-get install ffmpeg)");
  state_->path = path;
  state_->beside = path;
  const std::string extension = is_film(path) ? extension_of(path) : ".mp4";
  state_->beside += "." + std::to_string(getpid()) + ".part" + extension;
  state_->nameless = nameless_file(path);
  state_->width = width;
  state_->height = height;
  std::signal(SIGPIPE, SIG_IGN);
  const std::string command =
      "ffmpeg -y -loglevel error -f rawvideo -pix_fmt rgb24 -s " + std::to_string(width) + "x" +
      std::to_string(height) + " -r " + std::to_string(frames_per_second) + " -i - -an" +
      encoding_of(extension) + " -fflags +bitexact -flags:v +bitexact -threads 1 " +
      quoted(state_->nameless >= 0 ? opened(state_->nameless) : state_->beside.string());
  state_->pipe = popen(command.c_str(), "w");
  if (!state_->pipe) throw Error("ffmpeg cannot be started");
}

Video::~Video() {
  if (!state_->pipe) return;
  pclose(state_->pipe);
  std::error_code ignored;
  std::filesystem::remove(state_->beside, ignored);
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
  std::error_code failure;
  if (status == 0 && !state_->is_broken && state_->nameless >= 0)
    state_->is_broken = linkat(AT_FDCWD, opened(state_->nameless).c_str(), AT_FDCWD, state_->beside.c_str(),
                               AT_SYMLINK_FOLLOW) != 0;
  if (status == 0 && !state_->is_broken) std::filesystem::rename(state_->beside, state_->path, failure);
  if (status != 0 || state_->is_broken || failure) {
    std::filesystem::remove(state_->beside, failure);
    throw Error("'" + state_->path.string() + "' cannot be written: ffmpeg failed");
  }
}

}  // namespace fascia::view
