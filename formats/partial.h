#pragma once

#include <filesystem>

namespace fascia::formats {

/// Files that are being written beside their place, so that a program which is interrupted can take them
/// away. Of more than 64 at a time, or paths of more than 4,095 bytes, the rest are not remembered.
void remember_partial(const std::filesystem::path& path);
void forget_partial(const std::filesystem::path& path);

/// Deletes what is remembered. May be called in a signal handler.
void remove_partial_files();

}  // namespace fascia::formats
