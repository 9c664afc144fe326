#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "cli/take/performance.h"

namespace fascia::cli {

/// How one node of a file moves with the head.
struct NodeMotion {
  size_t node = 0;
  std::vector<size_t> keys;         ///< frames
  std::vector<float> rotations;     ///< four a key: x y z w
  std::vector<float> translations;  ///< three a key; empty where the node turns about itself
};

/// The take's turn of the head as motion of the file's own nodes: of the joint called head, where the rig's
/// meshes are skinned to one; else of the scene's root nodes over the meshes, which turn about `pivot`. Nodes
/// given by a matrix are written as translation, rotation and scale, which animation needs. `to_rig` turns
/// the file's axes into the rig's; `pivot` is in the file's axes and units, node transforms applied.
std::vector<NodeMotion> head_motion(nlohmann::ordered_json& gltf, const Take& take,
                                    const std::vector<uint32_t>& meshes, const Eigen::Matrix3d& to_rig,
                                    const Eigen::Vector3d& pivot);

}  // namespace fascia::cli
