#include "batch/process.h"

#include <fcntl.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <cstring>
#include <fstream>
#include <thread>

#include "geometry/error.h"

namespace fascia::batch {

namespace {

using Clock = std::chrono::steady_clock;

/// In the child, between fork and exec: calls that are safe there, and nothing else.
[[noreturn]] void become(char* const* arguments, const Limits& limits, int in, int out, int err,
                         pid_t parent) {
  prctl(PR_SET_PDEATHSIG, SIGTERM);
  if (getppid() != parent) _exit(127);  // it died before the line above
  for (const int number : {SIGINT, SIGTERM, SIGHUP, SIGPIPE, SIGXFSZ})
    signal(number, SIG_DFL);
  sigset_t none;
  sigemptyset(&none);
  sigprocmask(SIG_SETMASK, &none, nullptr);
  if (limits.megabytes > 0) {
    const rlimit memory = {limits.megabytes << 20, limits.megabytes << 20};
    setrlimit(RLIMIT_AS, &memory);
  }
  const rlimit no_core = {0, 0};
  setrlimit(RLIMIT_CORE, &no_core);
  dup2(in, 0);
  dup2(out, 1);
  dup2(err, 2);
  execv(arguments[0], arguments);
  _exit(127);
}

class File {
 public:
  File(const std::string& path, int flags) : descriptor_(open(path.c_str(), flags | O_CLOEXEC, 0666)) {
    if (descriptor_ < 0) throw Error("'" + path + "' cannot be opened: " + std::strerror(errno));
  }
  ~File() { close(descriptor_); }
  File(const File&) = delete;
  File& operator=(const File&) = delete;
  int descriptor() const { return descriptor_; }

 private:
  int descriptor_;
};

std::string beginning_of(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  std::string text(size_t{8} << 20, '\0');
  file.read(text.data(), static_cast<std::streamsize>(text.size()));
  text.resize(static_cast<size_t>(file.gcount()));
  return text;
}

double seconds_of(const timeval& time) {
  return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
}

}  // namespace

Outcome run(const std::vector<std::string>& command, const Limits& limits,
            const std::filesystem::path& scratch, const std::atomic<bool>& stop) {
  const std::string out = (scratch / output_name).string(), err = (scratch / errors_name).string();
  std::vector<char*> arguments;
  for (const std::string& word : command)
    arguments.push_back(const_cast<char*>(word.c_str()));
  arguments.push_back(nullptr);
  Outcome outcome;
  {
    const File in_file("/dev/null", O_RDONLY), out_file(out, O_WRONLY | O_CREAT | O_TRUNC),
        err_file(err, O_WRONLY | O_CREAT | O_TRUNC);
    const auto started = Clock::now();
    const auto elapsed = [&] { return std::chrono::duration<double>(Clock::now() - started).count(); };
    const pid_t parent = getpid(), child = fork();
    if (child < 0) throw Error(std::string("no process can be started: ") + std::strerror(errno));
    if (child == 0)
      become(arguments.data(), limits, in_file.descriptor(), out_file.descriptor(), err_file.descriptor(),
             parent);
    int status = 0;
    rusage usage = {};
    double told_at = -1.0;  // when it was told to end
    constexpr double patience = 3.0;
    for (auto pause = std::chrono::milliseconds(1);;
         pause = std::min(2 * pause, std::chrono::milliseconds(20))) {
      const pid_t ended = wait4(child, &status, WNOHANG, &usage);
      if (ended == child) break;
      if (ended < 0 && errno != EINTR)
        throw Error(std::string("a process was lost: ") + std::strerror(errno));
      const bool is_late = limits.seconds > 0.0 && elapsed() > limits.seconds;
      if (told_at < 0.0 && (is_late || stop)) {
        outcome.is_late = is_late;
        told_at = elapsed();
        kill(child, SIGTERM);
      } else if (told_at >= 0.0 && elapsed() > told_at + patience) {
        kill(child, SIGKILL);
      }
      std::this_thread::sleep_for(pause);
    }
    outcome.seconds = elapsed();
    outcome.cpu_seconds = seconds_of(usage.ru_utime) + seconds_of(usage.ru_stime);
    outcome.megabytes = static_cast<double>(usage.ru_maxrss) / 1024.0;
    if (WIFEXITED(status)) outcome.exit_code = WEXITSTATUS(status);
    if (WIFSIGNALED(status)) outcome.signal = WTERMSIG(status);
  }
  outcome.out = beginning_of(out);
  outcome.err = beginning_of(err);
  unlink(out.c_str());
  unlink(err.c_str());
  return outcome;
}

}  // namespace fascia::batch
