#pragma once

#include <filesystem>

#include "anatomy/anatomy.h"

namespace fascia::cli {

/// The generic head of `anatomy` as OBJ in millimetres, as a user would bring one, and its landmarks beside
/// it.
void write_embedded_head(const anatomy::GenericAnatomy& anatomy, const std::filesystem::path& head,
                         const std::filesystem::path& landmarks);

/// The same of the built-in anatomy.
void write_embedded_head(const std::filesystem::path& head, const std::filesystem::path& landmarks);

/// Ten seconds of smile, frown, surprise and speech-like jaw as CSV, ARKit names and actuators mixed.
void write_demo_curves(const std::filesystem::path& path);

}  // namespace fascia::cli
