#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace fascia::bench {

/// One array of a NumPy archive, as its bytes lie in the file.
struct NumpyArray {
  std::string type;           ///< NumPy's name of it: "<f4", "<i2", "<i4"
  std::vector<size_t> shape;  ///< rows first
  std::vector<uint8_t> bytes;

  /// Its numbers as doubles. Throws fascia::Error for a type other than the three above.
  std::vector<double> numbers() const;
};

/// Array `name` of the archive `path` (.npz: a ZIP file of .npy members, stored or deflated). Throws
/// fascia::Error naming file and array when it is not there or cannot be read.
NumpyArray read_npz(const std::filesystem::path& path, const std::string& name);

}  // namespace fascia::bench
