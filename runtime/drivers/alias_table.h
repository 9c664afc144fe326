#pragma once

#include <string_view>

namespace fascia::runtime {

/// The text of anatomy/data/aliases.json, compiled in.
extern const std::string_view alias_table;

}  // namespace fascia::runtime
