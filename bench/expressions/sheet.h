#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "bench/expressions/score.h"
#include "view/image.h"

namespace fascia::bench {

/// A picture of many shapes: each as known, as simulated, and simulated in the colours of its error.
class Sheet {
 public:
  Sheet();
  ~Sheet();
  void add(const std::string& caption, const std::vector<Vec3>& rest, const std::vector<Triangle>& triangles,
           const Eigen::VectorXd& simulated, const Eigen::VectorXd& truth, const Score& score);
  void write(const std::filesystem::path& path) const;

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace fascia::bench
