#include "runtime/api.h"

using namespace fascia::runtime;

namespace {

void set_member(Face& face, uint32_t layer, uint32_t set, uint32_t member, float value) {
  const auto& sets = face.asset().set_members;
  check_index(set, sets.size(), "set");
  check_index(member, sets[set].size(), "member");
  require(std::isfinite(value), "the value is not a finite number");
  face.mixer().set(layer, {Target::Kind::member, face.asset().first_member(set) + member}, value);
}

}  // namespace

extern "C" {

float* fascia_face_values(fascia_face* face) {
  return face == nullptr ? nullptr : face->face->mixer().values().data();
}

const float* fascia_face_effective_values(const fascia_face* face) {
  return face == nullptr ? nullptr : face->face->mixer().effective().data();
}

fascia_result fascia_face_set(fascia_face* handle, const char* name, float value) {
  return guarded([&] {
    Face& face = checked(handle);
    require(std::isfinite(value), "the value is not a finite number");
    for_each_named(face, name,
                   [&](const Driven& driven) { face.mixer().set(0, driven.target, driven.share * value); });
    return FASCIA_OK;
  });
}

fascia_result fascia_face_get(const fascia_face* handle, const char* name, float* value) {
  return guarded([&] {
    const Face& face = checked(handle);
    require(value != nullptr, "the value to write is null");
    std::optional<float> found;
    for_each_named(face, name, [&](const Driven& driven) {
      if (!found) found = face.mixer().get(0, driven.target) / driven.share;
    });
    *value = *found;
    return FASCIA_OK;
  });
}

fascia_result fascia_face_clear(fascia_face* handle) {
  return guarded([&] {
    checked(handle).mixer().clear(0);
    return FASCIA_OK;
  });
}

fascia_result fascia_face_set_member(fascia_face* handle, uint32_t set, uint32_t member, float value) {
  return guarded([&] {
    set_member(checked(handle), 0, set, member, value);
    return FASCIA_OK;
  });
}

fascia_result fascia_face_set_layer(fascia_face* handle, uint32_t index, const fascia_layer* layer) {
  return guarded([&] {
    Face& face = checked(handle);
    require(index >= 1 && index < Mixer::most_layers, "layers of a face's own are 1 to 7");
    require(layer != nullptr, "the layer is null");
    const fascia_layer chosen = taken(layer, {sizeof(fascia_layer), FASCIA_COMBINE_ADD, 1.0F, 0, nullptr});
    require(chosen.combine >= FASCIA_COMBINE_ADD && chosen.combine <= FASCIA_COMBINE_OVERRIDE,
            "unknown way to combine");
    require(chosen.weight >= 0.0F && chosen.weight <= 1.0F, "the weight must lie between 0 and 1");
    std::span<const float> mask;
    if (chosen.mask != nullptr) mask = {chosen.mask, face.asset().channel_names.size()};
    for (const float share : mask)
      require(share >= 0.0F && share <= 1.0F, "the mask's weights must lie between 0 and 1");
    face.mixer().set_layer(index, static_cast<Combine>(chosen.combine), chosen.weight, mask);
    return FASCIA_OK;
  });
}

float* fascia_face_layer_values(fascia_face* face, uint32_t layer) {
  if (face == nullptr || !face->face->mixer().has_layer(layer)) return nullptr;
  return face->face->mixer().values(layer).data();
}

fascia_result fascia_face_layer_set(fascia_face* handle, uint32_t layer, const char* name, float value) {
  return guarded([&] {
    Face& face = with_layer(handle, layer);
    require(std::isfinite(value), "the value is not a finite number");
    for_each_named(face, name, [&](const Driven& driven) {
      face.mixer().set(layer, driven.target, driven.share * value);
    });
    return FASCIA_OK;
  });
}

fascia_result fascia_face_layer_set_member(fascia_face* handle, uint32_t layer, uint32_t set, uint32_t member,
                                           float value) {
  return guarded([&] {
    set_member(with_layer(handle, layer), layer, set, member, value);
    return FASCIA_OK;
  });
}

fascia_result fascia_face_layer_remove(fascia_face* face, uint32_t layer) {
  return guarded([&] {
    require(layer != 0, "layer 0 is the face's own and cannot be removed");
    with_layer(face, layer).mixer().remove_layer(layer);
    return FASCIA_OK;
  });
}

fascia_result fascia_face_layer_clear(fascia_face* face, uint32_t layer) {
  return guarded([&] {
    with_layer(face, layer).mixer().clear(layer);
    return FASCIA_OK;
  });
}

fascia_result fascia_face_look_at(fascia_face* face, const float* point, float weight) {
  return guarded([&] {
    require(weight >= 0.0F && weight <= 1.0F, "the weight must lie between 0 and 1");
    std::optional<Vec3f> target;
    if (point != nullptr) target = Eigen::Map<const Vec3f>(point);
    require(!target || target->allFinite(), "the point is not finite");
    checked(face).mixer().look_at(target, weight);
    return FASCIA_OK;
  });
}

fascia_result fascia_face_blend(fascia_face* face, float share, float seconds) {
  return guarded([&] {
    require(share >= 0.0F && share <= 1.0F, "the share must lie between 0 and 1");
    require(std::isfinite(seconds) && seconds >= 0.0F, "seconds must be 0 or more");
    checked(face).mixer().blend(share, seconds);
    return FASCIA_OK;
  });
}

}  // extern "C"
