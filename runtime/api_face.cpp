#include <Eigen/LU>

#include "runtime/api.h"
#include "runtime/crowd.h"
#include "runtime/fnv.h"

using namespace fascia::runtime;

namespace {

/// Before the bytes of a saved state.
struct StateHeader {
  uint32_t magic = 0x54535346U;  // "FSST"
  uint32_t version = 2;
  uint64_t kind = 0;      ///< Face::state_kind
  uint64_t size = 0;      ///< bytes after the header
  uint64_t checksum = 0;  ///< of them: hash_of
};

/// A force in newtons, no stronger than any that a face bears: solving for absurd ones takes seconds.
fascia::sim::Vec3 bounded_force(const fascia::sim::Vec3& force) {
  constexpr double strongest = 1000.0;
  const double size = force.norm();
  return size > strongest ? fascia::sim::Vec3(force * (strongest / size)) : force;
}

bool is_rigid(const Eigen::Matrix4f& place) {
  constexpr float tolerance = 1e-3F, farthest = 1e6F;  // metres
  const Eigen::Matrix3f turn = place.topLeftCorner<3, 3>();
  return (turn * turn.transpose() - Eigen::Matrix3f::Identity()).cwiseAbs().maxCoeff() < tolerance &&
         turn.determinant() > 0.0F && place.topRightCorner<3, 1>().cwiseAbs().maxCoeff() <= farthest &&
         (place.row(3) - Eigen::RowVector4f(0, 0, 0, 1)).cwiseAbs().maxCoeff() < tolerance;
}

}  // namespace

extern "C" {

fascia_face_options fascia_default_face_options(void) {
  return {sizeof(fascia_face_options), FASCIA_SPACE_MESH, FASCIA_SOLVER_OWN, -1, 0};
}

fascia_result fascia_face_create(fascia_asset* asset, const fascia_face_options* options,
                                 fascia_face** face) {
  return guarded([&] {
    require(asset != nullptr && face != nullptr, "fascia_face_create: asset or face is null");
    auto made = std::make_unique<Face>(asset->asset, taken(options, fascia_default_face_options()));
    hand_over(std::unique_ptr<fascia_face>(new fascia_face{std::move(made)}), face);
    return FASCIA_OK;
  });
}

void fascia_face_release(fascia_face* face) {
  released(face);
}

fascia_result fascia_face_pose(fascia_face* handle) {
  return guarded([&] {
    checked(handle).pose();
    return FASCIA_OK;
  });
}

fascia_result fascia_face_step(fascia_face* handle, float seconds) {
  return guarded([&] {
    Face& face = checked(handle);
    require(seconds >= 0.0F && seconds <= 1.0F, "seconds must lie between 0 and 1");
    if (face.step(static_cast<double>(seconds))) return FASCIA_OK;
    return fascia::runtime::report(FASCIA_ERROR_DIVERGED,
                                   "the simulation became unsound and was put back to where the bones stand");
  });
}

fascia_result fascia_faces_step(fascia_face* const* faces, uint32_t count, float seconds,
                                const fascia_tasks* tasks) {
  return guarded([&] {
    require(faces != nullptr || count == 0, "the list of faces is null");
    require(seconds >= 0.0F && seconds <= 1.0F, "seconds must lie between 0 and 1");
    fascia_tasks given{};
    if (tasks != nullptr) {
      require(tasks->struct_size >= sizeof(uint32_t),
              "struct_size is not set: it must be sizeof the structure");
      std::memcpy(&given, tasks, std::min<std::size_t>(tasks->struct_size, sizeof given));
      require(given.begin != nullptr && given.finish != nullptr, "the host's tasks lack begin or finish");
    }
    const std::span<fascia_face* const> list(faces, count);
    for (const fascia_face* face : list)
      checked(face);
    require(fascia::runtime::are_different(list), "a face is listed twice");
    const std::size_t diverged =
        fascia::runtime::step_all(list, static_cast<double>(seconds), tasks != nullptr ? &given : nullptr);
    if (diverged == 0) return FASCIA_OK;
    const std::string message = std::to_string(diverged) + " of " + std::to_string(count) +
                                " faces became unsound and were put back to where their bones stand";
    return fascia::runtime::report(FASCIA_ERROR_DIVERGED, message.c_str());
  });
}

fascia_result fascia_face_reset(fascia_face* handle) {
  return guarded([&] {
    checked(handle).reset();
    return FASCIA_OK;
  });
}

fascia_result fascia_face_set_acceleration(fascia_face* handle, const float* acceleration) {
  return guarded([&] {
    Face& face = checked(handle);
    fascia::sim::Vec3 value = fascia::sim::Vec3::Zero();
    for (int i = 0; acceleration != nullptr && i < 3; ++i)
      value[i] = static_cast<double>(acceleration[i]);
    require(value.allFinite(), "the acceleration is not finite");
    face.set_acceleration(value);
    return FASCIA_OK;
  });
}

fascia_result fascia_face_move_head(fascia_face* face, const float matrix[16], float inertia_scale) {
  return guarded([&] {
    require(matrix != nullptr, "the matrix is null");
    const Eigen::Matrix4f place = Eigen::Map<const Eigen::Matrix4f>(matrix);
    require(place.allFinite() && std::isfinite(inertia_scale),
            "the matrix or the scale is not a finite number");
    require(is_rigid(place), "the matrix is not a rotation with a translation of at most 1000 kilometres");
    checked(face).move_head(place, inertia_scale);
    return FASCIA_OK;
  });
}

fascia_result fascia_face_touch(fascia_face* handle, uint32_t mesh, uint32_t vertex, const float force[3]) {
  return guarded([&] {
    require(force != nullptr && std::isfinite(force[0]) && std::isfinite(force[1]) && std::isfinite(force[2]),
            "the force is null or not a finite number");
    require(vertex < with_mesh(handle, mesh).vertex_count(mesh), "the mesh has no such vertex");
    require(checked(handle).touch(mesh, vertex, bounded_force({force[0], force[1], force[2]})),
            "there are too many touches already: remove them with fascia_face_clear_touches");
    return FASCIA_OK;
  });
}

fascia_result fascia_face_clear_touches(fascia_face* face) {
  return guarded([&] {
    checked(face).clear_touches();
    return FASCIA_OK;
  });
}

fascia_result fascia_face_set_level(fascia_face* face, int32_t level, float seconds) {
  return guarded([&] {
    require(std::isfinite(seconds) && seconds >= 0.0F, "seconds must be 0 or more");
    checked(face).set_level(level, seconds);
    return FASCIA_OK;
  });
}

int32_t fascia_face_level(const fascia_face* face) {
  return face == nullptr ? -1 : static_cast<int32_t>(face->face->level());
}

fascia_result fascia_face_save(fascia_face* handle, void* to, size_t capacity, size_t* size) {
  return guarded([&] {
    Face& face = checked(handle);
    require(size != nullptr, "the size to write is null");
    fascia::sim::StateBytes counted;
    if (!face.exchange_state(counted))
      throw Failure(FASCIA_ERROR_MODULE, "the face's solver cannot save its state");
    *size = sizeof(StateHeader) + counted.used();
    if (to == nullptr) return FASCIA_OK;
    require(capacity >= *size, "the memory is too small for the state");
    auto* const body = static_cast<uint8_t*>(to) + sizeof(StateHeader);
    auto written = fascia::sim::StateBytes::to({body, counted.used()});
    face.exchange_state(written);
    StateHeader header;
    header.kind = face.state_kind();
    header.size = counted.used();
    header.checksum = hash_of(body, counted.used());
    std::memcpy(to, &header, sizeof header);
    return FASCIA_OK;
  });
}

fascia_result fascia_face_restore(fascia_face* handle, const void* bytes, size_t size) {
  return guarded([&] {
    Face& face = checked(handle);
    require(bytes != nullptr, "the bytes are null");
    StateHeader header;
    const auto* const body = static_cast<const uint8_t*>(bytes) + sizeof header;
    if (size >= sizeof header) std::memcpy(&header, bytes, sizeof header);
    if (size < sizeof header || header.magic != StateHeader{}.magic || header.size != size - sizeof header ||
        header.checksum != hash_of(body, size - sizeof header))
      throw Failure(FASCIA_ERROR_FORMAT, "the bytes are not a saved state, or damaged");
    fascia::sim::StateBytes counted;
    if (!face.exchange_state(counted))
      throw Failure(FASCIA_ERROR_MODULE, "the face's solver cannot restore a state");
    // Touches are counted in the state, so its size may differ; layers are looked at as it is read.
    if (header.version != StateHeader{}.version || header.kind != face.state_kind() ||
        !face.has_layers_of(body, header.size))
      throw Failure(FASCIA_ERROR_MISMATCH,
                    "the state is that of a face of another rig, solver, level or set of layers");
    auto read = fascia::sim::StateBytes::from({body, size - sizeof header});
    if (face.exchange_state(read) && read.used() == header.size) return FASCIA_OK;
    face.reset();
    throw Failure(FASCIA_ERROR_FORMAT, "the state's numbers make no sense; the face was put back to rest");
  });
}

}  // extern "C"
