#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace fascia::app {

/// One line of a script that drives the window: a verb and its words.
struct ScriptStep {
  int line = 0;  ///< in the file, for messages
  std::string verb;
  std::vector<std::string> words;
};

/// A verb with what it wants, for the manual and for checking.
struct ScriptVerb {
  const char* name;
  size_t least, most;  ///< words
  const char* usage;
};
const std::vector<ScriptVerb>& script_verbs();

/// Reads a script: a step a line, words by spaces, "quoted words" with spaces in them, # begins a comment.
/// Throws fascia::Error naming `where`, the line and what the verb wants.
std::vector<ScriptStep> parse_script(const std::string& text, const std::string& where);

}  // namespace fascia::app
