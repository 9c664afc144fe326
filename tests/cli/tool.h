#pragma once

#include <gtest/gtest.h>
#include <sys/wait.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

#include "tests/paths/paths.h"

namespace fascia::cli {

struct Outcome {
  int code = -1;
  std::string out, err;
};

inline std::string text_of(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

/// Runs the tool as a user would, with what it says caught in files of `folder`.
inline Outcome run_tool(const std::filesystem::path& folder, const std::string& arguments) {
  const std::string out = (folder / "stdout.txt").string(), err = (folder / "stderr.txt").string();
  const int status = std::system(
      (test::tool().string() + " " + arguments + " >" + out + " 2>" + err + " </dev/null").c_str());
  return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, text_of(out), text_of(err)};
}

}  // namespace fascia::cli
