#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <mutex>

#include "runtime/crowd.h"
#include "runtime/drivers/aliases.h"
#include "runtime/drivers/curves.h"
#include "runtime/face.h"

using fascia::runtime::Asset;
using fascia::runtime::Curve;
using fascia::runtime::Curves;
using fascia::runtime::Driven;
using fascia::runtime::Face;
using fascia::runtime::Failure;
using fascia::runtime::guarded;
using fascia::runtime::hand_out;
using fascia::runtime::require;
using fascia::runtime::Target;

/// Behind the C handle.
struct fascia_curves {
  Curves curves;
  std::vector<const char*> names, notes;
  std::array<const Curve*, 3> head = {};  ///< yaw, pitch, roll
  std::array<float, 3> head_share = {};

  /// What each curve drives in an asset; found once.
  const std::vector<std::vector<Driven>>& driven(const Asset& asset) const {
    const std::lock_guard lock(mutex_);
    auto& found = driven_[asset.serial()];
    if (!found) {
      found = std::make_unique<std::vector<std::vector<Driven>>>();
      for (const Curve& curve : curves.curves)
        found->push_back(asset.resolve(curve.name));
    }
    return *found;
  }

 private:
  mutable std::mutex mutex_;
  mutable std::map<uint64_t, std::unique_ptr<std::vector<std::vector<Driven>>>> driven_;
};

namespace {

Face& checked(const fascia_face* face) {
  require(face != nullptr, "the face is null");
  return *face->face;
}

std::vector<Driven> named(const Face& face, const char* name) {
  require(name != nullptr, "the name is null");
  std::vector<Driven> driven = face.asset().resolve(name);
  if (driven.empty())
    throw Failure(FASCIA_ERROR_NAME, "the rig has no channel or member \"" + std::string(name) +
                                         "\"; fascia_asset_get_channels and fascia_asset_get_set list them");
  return driven;
}

/// Curves that turn the head, by the table of other programs' names.
void find_head(fascia_curves& curves) {
  for (const Curve& curve : curves.curves.curves) {
    const auto* alias = fascia::runtime::find_alias(curve.name);
    if (alias == nullptr || alias->measure != fascia::runtime::Measure::head) continue;
    for (const auto& [axis, share] : alias->targets) {
      const std::size_t place = axis == "yaw" ? 0 : axis == "pitch" ? 1 : 2;
      curves.head[place] = &curve;
      curves.head_share[place] = share;
    }
  }
}

/// Copies as much of the caller's structure as it has.
template <class Struct>
Struct taken(const Struct* given, Struct chosen) {
  if (given == nullptr) return chosen;
  require(given->struct_size >= 2 * sizeof(uint32_t),
          "struct_size is not set: it must be sizeof the structure");
  std::memcpy(&chosen, given, std::min<std::size_t>(given->struct_size, sizeof chosen));
  return chosen;
}

/// The face, which has a mesh of that number.
Face& with_mesh(const fascia_face* handle, uint32_t mesh) {
  Face& face = checked(handle);
  if (mesh >= face.mesh_count())
    throw Failure(FASCIA_ERROR_ARGUMENT, "there is no mesh " + std::to_string(mesh) + ": the rig moves " +
                                             std::to_string(face.mesh_count()));
  return face;
}

void hand_out_vectors(const std::vector<fascia::rig::Vec3f>& vectors, fascia_vectors* to) {
  hand_out(fascia_vectors{0, static_cast<uint32_t>(vectors.size()), 12, 0,
                          vectors.empty() ? nullptr : vectors.front().data()},
           to);
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
    *face = new fascia_face{std::move(made)};
    return FASCIA_OK;
  });
}

void fascia_face_release(fascia_face* face) {
  delete face;
}

float* fascia_face_values(fascia_face* face) {
  return face == nullptr ? nullptr : face->face->values().data();
}

const float* fascia_face_effective_values(const fascia_face* face) {
  return face == nullptr ? nullptr : face->face->effective_values().data();
}

fascia_result fascia_face_set(fascia_face* handle, const char* name, float value) {
  return guarded([&] {
    Face& face = checked(handle);
    require(std::isfinite(value), "the value is not a finite number");
    for (const Driven& driven : named(face, name))
      face.set(driven.target, driven.share * value);
    return FASCIA_OK;
  });
}

fascia_result fascia_face_get(const fascia_face* handle, const char* name, float* value) {
  return guarded([&] {
    const Face& face = checked(handle);
    require(value != nullptr, "the value to write is null");
    const Driven driven = named(face, name).front();
    *value = face.get(driven.target) / driven.share;
    return FASCIA_OK;
  });
}

fascia_result fascia_face_clear(fascia_face* handle) {
  return guarded([&] {
    checked(handle).clear();
    return FASCIA_OK;
  });
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
    std::vector<Face*> list;
    for (uint32_t i = 0; i < count; ++i)
      list.push_back(&checked(faces[i]));
    std::vector<Face*> sorted = list;
    std::sort(sorted.begin(), sorted.end());
    require(std::adjacent_find(sorted.begin(), sorted.end()) == sorted.end(), "a face is listed twice");
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

fascia_result fascia_face_move_head(fascia_face* face, const float matrix[16], float inertia_scale) {
  return guarded([&] {
    require(matrix != nullptr, "the matrix is null");
    const Eigen::Matrix4f place = Eigen::Map<const Eigen::Matrix4f>(matrix);
    require(place.allFinite() && std::isfinite(inertia_scale),
            "the matrix or the scale is not a finite number");
    checked(face).move_head(place, inertia_scale);
    return FASCIA_OK;
  });
}

fascia_result fascia_face_touch(fascia_face* handle, uint32_t mesh, uint32_t vertex, const float force[3]) {
  return guarded([&] {
    require(force != nullptr && std::isfinite(force[0]) && std::isfinite(force[1]) && std::isfinite(force[2]),
            "the force is null or not a finite number");
    require(vertex < with_mesh(handle, mesh).vertex_count(mesh), "the mesh has no such vertex");
    require(checked(handle).touch(mesh, vertex, {force[0], force[1], force[2]}),
            "there are 64 touches already");
    return FASCIA_OK;
  });
}

fascia_result fascia_face_clear_touches(fascia_face* face) {
  return guarded([&] {
    checked(face).clear_touches();
    return FASCIA_OK;
  });
}

fascia_result fascia_face_write_positions(fascia_face* face, uint32_t mesh, void* to, size_t stride,
                                          size_t capacity) {
  return guarded([&] {
    const auto& positions = with_mesh(face, mesh).positions(mesh);
    require(to != nullptr && stride >= 12, "the memory is null or the stride below 12 bytes");
    require(capacity >= positions.size(), "the memory holds fewer vertices than the mesh has");
    for (std::size_t v = 0; v < positions.size(); ++v)
      std::memcpy(static_cast<char*>(to) + v * stride, positions[v].data(), 12);
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

fascia_result fascia_curves_load(const void* bytes, size_t size, fascia_curves** curves) {
  return fascia_curves_load_as(bytes, size, nullptr, curves);
}

fascia_result fascia_curves_load_as(const void* bytes, size_t size, const fascia_curves_options* options,
                                    fascia_curves** curves) {
  return guarded([&] {
    require(bytes != nullptr && curves != nullptr, "fascia_curves_load: bytes or curves is null");
    const fascia_curves_options chosen = taken(options, {sizeof(fascia_curves_options), 0, 0.0, 0.0});
    require(chosen.frames_per_second >= 0.0 && chosen.time_unit >= 0.0 &&
                std::isfinite(chosen.frames_per_second) && std::isfinite(chosen.time_unit),
            "frames_per_second and time_unit must be 0 or more");
    auto loaded = std::make_unique<fascia_curves>();
    loaded->curves = fascia::runtime::read_curves({static_cast<const uint8_t*>(bytes), size},
                                                  {chosen.frames_per_second, chosen.time_unit});
    for (const auto& curve : loaded->curves.curves)
      loaded->names.push_back(curve.name.c_str());
    for (const std::string& note : loaded->curves.notes)
      loaded->notes.push_back(note.c_str());
    find_head(*loaded);
    *curves = loaded.release();
    return FASCIA_OK;
  });
}

void fascia_curves_release(fascia_curves* curves) {
  delete curves;
}

fascia_result fascia_curves_get_info(const fascia_curves* curves, fascia_curves_info* info) {
  return guarded([&] {
    require(curves != nullptr, "the curves are null");
    hand_out(fascia_curves_info{0, static_cast<uint32_t>(curves->names.size()), curves->names.data(),
                                curves->curves.duration(), curves->curves.start,
                                curves->curves.frames_per_second, static_cast<uint32_t>(curves->notes.size()),
                                static_cast<uint32_t>(curves->head[0] || curves->head[1] || curves->head[2]),
                                curves->notes.data()},
             info);
    return FASCIA_OK;
  });
}

fascia_result fascia_curves_match(const fascia_curves* curves, const fascia_asset* asset, uint32_t* count,
                                  uint8_t* matched) {
  return guarded([&] {
    require(curves != nullptr && asset != nullptr && count != nullptr, "the curves, asset or count is null");
    uint32_t known = 0;
    const auto& driven = curves->driven(*asset->asset);
    for (std::size_t i = 0; i < curves->names.size(); ++i) {
      const bool found = !driven[i].empty();
      known += found;
      if (matched != nullptr) matched[i] = found;
    }
    *count = known;
    return FASCIA_OK;
  });
}

fascia_result fascia_curves_apply(const fascia_curves* curves, double seconds, float weight,
                                  fascia_face* handle) {
  return guarded([&] {
    require(curves != nullptr, "the curves are null");
    require(std::isfinite(seconds) && std::isfinite(weight), "the time or weight is not a finite number");
    Face& face = checked(handle);
    const auto& driven = curves->driven(face.asset());
    for (std::size_t i = 0; i < driven.size(); ++i) {
      if (driven[i].empty()) continue;
      const float value = curves->curves.curves[i].at(seconds);
      for (const Driven& entry : driven[i])
        if (entry.overrides && entry.target.kind == Target::Kind::channel)
          face.take_over(entry.target.index, entry.share * value, weight);
        else
          face.add(entry.target, entry.share * value, weight);
    }
    return FASCIA_OK;
  });
}

fascia_result fascia_curves_head(const fascia_curves* curves, double seconds, float quaternion[4]) {
  return guarded([&] {
    require(curves != nullptr && quaternion != nullptr, "the curves or the quaternion is null");
    require(std::isfinite(seconds), "the time is not a finite number");
    float angles[3] = {};
    for (std::size_t axis = 0; axis < 3; ++axis)
      if (curves->head[axis] != nullptr)
        angles[axis] = curves->head_share[axis] * curves->head[axis]->at(seconds);
    const Eigen::Quaternionf turn(Eigen::AngleAxisf(angles[0], Eigen::Vector3f::UnitY()) *
                                  Eigen::AngleAxisf(angles[1], Eigen::Vector3f::UnitX()) *
                                  Eigen::AngleAxisf(angles[2], Eigen::Vector3f::UnitZ()));
    Eigen::Map<Eigen::Vector4f>(quaternion, 4) = turn.coeffs();
    return FASCIA_OK;
  });
}

}  // extern "C"
