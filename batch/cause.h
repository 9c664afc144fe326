#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "batch/process.h"

namespace fascia::batch {

/// Exit codes of a step: the tool has a fault, or was not started at all.
inline constexpr int exit_of_a_fault = 3, exit_not_started = 127;

/// What the tool wrote with --json; no object when it wrote something else.
nlohmann::json json_of(const std::string& text);

/// The tool's own words: its JSON object's error, else the last line it wrote.
std::string words_of(const Outcome& outcome);

/// A message without what differs from head to head: names in quotes, numbers, and what follows a semicolon.
std::string common_part(const std::string& message);

/// Why a step failed, in words that many heads share; empty when it did not.
std::string cause_of(const Outcome& outcome);

/// True for a failure that says nothing of the head: a full or broken disk, a tool that cannot be started.
bool is_of_the_machine(const Outcome& outcome);

}  // namespace fascia::batch
