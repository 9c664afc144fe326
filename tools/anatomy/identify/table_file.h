#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>

namespace fascia::identify {

using Json = nlohmann::ordered_json;

/// A table of expressions as it stands in anatomy/data/expressions. Throws fascia::Error when it cannot be
/// read.
Json read_table(const std::filesystem::path& path);
/// Writes it with one expression a line.
void write_table(const std::filesystem::path& path, const Json& table);

}  // namespace fascia::identify
