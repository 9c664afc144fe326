#pragma once

#include <fcntl.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <string>
#include <vector>

#include "tests/paths/paths.h"

namespace fascia::testing {

/// Starts the tool; its output is nobody's.
inline pid_t start(const std::vector<std::string>& words) {
  const pid_t child = fork();
  if (child != 0) return child;
  const int nowhere = open("/dev/null", O_RDWR);
  for (const int file : {0, 1, 2})
    dup2(nowhere, file);
  const std::string tool = test::tool().string();
  std::vector<char*> arguments = {const_cast<char*>(tool.c_str())};
  for (const std::string& word : words)
    arguments.push_back(const_cast<char*>(word.c_str()));
  arguments.push_back(nullptr);
  execv(tool.c_str(), arguments.data());
  _exit(127);
}

/// What became of a process, as waitpid says it.
inline int wait_for(pid_t child) {
  int status = 0;
  waitpid(child, &status, 0);
  return status;
}

}  // namespace fascia::testing
