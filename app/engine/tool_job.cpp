#include "app/engine/tool_job.h"

#include <fcntl.h>
#include <signal.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstring>

#include "geometry/error.h"

extern char** environ;

namespace fascia::app {

ToolJob::ToolJob(std::filesystem::path tool, std::vector<std::string> arguments, std::string title)
    : arguments_(std::move(arguments)), title_(std::move(title)), started_(std::chrono::steady_clock::now()) {
  int out[2], err[2];
  if (pipe2(out, O_CLOEXEC) != 0) throw Error("no pipe for '" + title_ + "': " + std::strerror(errno));
  if (pipe2(err, O_CLOEXEC) != 0) {
    close(out[0]);
    close(out[1]);
    throw Error("no pipe for '" + title_ + "': " + std::strerror(errno));
  }
  std::string program = tool.string();
  std::vector<char*> words = {program.data()};
  for (std::string& word : arguments_)
    words.push_back(word.data());
  words.push_back(nullptr);
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_addopen(&actions, 0, "/dev/null", O_RDONLY, 0);
  posix_spawn_file_actions_adddup2(&actions, out[1], 1);
  posix_spawn_file_actions_adddup2(&actions, err[1], 2);
  const int result = posix_spawn(&process_, program.c_str(), &actions, nullptr, words.data(), environ);
  posix_spawn_file_actions_destroy(&actions);
  close(out[1]);
  close(err[1]);
  streams_[0] = out[0];
  streams_[1] = err[0];
  for (const int stream : streams_)
    fcntl(stream, F_SETFL, O_NONBLOCK);
  if (result == 0) return;
  close(out[0]);
  close(err[0]);
  throw Error("'" + program + "' cannot be started: " + std::strerror(result));
}

ToolJob::~ToolJob() {
  if (!is_done_ && process_ > 0) {
    kill(process_, SIGKILL);
    waitpid(process_, nullptr, 0);
  }
  for (const int stream : streams_)
    if (stream >= 0) close(stream);
}

void ToolJob::drain(int& stream, std::string& text) {
  char bytes[4096];
  while (stream >= 0) {
    const ssize_t count = read(stream, bytes, sizeof bytes);
    if (count > 0) {
      text.append(bytes, static_cast<size_t>(count));
    } else if (count < 0 && errno == EINTR) {
      continue;
    } else {
      if (count == 0) {
        close(stream);
        stream = -1;
      }
      return;
    }
  }
}

bool ToolJob::poll() {
  if (is_done_) return true;
  drain(streams_[0], output_);
  drain(streams_[1], message_);
  int status = 0;
  if (waitpid(process_, &status, WNOHANG) != process_) return false;
  drain(streams_[0], output_);
  drain(streams_[1], message_);
  exit_code_ = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  ended_ = std::chrono::steady_clock::now();
  is_done_ = true;
  return true;
}

void ToolJob::cancel() {
  if (is_done_) return;
  is_cancelled_ = true;
  kill(process_, SIGTERM);
}

double ToolJob::seconds() const {
  return std::chrono::duration<double>((is_done_ ? ended_ : std::chrono::steady_clock::now()) - started_)
      .count();
}

std::filesystem::path ToolJob::this_program() {
  std::error_code status;
  return std::filesystem::read_symlink("/proc/self/exe", status);
}

}  // namespace fascia::app
