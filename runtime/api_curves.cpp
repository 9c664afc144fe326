#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <map>
#include <mutex>

#include "runtime/api.h"
#include "runtime/drivers/aliases.h"
#include "runtime/drivers/curves.h"

using namespace fascia::runtime;

/// Behind the C handle.
struct fascia_curves {
  Curves curves;
  std::vector<const char*> names, notes;
  std::array<const Curve*, 3> head = {};  ///< yaw, pitch, roll
  std::array<float, 3> head_share = {};
  CountedHandle counted;

  /// What each curve drives in an asset; found once. Of several that drive the same, the first does.
  const std::vector<std::vector<Driven>>& driven(const Asset& asset) const {
    const std::lock_guard lock(mutex_);
    auto& found = driven_[asset.serial()];
    if (!found) {
      auto made = std::make_unique<std::vector<std::vector<Driven>>>();
      for (const Curve& curve : curves.curves) {
        std::vector<Driven> targets = asset.resolve(curve.name);
        if (std::find(made->begin(), made->end(), targets) != made->end()) targets.clear();
        made->push_back(std::move(targets));
      }
      found = std::move(made);  // whole, or not at all
    }
    return *found;
  }

 private:
  mutable std::mutex mutex_;
  mutable std::map<uint64_t, std::unique_ptr<std::vector<std::vector<Driven>>>> driven_;
};

namespace {

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

}  // namespace

extern "C" {

fascia_result fascia_curves_load(const void* bytes, size_t size, fascia_curves** curves) {
  return fascia_curves_load_as(bytes, size, nullptr, curves);
}

fascia_result fascia_curves_load_as(const void* bytes, size_t size, const fascia_curves_options* options,
                                    fascia_curves** curves) {
  return guarded([&] {
    require(curves != nullptr && (bytes != nullptr || size == 0),
            "fascia_curves_load: bytes or curves is null");
    require(size > 0, "the file is empty");
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
    hand_over(std::move(loaded), curves);
    return FASCIA_OK;
  });
}

void fascia_curves_release(fascia_curves* curves) {
  released(curves);
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
                                  fascia_face* face) {
  return fascia_curves_apply_to_layer(curves, seconds, weight, face, 0);
}

fascia_result fascia_curves_apply_to_layer(const fascia_curves* curves, double seconds, float weight,
                                           fascia_face* handle, uint32_t layer) {
  return guarded([&] {
    require(curves != nullptr, "the curves are null");
    require(std::isfinite(seconds) && std::isfinite(weight), "the time or weight is not a finite number");
    Face& face = with_layer(handle, layer);
    const auto& driven = curves->driven(face.asset());
    for (std::size_t i = 0; i < driven.size(); ++i) {
      if (driven[i].empty()) continue;
      const float value = curves->curves.curves[i].at(seconds);
      for (const Driven& entry : driven[i])
        if (entry.overrides && entry.target.kind == Target::Kind::channel)
          face.mixer().take_over(layer, entry.target.index, entry.share * value, weight);
        else
          face.mixer().add(layer, entry.target, entry.share * value, weight);
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
