#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "fit/fit.h"
#include "formats/scene.h"

namespace fascia::cli {

/// Where the vertices of one of the rig's primitives stand among a target's points.
struct Match {
  size_t primitive = 0;
  size_t mesh = 0;              ///< of the scene
  std::vector<uint32_t> point;  ///< by vertex of the primitive, into the mesh or the cache
};

/// The numbers from `first` on, `count` of them.
std::vector<uint32_t> counted(size_t first, size_t count);

/// Throws fascia::Error: `path` `holds` what is not the rig's topology.
[[noreturn]] void fail_topology(const std::filesystem::path& path, const fit::Subject& subject,
                                const std::string& holds);

/// Finds each of the rig's primitives in a scene: by its place in the file, by its name, or in one mesh of
/// all. Throws fascia::Error when none is there.
std::vector<Match> matches(const formats::Scene& scene, const fit::Subject& subject);

/// From a scene's axes and units to the rig's metres. A glTF that was written for a head of another format
/// stands in the rig's own, by the node that was made for it.
Mat4 scene_to_metres(const fit::Subject& subject, const formats::Scene& scene);

/// True when the meshes of `scene` have the topology of the rig's, by their numbers of vertices.
bool has_rig_topology(const fit::Subject& subject, const formats::Scene& scene);

/// Builds targets from points in the rig's input space or a scene's.
class TargetMaker {
 public:
  /// `subject` must outlive the maker.
  TargetMaker(const fit::Subject& subject, bool takes_out_head);

  /// A target that knows of no vertex.
  fit::Target none() const {
    return {Eigen::VectorXd::Zero(subject_.rest().size()), std::vector<double>(subject_.vertex_count(), 0.0)};
  }

  /// A vertex that should stand at `place`, in the input's axes and units.
  void put(fit::Target& target, size_t vertex, const Vec3& place) const {
    put_metres(target, vertex, transform_point(to_metres_, place - offset_));
  }

  Mat4 to_metres(const formats::Scene& scene) const { return scene_to_metres(subject_, scene); }

  /// The target with the head's own motion taken out where asked for. Throws fascia::Error when it is another
  /// place or size than the rig's head.
  fit::Target finished(fit::Target target) const;

  const fit::Subject& subject() const { return subject_; }

  /// Takes the motion out of those vertices that nothing in the face moves (Kabsch 1976).
  fit::Target without_head(fit::Target target) const;

  /// The scene's own points, as they stand.
  fit::Target of_scene(const formats::Scene& scene) const;

 private:
  void put_metres(fit::Target& target, size_t vertex, const Vec3& place) const;

  const fit::Subject& subject_;
  bool takes_out_head_;
  Vec3 offset_;  ///< of the rig's input, in its units
  Mat4 to_metres_;
};

}  // namespace fascia::cli
