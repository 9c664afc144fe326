// What g++'s precompiled headers hide and clang, which has none here, does not forgive: a source that uses a
// part of Eigen includes its header, itself or by a header of the project.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <map>
#include <set>
#include <string>
#include <vector>

namespace {

namespace fs = std::filesystem;

struct Part {
  std::vector<std::string> uses;
  std::vector<std::string> headers;  ///< any of these; the first is the one to include
};

const std::vector<Part> parts = {
    {{".homogeneous()", ".hnormalized()", ".cross(", "AngleAxis", "Quaternion", "Isometry3", "Affine3",
      "AlignedBox", "umeyama"},
     {"Eigen/Geometry", "Eigen/SVD", "Eigen/Eigenvalues", "Eigen/Dense"}},
    {{".inverse()", ".determinant()", "PartialPivLU", "FullPivLU"},
     {"Eigen/LU", "Eigen/Geometry", "Eigen/QR", "Eigen/SVD", "Eigen/Eigenvalues", "Eigen/Dense"}},
};

struct Source {
  std::string code;  ///< without comments to a line's end
  std::set<std::string> eigen;
};

/// A file of the project and the headers of Eigen that it includes, itself or by others.
const Source& source_of(const fs::path& path) {
  static std::map<fs::path, Source> known;
  const auto [place, is_new] = known.try_emplace(path);
  if (!is_new) return place->second;
  Source source;
  std::ifstream file(path);
  for (std::string line; std::getline(file, line);) {
    line.resize(std::min(line.size(), line.find("//")));
    const std::string::size_type quote = line.rfind("#include \"", 0) == 0 ? 10 : std::string::npos;
    if (line.rfind("#include <Eigen/", 0) == 0) source.eigen.insert(line.substr(10, line.find('>') - 10));
    if (quote != std::string::npos) {
      const std::string name = line.substr(quote, line.rfind('"') - quote);
      for (const fs::path& folder : {fs::path(FASCIA_SOURCE), path.parent_path()})
        if (fs::exists(folder / name)) {
          const Source& other = source_of((folder / name).lexically_normal());
          source.eigen.insert(other.eigen.begin(), other.eigen.end());
          break;
        }
    }
    source.code += line + "\n";
  }
  return place->second = source;
}

bool includes_any(const Source& source, const std::vector<std::string>& headers) {
  for (const std::string& header : headers)
    if (source.eigen.count(header) > 0) return true;
  return false;
}

TEST(House, WhatIsUsedOfEigenIsIncluded) {
  int uses = 0;
  for (const char* room :
       {"geometry", "gltf", "formats", "anatomy", "rig", "sim", "builder", "fit", "runtime", "check", "batch",
        "snapshot", "view", "app", "cli", "tools", "bench", "tests"})
    for (const auto& entry : fs::recursive_directory_iterator(fs::path(FASCIA_SOURCE) / room)) {
      if (entry.path().extension() != ".cpp" && entry.path().extension() != ".h") continue;
      const Source& source = source_of(entry.path().lexically_normal());
      for (const Part& part : parts)
        for (const std::string& use : part.uses) {
          if (source.code.find(use) == std::string::npos || entry.path().filename() == "eigen_test.cpp")
            continue;
          ++uses;
          EXPECT_TRUE(includes_any(source, part.headers))
              << entry.path() << " uses " << use << ": include <" << part.headers.front() << ">";
        }
    }
  EXPECT_GT(uses, 100);
}

}  // namespace
