#include "runtime/mixer.h"

#include <algorithm>
#include <cmath>

#include "geometry/smoothstep.h"

namespace fascia::runtime {
namespace {

float finite(float value) {
  return std::isfinite(value) ? value : 0.0F;
}

/// Two departures from rest as one, `room` being what there is in the direction of either.
float joined(Combine combine, float below, float above, float weight, float room_up, float room_down) {
  const float added = weight * above;
  switch (combine) {
    case Combine::add:
      return below + added;
    case Combine::maximum:
      return std::abs(added) > std::abs(below) ? added : below;
    case Combine::saturate: {
      const float room = below + added > 0.0F ? room_up : -room_down;
      if (below * added <= 0.0F || room == 0.0F) return below + added;
      return room * (1.0F - (1.0F - below / room) * (1.0F - added / room));
    }
    case Combine::override:
      return below + weight * (above - below);
  }
  return below;
}

}  // namespace

Layer::Layer(const Asset& asset)
    : values(asset.channel_rest),
      members(asset.members().size(), 0.0F),
      curve_channels(values.size(), 0.0F),
      curve_members(members),
      taken(curve_channels),
      taken_weight(curve_channels),
      mask(values.size(), 1.0F) {}

Mixer::Mixer(const Asset& asset)
    : asset_(&asset), effective_(asset.channel_rest), scratch_(asset.channel_rest) {
  layers_[0] = std::make_unique<Layer>(asset);
}

void Mixer::set_layer(uint32_t index, Combine combine, float weight, std::span<const float> mask) {
  if (!layers_[index]) layers_[index] = std::make_unique<Layer>(*asset_);
  Layer& layer = *layers_[index];
  if (!layer.is_there) clear(index);  // what was written to its values since
  layer.is_there = true;
  layer.combine = combine;
  layer.weight = weight;
  std::fill(layer.mask.begin(), layer.mask.end(), 1.0F);
  std::copy(mask.begin(), mask.end(), layer.mask.begin());
}

void Mixer::remove_layer(uint32_t index) {
  Layer& layer = *layers_[index];
  clear(index);
  for (auto* list : {&layer.taken, &layer.taken_weight, &layer.curve_channels, &layer.curve_members})
    std::fill(list->begin(), list->end(), 0.0F);
  layer.is_there = false;
}

void Mixer::set(uint32_t layer, const Target& target, float value) {
  auto& list = target.kind == Target::Kind::channel ? layers_[layer]->values : layers_[layer]->members;
  list[target.index] = value;
}

float Mixer::get(uint32_t layer, const Target& target) const {
  const auto& list = target.kind == Target::Kind::channel ? layers_[layer]->values : layers_[layer]->members;
  return list[target.index];
}

void Mixer::clear(uint32_t layer) {
  layers_[layer]->values = asset_->channel_rest;
  std::fill(layers_[layer]->members.begin(), layers_[layer]->members.end(), 0.0F);
}

void Mixer::add(uint32_t layer, const Target& target, float value, float weight) {
  if (target.kind == Target::Kind::channel)
    layers_[layer]->curve_channels[target.index] += weight * (value - asset_->channel_rest[target.index]);
  else
    layers_[layer]->curve_members[target.index] += weight * value;
}

void Mixer::take_over(uint32_t layer, uint32_t channel, float value, float weight) {
  layers_[layer]->taken[channel] += weight * value;
  layers_[layer]->taken_weight[channel] += weight;
}

void Mixer::look_at(const std::optional<Vec3f>& point, float weight) {
  gaze_.point = point.value_or(Vec3f::Zero());
  gaze_.weight = point ? weight : 0.0F;
}

void Mixer::blend(float share, float seconds) {
  blend_ = {blend_.share, blend_.share, share, seconds, 0.0F};
  if (seconds <= 0.0F) blend_.share = share;
}

void Mixer::sum_up(Layer& layer, std::vector<float>& sums) const {
  for (std::size_t c = 0; c < sums.size(); ++c)
    sums[c] = (std::isfinite(layer.values[c]) ? layer.values[c] : asset_->channel_rest[c]) +
              finite(layer.curve_channels[c]);
  for (std::size_t m = 0; m < layer.members.size(); ++m) {
    const float value = finite(layer.members[m]) + finite(layer.curve_members[m]);
    if (value != 0.0F) asset_->members()[m].add(value, sums);
  }
  for (std::size_t c = 0; c < sums.size(); ++c) {
    if (layer.taken_weight[c] <= 0.0F || !std::isfinite(layer.taken[c])) continue;
    const float share = std::min(layer.taken_weight[c], 1.0F);
    sums[c] = (1.0F - share) * sums[c] + layer.taken[c] * (share / layer.taken_weight[c]);
  }
  for (auto* list : {&layer.taken, &layer.taken_weight, &layer.curve_channels, &layer.curve_members})
    std::fill(list->begin(), list->end(), 0.0F);
}

void Mixer::clamp(std::vector<float>& values) const {
  for (std::size_t c = 0; c < values.size(); ++c)
    values[c] = std::clamp(values[c], asset_->channel_minimum[c], asset_->channel_maximum[c]);
}

void Mixer::join(const Layer& layer) {
  for (std::size_t c = 0; c < effective_.size(); ++c) {
    const float rest = asset_->channel_rest[c];
    const float weight = layer.weight * finite(layer.mask[c]);
    if (weight == 0.0F) continue;
    effective_[c] = rest + joined(layer.combine, effective_[c] - rest, scratch_[c] - rest, weight,
                                  asset_->channel_maximum[c] - rest, rest - asset_->channel_minimum[c]);
  }
}

void Mixer::turn_eyes() {
  if (gaze_.weight <= 0.0F) return;
  const BoneChannels& bones = asset_->bones();
  const rig::Skull& skull = asset_->rig().skull;
  // Eyes converge on points no nearer than they are apart; nearer, beside and behind the head they turn
  // together.
  const float nearest = (skull.eye_left.centre - skull.eye_right.centre).norm();
  const float most = std::atan(0.5F);  // radians from the direction of both, on a point as near as that
  const auto yaw = [](const Vec3f& along) { return std::atan2(along.x(), std::max(along.z(), 1e-3F)); };
  const Vec3f middle = gaze_.point - 0.5F * (skull.eye_left.centre + skull.eye_right.centre);
  const float vergence = most * std::clamp(middle.z() / nearest, 0.0F, 1.0F);
  for (std::size_t eye = 0; eye < 2; ++eye) {
    const Vec3f along = gaze_.point - (eye == 0 ? skull.eye_left.centre : skull.eye_right.centre);
    if (along.norm() < 1e-4F) continue;  // a point in the eye itself
    const float angles[2] = {std::clamp(yaw(along), yaw(middle) - vergence, yaw(middle) + vergence),
                             std::atan2(along.y(), std::hypot(along.x(), along.z()))};
    const int32_t channels[2] = {bones.eye_yaw[eye], bones.eye_pitch[eye]};
    for (int axis = 0; axis < 2; ++axis)
      if (channels[axis] >= 0) {
        float& value = effective_[static_cast<std::size_t>(channels[axis])];
        value += gaze_.weight * (angles[axis] - value);
      }
  }
}

void Mixer::gather(double seconds) {
  sum_up(*layers_[0], effective_);
  clamp(effective_);
  for (uint32_t i = 1; i < most_layers; ++i) {
    if (!has_layer(i)) continue;
    sum_up(*layers_[i], scratch_);
    clamp(scratch_);
    join(*layers_[i]);
    clamp(effective_);
  }
  turn_eyes();
  if (blend_.passed < blend_.length) {
    blend_.passed = std::min(blend_.length, blend_.passed + static_cast<float>(seconds));
    blend_.share = blend_.from + smoothstep(blend_.passed / blend_.length) * (blend_.to - blend_.from);
  }
  if (blend_.share != 1.0F)
    for (std::size_t c = 0; c < effective_.size(); ++c)
      effective_[c] = asset_->channel_rest[c] + blend_.share * (effective_[c] - asset_->channel_rest[c]);
  clamp(effective_);
}

uint64_t Mixer::layers_there() const {
  uint64_t which = 0;
  for (uint32_t i = 0; i < most_layers; ++i)
    which |= uint64_t{has_layer(i)} << i;
  return which;
}

bool Mixer::has_layers_of(std::span<const uint8_t> state) const {
  auto bytes = sim::StateBytes::from(state);
  uint64_t which = 0;
  bytes.value(which);
  return which == layers_there();
}

bool Mixer::exchange_state(sim::StateBytes& bytes) {
  uint64_t which = layers_there();
  bytes.value(which);
  if (which != layers_there()) return false;
  for (uint32_t i = 0; i < most_layers; ++i) {
    if (!has_layer(i)) continue;
    Layer& layer = *layers_[i];
    for (auto* list : {&layer.values, &layer.members, &layer.curve_channels, &layer.curve_members,
                       &layer.taken, &layer.taken_weight, &layer.mask})
      bytes.list(list->data(), list->size());
    auto combine = static_cast<uint32_t>(layer.combine);
    bytes.value(combine);
    if (combine > static_cast<uint32_t>(Combine::override)) return false;
    layer.combine = static_cast<Combine>(combine);
    bytes.value(layer.weight);
  }
  bytes.list(effective_.data(), effective_.size());
  bytes.value(gaze_.point);
  bytes.value(gaze_.weight);
  bytes.value(blend_);
  return !bytes.is_short();
}

}  // namespace fascia::runtime
