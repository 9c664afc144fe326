// A hundred faces on the host's own threads: crowd RIG.glb CURVES [--faces 100] [--threads N] [--frames 120]
// [--svg FILE]
//
// Each face plays the curves from a time of its own. Those nearest to the camera are finer than the others.
// The frame graph goes to FILE as SVG: milliseconds by frame, and the line of 60 frames a second.
#include <fascia/fascia.hpp>

#include <algorithm>
#include <charconv>
#include <chrono>
#include <condition_variable>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <mutex>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

namespace {

using Clock = std::chrono::steady_clock;

/// A pool of threads as an engine has one; the runtime hands it ranges of faces.
class Pool {
 public:
  explicit Pool(unsigned threads) {
    for (unsigned i = 1; i < threads; ++i)
      workers_.emplace_back([this] { work(); });
  }
  ~Pool() {
    {
      const std::lock_guard lock(mutex_);
      ends_ = true;
    }
    wake_.notify_all();
    for (std::thread& worker : workers_)
      worker.join();
  }
  Pool(const Pool&) = delete;
  Pool& operator=(const Pool&) = delete;

  fascia_tasks tasks() { return {sizeof(fascia_tasks), 0, begin, finish, this}; }

 private:
  static void* begin(fascia_task_range run, uint32_t count, uint32_t least, void* context, void* user) {
    auto* pool = static_cast<Pool*>(user);
    {
      const std::lock_guard lock(pool->mutex_);
      pool->run_ = run;
      pool->context_ = context;
      pool->count_ = count;
      pool->least_ = std::max(1U, least);
      pool->next_ = pool->done_ = 0;
    }
    pool->wake_.notify_all();
    return pool;
  }
  static void finish(void*, void* user) {
    auto* pool = static_cast<Pool*>(user);
    pool->take_ranges();  // this thread helps
    std::unique_lock lock(pool->mutex_);
    pool->finished_.wait(lock, [pool] { return pool->done_ == pool->count_; });
  }
  /// Runs ranges until none is left.
  void take_ranges() {
    std::unique_lock lock(mutex_);
    while (next_ < count_) {
      const uint32_t first = next_, end = std::min(count_, first + least_);
      next_ = end;
      lock.unlock();
      run_(first, end, context_);
      lock.lock();
      done_ += end - first;
      if (done_ == count_) finished_.notify_all();
    }
  }
  void work() {
    for (;;) {
      {
        std::unique_lock lock(mutex_);
        wake_.wait(lock, [this] { return ends_ || next_ < count_; });
        if (ends_) return;
      }
      take_ranges();
    }
  }

  std::mutex mutex_;
  std::condition_variable wake_, finished_;
  std::vector<std::thread> workers_;
  fascia_task_range run_ = nullptr;
  void* context_ = nullptr;
  uint32_t count_ = 0, least_ = 1, next_ = 0, done_ = 0;
  bool ends_ = false;
};

std::vector<std::uint8_t> file_bytes(const std::string& path) {
  std::ifstream stream(path, std::ios::binary);
  if (!stream) throw std::runtime_error("cannot read " + path);
  return {std::istreambuf_iterator<char>(stream), {}};
}

void draw(const std::string& path, const std::vector<double>& milliseconds) {
  const double most = std::max(20.0, 1.1 * *std::max_element(milliseconds.begin(), milliseconds.end()));
  std::ofstream svg(path);
  const auto height = [most](double ms) { return 200.0 - 190.0 * ms / most; };
  svg << "<svg xmlns='http://www.w3.org/2000/svg' viewBox='0 0 640 230' font-family='sans-serif' "
         "font-size='11'>\n"
      << "<rect width='640' height='230' fill='white'/>\n<line x1='40' x2='630' y1='" << height(1000.0 / 60)
      << "' y2='" << height(1000.0 / 60) << "' stroke='#c33' stroke-dasharray='4 3'/>\n<text x='44' y='"
      << height(1000.0 / 60) - 4
      << "' fill='#c33'>60 frames a second</text>\n<polyline fill='none' stroke='#246' points='";
  for (std::size_t i = 0; i < milliseconds.size(); ++i)
    svg << 40.0 + 590.0 * static_cast<double>(i) / static_cast<double>(milliseconds.size()) << ','
        << height(milliseconds[i]) << ' ';
  svg << "'/>\n<text x='4' y='14'>" << static_cast<int>(most) << " ms</text><text x='4' y='200'>0</text>"
      << "<text x='300' y='222'>" << milliseconds.size() << " frames</text>\n</svg>\n";
  if (!svg) throw std::runtime_error("cannot write " + path);
}

int count_of(const std::string& option, const std::string& word) {
  int count = 0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), count);
  if (error != std::errc() || end != word.data() + word.size() || count < 1)
    throw std::runtime_error(option + " takes a whole number from 1, not '" + word + "'");
  return count;
}

int run(const std::vector<std::string>& words) {
  std::vector<std::string> files;
  std::string svg;
  int count = 100, frames = 120,
      threads = static_cast<int>(std::max(1U, std::thread::hardware_concurrency()));
  for (std::size_t i = 0; i < words.size(); ++i) {
    const bool has_next = i + 1 < words.size();
    if (words[i] == "--faces" && has_next)
      count = count_of("--faces", words[++i]);
    else if (words[i] == "--frames" && has_next)
      frames = count_of("--frames", words[++i]);
    else if (words[i] == "--threads" && has_next)
      threads = count_of("--threads", words[++i]);
    else if (words[i] == "--svg" && has_next)
      svg = words[++i];
    else
      files.push_back(words[i]);
  }
  if (files.size() != 2) {
    std::fprintf(stderr, "usage: crowd RIG.glb CURVES [--faces N] [--threads N] [--frames N] [--svg FILE]\n");
    return 2;
  }
  const auto asset = fascia::api::Asset::load(file_bytes(files[0]));
  const auto curves = fascia::api::Curves::load(file_bytes(files[1]));
  const double duration = std::max(0.1, curves.info().duration);
  const auto levels = static_cast<int32_t>(asset.info().level_count);
  std::vector<fascia::api::Face> faces;
  std::vector<fascia_face*> handles;
  for (int i = 0; i < count; ++i) {
    fascia_face_options options = fascia_default_face_options();
    options.level = i < count / 20 ? std::min(1, levels - 1) : 0;  // those in front
    options.iterations = i < count / 4 ? 2 : 1;
    handles.push_back(faces.emplace_back(asset, options).handle());
    faces.back().positions(0);  // what is looked at is moved in the step, on its thread
  }
  Pool pool(static_cast<unsigned>(threads));
  const fascia_tasks tasks = pool.tasks();
  std::vector<double> milliseconds;
  for (int frame = 0; frame < frames; ++frame) {
    for (std::size_t i = 0; i < faces.size(); ++i) {
      const double time = frame / 60.0 + 0.37 * static_cast<double>(i);
      faces[i].apply(curves, time - duration * static_cast<double>(static_cast<long>(time / duration)));
    }
    const auto before = Clock::now();
    fascia::api::faces_step(handles, 1.0F / 60.0F, &tasks);
    milliseconds.push_back(std::chrono::duration<double, std::milli>(Clock::now() - before).count());
  }
  if (!svg.empty()) draw(svg, milliseconds);
  std::sort(milliseconds.begin(), milliseconds.end());
  std::printf("%d faces, %d threads, %d frames: median %.2f ms, 99 %% %.2f ms\n", count, threads, frames,
              milliseconds[milliseconds.size() / 2], milliseconds[milliseconds.size() * 99 / 100]);
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  try {
    return run({argv + 1, argv + argc});
  } catch (const std::exception& error) {
    std::fprintf(stderr, "crowd: %s\n", error.what());
    return 1;
  }
}
