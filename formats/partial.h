#pragma once

#include <filesystem>

namespace fascia::formats {

/// A register of temporary files, so that an interrupted program can delete them. At most 64 files at a time,
/// with paths of at most 4,095 bytes, are registered.
void remember_partial(const std::filesystem::path& path);
void forget_partial(const std::filesystem::path& path);

/// Deletes the registered files. May be called in a signal handler.
void remove_partial_files();

}  // namespace fascia::formats
