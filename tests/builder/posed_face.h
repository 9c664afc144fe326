#pragma once

#include <filesystem>
#include <map>
#include <memory>
#include <string>

#include "builder/rigging/build_rig.h"
#include "cli/posing.h"

namespace fascia::testing {

/// A rig built in this process, and a face of it to pose; measures in millimetres in the rig's axes.
class PosedFace {
 public:
  PosedFace(const std::filesystem::path& head, const std::filesystem::path& landmarks,
            const std::string& name, const std::string& detail = "medium");
  ~PosedFace();

  using Values = std::map<std::string, double>;

  /// Poses the face statically; what is not named is at rest.
  void pose(const Values& values);

  /// How far a landmark of the skin is from its place at rest, millimetres (x to the left, y up, z forward).
  Vec3 moved(const std::string& landmark) const;

  /// Where a landmark is now, millimetres.
  Vec3 place(const std::string& landmark) const;

  /// The largest motion of any vertex of any mesh, millimetres; of the skin only on the side x < `right_of`
  /// when that is given.
  double largest_motion() const;
  double largest_skin_motion_right_of(double x_mm) const;

  const rigging::BuildReport& report() const { return report_; }
  const rig::Rig& rig() const { return rig_; }
  cli::Face& face() { return *face_; }
  const std::filesystem::path& rig_path() const { return rig_path_; }

 private:
  struct Handle {
    size_t mesh = 0, vertex = 0;  ///< nearest skin vertex to the landmark
  };
  Vec3 at(const Handle& handle, bool rest) const;

  std::filesystem::path rig_path_;
  rigging::BuildReport report_;
  rig::Rig rig_;
  std::unique_ptr<cli::Face> face_;
  std::map<std::string, Handle> handles_;
};

}  // namespace fascia::testing
