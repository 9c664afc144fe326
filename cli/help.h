#pragma once

#include <string>

#include "cli/options.h"

namespace fascia::cli {

/// How an option is written: "-o, --output FILE", "--view front|side", "RIG".
std::string usage_of(const OptionFacts& option);

/// What it does, with its default or that it is required.
std::string meaning_of(const OptionFacts& option);

/// The page `fascia --help` prints: commands and the options all of them take.
std::string tool_help(const Command& tool);

/// The page `fascia COMMAND --help` prints.
std::string command_help(const Command& tool, const Command& command);

}  // namespace fascia::cli
