#pragma once

#include <filesystem>

namespace fascia::cli {

/// Ten seconds of smile, frown, surprise and speech-like jaw as CSV, ARKit names and actuators mixed.
void write_demo_curves(const std::filesystem::path& path);

}  // namespace fascia::cli
