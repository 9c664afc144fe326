#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "runtime/asset.h"
#include "sim/state_bytes.h"

namespace fascia::runtime {

/// How a layer joins those below it, by channel.
enum class Combine : uint8_t {
  add = 0,       ///< the sum of both departures from rest
  maximum = 1,   ///< the one that departs further
  saturate = 2,  ///< 1 - (1 - a)(1 - b) of the way to the end of the range: never beyond it, no kink
  override = 3   ///< the layer alone, as far as its weight and mask go
};

/// One source of channel values: own ones, members of sets, and what curves add for one frame.
struct Layer {
  explicit Layer(const Asset& asset);
  std::vector<float> values, members, curve_channels, curve_members;
  std::vector<float> taken, taken_weight;  ///< by channel: what has it to itself, and how far
  Combine combine = Combine::add;
  float weight = 1.0F;
  std::vector<float> mask;  ///< by channel 0..1
  bool is_there = true;     ///< false: removed; its memory stays for those who hold a pointer to its values
};

/// What moves a face: layers of values, the gaze, and the share of all that is let through. Gathered once a
/// frame into one value a channel.
class Mixer {
 public:
  static constexpr uint32_t most_layers = 8;

  /// With layer 0, which is always there. `asset` must outlive this.
  explicit Mixer(const Asset& asset);

  /// Makes layer `index` (1 .. most_layers - 1) or changes how it joins. `mask` #channels, or empty for all
  /// channels alike. Allocates when the face never had the layer.
  void set_layer(uint32_t index, Combine combine, float weight, std::span<const float> mask);
  /// Removes a layer other than 0 with all that was put into it.
  void remove_layer(uint32_t index);
  bool has_layer(uint32_t index) const {
    return index < most_layers && layers_[index] != nullptr && layers_[index]->is_there;
  }

  std::vector<float>& values(uint32_t layer = 0) { return layers_[layer]->values; }
  void set(uint32_t layer, const Target& target, float value);
  float get(uint32_t layer, const Target& target) const;
  /// Puts all values of a layer to rest.
  void clear(uint32_t layer);
  /// Adds to what the next frame uses.
  void add(uint32_t layer, const Target& target, float value, float weight);
  /// The same for a channel that `value` has to itself, as far as `weight` (0..1) goes.
  void take_over(uint32_t layer, uint32_t channel, float value, float weight);

  /// Turns the eyes to a point, metres in the head's frame, as far as `weight` (0..1) goes; nothing ends it.
  void look_at(const std::optional<Vec3f>& point, float weight);

  /// From now on the share of everything that is let through goes to `share` (0 rest .. 1) over `seconds`.
  void blend(float share, float seconds);

  /// Adds everything up and uses the curves up, `seconds` after the last time. Allocates nothing.
  void gather(double seconds);
  /// What `gather` found, by channel, within its range.
  const std::vector<float>& effective() const { return effective_; }
  float effective(int32_t channel) const {
    return channel < 0 ? 0.0F : effective_[static_cast<std::size_t>(channel)];
  }

  /// False when a state that was saved is one with other layers.
  bool has_layers_of(std::span<const uint8_t> state) const;
  /// See sim::StateBytes; false when what was read had other layers.
  bool exchange_state(sim::StateBytes& bytes);

 private:
  /// Sum of a layer's sources into `sums`, absolute values of the channels, and uses its curves up.
  void sum_up(Layer& layer, std::vector<float>& sums) const;
  void join(const Layer& layer);
  uint64_t layers_there() const;  ///< bit i: layer i
  void turn_eyes();
  void clamp(std::vector<float>& values) const;

  const Asset* asset_;
  std::unique_ptr<Layer> layers_[most_layers];
  std::vector<float> effective_, scratch_;
  struct Gaze {
    Vec3f point = Vec3f::Zero();
    float weight = 0.0F;
  } gaze_;
  struct Blend {
    float share = 1.0F, from = 1.0F, to = 1.0F;
    float length = 0.0F, passed = 0.0F;  ///< seconds
  } blend_;
};

}  // namespace fascia::runtime
