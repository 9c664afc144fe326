#pragma once

#include <unistd.h>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <string>

namespace fascia::fuzz {

/// A file in memory that holds the input, for readers that take a path.
inline std::filesystem::path scratch_file(const uint8_t* bytes, size_t size, const std::string& extension) {
  static const std::filesystem::path folder = [] {
    std::filesystem::path made =
        std::filesystem::exists("/dev/shm") ? "/dev/shm" : std::filesystem::temp_directory_path();
    made /= "fascia_fuzz_" + std::to_string(getpid());
    std::filesystem::create_directories(made);
    return made;
  }();
  const std::filesystem::path path = folder / ("input" + extension);
  if (std::FILE* file = std::fopen(path.c_str(), "wb")) {
    std::fwrite(bytes, 1, size, file);
    std::fclose(file);
  }
  return path;
}

}  // namespace fascia::fuzz
