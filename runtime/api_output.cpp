#include "runtime/api.h"

using namespace fascia::runtime;

extern "C" {

fascia_result fascia_face_positions(fascia_face* face, uint32_t mesh, fascia_vectors* positions) {
  return guarded([&] {
    hand_out_vectors(with_mesh(face, mesh).positions(mesh), positions);
    return FASCIA_OK;
  });
}

fascia_result fascia_face_normals(fascia_face* face, uint32_t mesh, fascia_vectors* normals) {
  return guarded([&] {
    hand_out_vectors(with_mesh(face, mesh).normals(mesh), normals);
    return FASCIA_OK;
  });
}

fascia_result fascia_face_compression(fascia_face* face, uint32_t mesh, fascia_vectors* compression) {
  return guarded([&] {
    hand_out_vectors(with_mesh(face, mesh).compression(mesh), compression);
    return FASCIA_OK;
  });
}

fascia_result fascia_face_tangents(fascia_face* face, uint32_t mesh, fascia_vectors* tangents) {
  return guarded([&] {
    hand_out_vectors(with_mesh(face, mesh).tangents(mesh), tangents);
    return FASCIA_OK;
  });
}

fascia_result fascia_face_write_positions(fascia_face* face, uint32_t mesh, void* to, size_t stride,
                                          size_t capacity) {
  return guarded([&] {
    write_out(with_mesh(face, mesh).positions(mesh), to, stride, capacity);
    return FASCIA_OK;
  });
}

fascia_result fascia_face_write_normals(fascia_face* face, uint32_t mesh, void* to, size_t stride,
                                        size_t capacity) {
  return guarded([&] {
    write_out(with_mesh(face, mesh).normals(mesh), to, stride, capacity);
    return FASCIA_OK;
  });
}

fascia_result fascia_face_write_tangents(fascia_face* face, uint32_t mesh, void* to, size_t stride,
                                         size_t capacity) {
  return guarded([&] {
    write_out(with_mesh(face, mesh).tangents(mesh), to, stride, capacity);
    return FASCIA_OK;
  });
}

fascia_result fascia_face_fibre_points(fascia_face* face, fascia_vectors* points) {
  return guarded([&] {
    hand_out_vectors(checked(face).fibre_points(), points);
    return FASCIA_OK;
  });
}

fascia_result fascia_face_jaw(const fascia_face* face, float matrix[16]) {
  return guarded([&] {
    require(matrix != nullptr, "the matrix is null");
    const auto& jaw = checked(face).jaw();
    Eigen::Map<Eigen::Matrix4f> result(matrix);
    result.setIdentity();
    result.topLeftCorner<3, 3>() = jaw.rotation.cast<float>();
    result.topRightCorner<3, 1>() = jaw.translation.cast<float>();
    return FASCIA_OK;
  });
}

}  // extern "C"
