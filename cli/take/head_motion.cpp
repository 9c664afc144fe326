#include "cli/take/head_motion.h"

#include <algorithm>
#include <cctype>
#include <optional>

#include "cli/take/keyframes.h"
#include "geometry/text.h"

namespace fascia::cli {

namespace {

using Json = nlohmann::ordered_json;
using Eigen::Quaterniond;
using Eigen::Vector3d;

Quaterniond rotation_of(const Json& node) {
  if (!node.contains("rotation")) return Quaterniond::Identity();
  const std::vector<double> q = node["rotation"].get<std::vector<double>>();
  return Quaterniond(q.at(3), q.at(0), q.at(1), q.at(2)).normalized();
}

Vector3d translation_of(const Json& node) {
  if (!node.contains("translation")) return Vector3d::Zero();
  const std::vector<double> t = node["translation"].get<std::vector<double>>();
  return {t.at(0), t.at(1), t.at(2)};
}

/// A node without shear says the same by translation, rotation and scale.
void without_matrix(Json& node) {
  if (!node.contains("matrix")) return;
  const std::vector<double> numbers = node["matrix"].get<std::vector<double>>();
  if (numbers.size() != 16) return;
  const Eigen::Matrix4d matrix = Eigen::Map<const Eigen::Matrix4d>(numbers.data());
  Eigen::Matrix3d turn = matrix.topLeftCorner<3, 3>();
  Vector3d scale = turn.colwise().norm();
  if (turn.determinant() < 0) scale[0] = -scale[0];
  for (int axis = 0; axis < 3; ++axis)
    if (scale[axis] != 0.0) turn.col(axis) /= scale[axis];
  const Quaterniond q(turn);
  node.erase("matrix");
  node["translation"] = {matrix(0, 3), matrix(1, 3), matrix(2, 3)};
  node["rotation"] = {q.x(), q.y(), q.z(), q.w()};
  node["scale"] = {scale[0], scale[1], scale[2]};
}

std::vector<std::optional<size_t>> parents(const Json& gltf) {
  std::vector<std::optional<size_t>> list(gltf["nodes"].size());
  for (size_t n = 0; n < gltf["nodes"].size(); ++n)
    if (gltf["nodes"][n].contains("children"))
      for (const Json& child : gltf["nodes"][n]["children"])
        if (child.get<size_t>() < list.size()) list[child.get<size_t>()] = n;
  return list;
}

/// The joint of the meshes' skins that is called head.
std::optional<size_t> head_joint(const Json& gltf, const std::vector<size_t>& nodes) {
  for (const size_t n : nodes) {
    if (!gltf["nodes"][n].contains("skin")) continue;
    for (const Json& joint : gltf["skins"].at(gltf["nodes"][n]["skin"].get<size_t>())["joints"]) {
      const std::string name = lower_case(gltf["nodes"].at(joint.get<size_t>()).value("name", ""));
      const size_t at = name.rfind("head");
      if (at != std::string::npos && at + 4 == name.size()) return joint.get<size_t>();
    }
  }
  return std::nullopt;
}

/// The turn of the head in the file's axes at every frame; neighbours lie on the same side.
std::vector<Quaterniond> turns(const Take& take, const Eigen::Matrix3d& to_rig) {
  const Quaterniond axes(to_rig);
  std::vector<Quaterniond> list;
  for (size_t f = 0; f < take.frames(); ++f) {
    const std::array<float, 4> q = take.curves.head(take.time(f));
    Quaterniond turn = axes.conjugate() *
                       Quaterniond(static_cast<double>(q[3]), static_cast<double>(q[0]),
                                   static_cast<double>(q[1]), static_cast<double>(q[2])) *
                       axes;
    if (!list.empty() && list.back().dot(turn) < 0.0) turn.coeffs() *= -1.0;
    list.push_back(turn);
  }
  return list;
}

NodeMotion motion_of(size_t node, const std::vector<Quaterniond>& rotations,
                     const std::vector<Vector3d>& translations) {
  const auto frames = static_cast<Eigen::Index>(rotations.size());
  Eigen::MatrixXf values(translations.empty() ? 4 : 7, frames);
  for (Eigen::Index f = 0; f < frames; ++f) {
    values.col(f).head<4>() = rotations[static_cast<size_t>(f)].coeffs().cast<float>();
    if (!translations.empty()) values.col(f).tail<3>() = translations[static_cast<size_t>(f)].cast<float>();
  }
  std::vector<float> tolerances(4, 1e-4F);
  if (!translations.empty()) {
    const Eigen::VectorXf span =
        values.bottomRows<3>().rowwise().maxCoeff() - values.bottomRows<3>().rowwise().minCoeff();
    tolerances.resize(7, 1e-3F * span.maxCoeff() + 1e-9F);
  }
  NodeMotion motion;
  motion.node = node;
  motion.keys = keys_of(values, tolerances);
  for (const size_t key : motion.keys) {
    const auto column = values.col(static_cast<Eigen::Index>(key));
    const Eigen::Vector4f turn = column.head<4>().normalized();
    motion.rotations.insert(motion.rotations.end(), turn.data(), turn.data() + 4);
    if (!translations.empty())
      motion.translations.insert(motion.translations.end(), {column[4], column[5], column[6]});
  }
  return motion;
}

/// The joint turns about itself, in its parent's frame.
NodeMotion joint_motion(const Json& gltf, size_t joint, const std::vector<Quaterniond>& head) {
  const auto above = parents(gltf);
  Quaterniond parent = Quaterniond::Identity();
  for (std::optional<size_t> node = above[joint]; node; node = above[*node])
    parent = rotation_of(gltf["nodes"][*node]) * parent;
  const Quaterniond rest = rotation_of(gltf["nodes"][joint]);
  std::vector<Quaterniond> rotations;
  for (const Quaterniond& turn : head)
    rotations.push_back((parent.conjugate() * turn * parent) * rest);
  return motion_of(joint, rotations, {});
}

}  // namespace

std::vector<NodeMotion> head_motion(Json& gltf, const Take& take, const std::vector<uint32_t>& meshes,
                                    const Eigen::Matrix3d& to_rig, const Vector3d& pivot) {
  std::vector<size_t> nodes;
  for (size_t n = 0; n < gltf["nodes"].size(); ++n) {
    const Json& node = gltf["nodes"][n];
    if (node.contains("mesh") &&
        std::find(meshes.begin(), meshes.end(), node["mesh"].get<uint32_t>()) != meshes.end())
      nodes.push_back(n);
  }
  const std::vector<Quaterniond> head = turns(take, to_rig);
  if (const auto joint = head_joint(gltf, nodes)) {
    const auto above = parents(gltf);
    for (std::optional<size_t> node = joint; node; node = above[*node])
      without_matrix(gltf["nodes"][*node]);
    return {joint_motion(gltf, *joint, head)};
  }
  const auto above = parents(gltf);
  std::vector<size_t> roots;
  for (size_t n : nodes) {
    while (above[n])
      n = *above[n];
    if (std::find(roots.begin(), roots.end(), n) == roots.end()) roots.push_back(n);
  }
  std::vector<NodeMotion> motions;
  for (const size_t root : roots) {
    without_matrix(gltf["nodes"][root]);
    const Quaterniond rest = rotation_of(gltf["nodes"][root]);
    const Vector3d place = translation_of(gltf["nodes"][root]);
    std::vector<Quaterniond> rotations;
    std::vector<Vector3d> translations;
    for (const Quaterniond& turn : head) {
      rotations.push_back(turn * rest);
      translations.push_back(pivot + turn * (place - pivot));
    }
    motions.push_back(motion_of(root, rotations, translations));
  }
  return motions;
}

}  // namespace fascia::cli
