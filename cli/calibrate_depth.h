#pragma once

#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "rig/read/read.h"

namespace fascia::cli {

/// A rig's head built again with its soft tissue deeper or thinner over the bone, landmarks where they are.
class RebuiltRig {
 public:
  /// `bytes` is the rig's file, `file` the same read; both must outlive this.
  RebuiltRig(const std::vector<uint8_t>& bytes, const rig::RigFile& file);

  /// The rig with its depths times `depth`, with levels of detail up to `detail`, carrying the old one's
  /// tables; kept for the next time. Null where another build does not give the same muscles, channels and
  /// meshes: rigs of edited anatomy, and of heads changed since.
  const rig::Rig* at(double depth, const std::string& detail);

  /// Why a rig could not be built, empty while none has failed.
  const std::string& fault() const { return fault_; }

 private:
  rig::Rig build(double depth, const std::string& detail) const;
  std::string difference(const rig::Rig& other) const;

  const std::vector<uint8_t>& bytes_;
  const rig::RigFile& file_;
  std::map<std::pair<double, std::string>, std::unique_ptr<rig::Rig>> rigs_;
  std::string fault_;
};

}  // namespace fascia::cli
