#pragma once

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

namespace fascia::formats {

/// Values of channels and shapes by name, sorted, from {"activations": {NAME: VALUE, ...}}. Throws
/// fascia::Error when the file cannot be read or is not like that.
std::vector<std::pair<std::string, double>> read_activations(const std::filesystem::path& file);

}  // namespace fascia::formats
