#pragma once

#include <sys/types.h>
#include <chrono>
#include <filesystem>
#include <string>
#include <vector>

namespace fascia::app {

/// A `fascia` command that runs as a process of its own: what the window exports, it exports by the very
/// command that it shows. A fault of it leaves the window standing, and it can be ended at any time.
class ToolJob {
 public:
  /// Starts `tool` with `arguments` (without the program's name). `title` is for people. Throws fascia::Error
  /// when it cannot be started.
  ToolJob(std::filesystem::path tool, std::vector<std::string> arguments, std::string title);
  ~ToolJob();
  ToolJob(const ToolJob&) = delete;
  ToolJob& operator=(const ToolJob&) = delete;

  /// Takes in what it has said; true when it has ended. Never waits.
  bool poll();
  void cancel();

  bool is_done() const { return is_done_; }
  bool was_cancelled() const { return is_cancelled_; }
  int exit_code() const { return exit_code_; }
  double seconds() const;
  const std::string& title() const { return title_; }
  const std::vector<std::string>& arguments() const { return arguments_; }
  const std::string& output() const { return output_; }    ///< what it wrote on stdout
  const std::string& message() const { return message_; }  ///< what it wrote on stderr

  /// The program that runs now.
  static std::filesystem::path this_program();

 private:
  void drain(int& stream, std::string& text);

  std::vector<std::string> arguments_;
  std::string title_, output_, message_;
  pid_t process_ = -1;
  int streams_[2] = {-1, -1};
  bool is_done_ = false, is_cancelled_ = false;
  int exit_code_ = -1;
  std::chrono::steady_clock::time_point started_, ended_;
};

}  // namespace fascia::app
