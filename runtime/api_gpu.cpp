#include "fascia/gpu.h"

#include <Eigen/Geometry>

#include "runtime/api.h"

using namespace fascia::runtime;

namespace {

/// `motion` of places in metres as one of places in the mesh's space.
Eigen::Matrix4f in_space(const MeshShape& shape, const Eigen::Matrix4d& motion) {
  const Eigen::Matrix4d to_space = shape.metres_to_space().cast<double>();
  return (to_space * motion * to_space.inverse()).cast<float>();
}

Eigen::Matrix4d eye_motion(const BonePose& bones, std::size_t eye) {
  Eigen::Matrix4d motion = Eigen::Matrix4d::Identity();
  const Eigen::Vector3d centre = bones.eye_centres[eye].cast<double>();
  motion.topLeftCorner<3, 3>() = bones.eyes[eye].cast<double>();
  motion.topRightCorner<3, 1>() = centre - bones.eyes[eye].cast<double>() * centre;
  return motion;
}

}  // namespace

extern "C" {

fascia_result fascia_face_write_deltas(fascia_face* handle, uint32_t mesh, fascia_delta_format format,
                                       void* to, size_t stride, size_t capacity, float* scale) {
  return guarded([&] {
    Face& face = with_mesh(handle, mesh);
    const auto& positions = face.positions(mesh);
    const auto& rest = face.shape(mesh).rest();
    require(format == FASCIA_DELTA_FLOAT32 || format == FASCIA_DELTA_SNORM16, "unknown format of deltas");
    require(to != nullptr && scale != nullptr && stride >= (format == FASCIA_DELTA_FLOAT32 ? 12U : 8U) &&
                stride <= widest_stride,
            "the memory or the scale is null, or the stride too small or more than a megabyte");
    require(capacity >= positions.size(), "the memory holds fewer vertices than the mesh has");
    float largest = 0.0F;
    for (std::size_t v = 0; v < positions.size(); ++v)
      largest = std::max(largest, (positions[v] - rest[v]).cwiseAbs().maxCoeff());
    *scale = largest;
    const float steps = largest > 0.0F ? 32767.0F / largest : 0.0F;
    for (std::size_t v = 0; v < positions.size(); ++v) {
      const Vec3f delta = positions[v] - rest[v];
      void* const at = static_cast<char*>(to) + v * stride;
      if (format == FASCIA_DELTA_FLOAT32) {
        std::memcpy(at, delta.data(), 12);
        continue;
      }
      int16_t numbers[4] = {};
      for (int axis = 0; axis < 3; ++axis)
        numbers[axis] =
            static_cast<int16_t>(std::lround(std::clamp(steps * delta[axis], -32767.0F, 32767.0F)));
      std::memcpy(at, numbers, 8);
    }
    return FASCIA_OK;
  });
}

fascia_result fascia_face_skinning(fascia_face* handle, uint32_t mesh, fascia_skinning* skinning) {
  return guarded([&] {
    Face& face = with_mesh(handle, mesh);
    const MeshShape& shape = face.shape(mesh);
    const MeshShape::Skinning& list = shape.skinning();
    hand_out(fascia_skinning{0, static_cast<uint32_t>(shape.rest().size()), list.influences,
                             static_cast<uint32_t>(face.model().rest().size()),
                             shape.rest().empty() ? nullptr : shape.rest().front().data(), list.nodes.data(),
                             list.weights.data(), list.jaw.data(), list.eyes.data()},
             skinning);
    return FASCIA_OK;
  });
}

fascia_result fascia_face_write_node_texture(fascia_face* handle, uint32_t mesh, float* to, size_t capacity) {
  return guarded([&] {
    const Face& face = with_mesh(handle, mesh);
    const auto displacements = face.bones().displacements;
    require(to != nullptr, "the memory is null");
    require(capacity >= displacements.size(), "the memory holds fewer texels than the level has nodes");
    const Eigen::Matrix3f& from_metres = face.shape(mesh).from_metres();
    for (std::size_t i = 0; i < displacements.size(); ++i) {
      Eigen::Map<Eigen::Vector4f> texel(to + 4 * i);
      texel << from_metres * displacements[i], 0.0F;
    }
    return FASCIA_OK;
  });
}

fascia_result fascia_face_bone_matrices(fascia_face* handle, uint32_t mesh, float matrices[48]) {
  return guarded([&] {
    const Face& face = with_mesh(handle, mesh);
    require(matrices != nullptr, "the matrices are null");
    Eigen::Matrix4d jaw = Eigen::Matrix4d::Identity();
    jaw.topLeftCorner<3, 3>() = face.jaw().rotation;
    jaw.topRightCorner<3, 1>() = face.jaw().translation;
    const MeshShape& shape = face.shape(mesh);
    Eigen::Map<Eigen::Matrix4f>(matrices, 4, 4) = in_space(shape, jaw);
    for (std::size_t eye = 0; eye < 2; ++eye)
      Eigen::Map<Eigen::Matrix4f>(matrices + 16 * (eye + 1), 4, 4) =
          in_space(shape, eye_motion(face.bones(), eye));
    return FASCIA_OK;
  });
}

}  // extern "C"
