#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "cli/common.h"
#include "fit/fit.h"
#include "formats/scene.h"

namespace fascia::cli {

/// What a file asks to be fitted: one posed mesh, the morph targets of a file, or the frames of a take.
struct FitTargets {
  enum class Kind { mesh, shapes, take } kind = Kind::mesh;
  std::vector<std::string> names;                   ///< of each; for people
  std::vector<double> times;                        ///< of a take's frames, seconds
  std::function<fit::Target(size_t index)> target;  ///< read when asked for
};

struct FitTargetOptions {
  std::string as = "auto";  ///< auto, mesh, shapes or take: what to read a glTF file with morph targets as
  std::string head_pose =
      "auto";                  ///< auto: taken out when the parts that do not move have moved; fixed: never
  bool allow_outside = false;  ///< files that the target references may lie outside its folder
  double fps = 30.0;           ///< of PC2 caches and sequences of meshes, which hold no times
};

/// Opens `path`: GLB, glTF, OBJ, PLY or STL of the rig's own topology, a PC2 or MDD cache, or a folder of
/// such meshes, one a frame in the order of their names. `subject` must outlive the result.
///
/// Throws fascia::Error when the file cannot be read or its vertices are not the rig's.
FitTargets open_fit_targets(const Common& common, const std::filesystem::path& path,
                            const fit::Subject& subject, const FitTargetOptions& options);

}  // namespace fascia::cli
