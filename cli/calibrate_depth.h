#pragma once

#include <array>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <tuple>
#include <vector>

#include "fit/physique.h"
#include "rig/read/read.h"

namespace fascia::cli {

/// A rig's head built again with its soft tissue deeper or thinner over the bone and its muscles broader or
/// narrower, landmarks where they are.
class RebuiltRig {
 public:
  /// `bytes` is the rig's file, `file` the same read; both must outlive this.
  RebuiltRig(const std::vector<uint8_t>& bytes, const rig::RigFile& file);

  /// The rig with the depth and breadths of `physique`, with levels of detail up to `detail`, carrying the
  /// old one's tables; kept for the next time. Null where another build does not give the same muscles,
  /// channels and meshes: rigs of edited anatomy, and of heads changed since.
  const rig::Rig* at(const fit::Physique& physique, const std::string& detail);

  /// Why the last rig that could not be built could not, empty while none has failed.
  const std::string& fault() const { return fault_; }

 private:
  rig::Rig build(const fit::Physique& physique, const std::string& detail) const;
  std::string difference(const rig::Rig& other) const;

  const std::vector<uint8_t>& bytes_;
  const rig::RigFile& file_;
  std::map<std::tuple<double, std::array<double, 3>, std::string>, std::unique_ptr<rig::Rig>> rigs_;
  std::string fault_;
};

}  // namespace fascia::cli
