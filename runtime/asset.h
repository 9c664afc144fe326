#pragma once

#include <array>
#include <atomic>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "rig/read/read.h"
#include "runtime/allocator.h"
#include "runtime/drivers/response.h"
#include "runtime/mesh_shape.h"
#include "runtime/message.h"
#include "sim/face_model.h"
#include "sim/jaw_muscles.h"
#include "sim/realtime/model.h"

namespace fascia::runtime {

/// What a name stands for: a channel, or a member of a set (an entry of `Asset::members`).
struct Target {
  enum class Kind : uint8_t { channel, member } kind = Kind::channel;
  uint32_t index = 0;

  bool operator==(const Target&) const = default;
};

/// One of the things that a name drives.
struct Driven {
  Target target;
  float share = 1.0F;
  bool overrides = false;  ///< takes the channel from all other names, where it speaks

  bool operator==(const Driven&) const = default;
};

/// A member of a named set as the channels it adds to. Eyes turn by the weight itself, for a direction of
/// gaze is a number of degrees; everything else follows the response.
struct Member {
  std::vector<std::pair<uint32_t, float>> entries;  ///< channel, weight
  std::vector<std::pair<uint32_t, float>> turns;    ///< the same for channels of the group `eye`
  Response response;

  /// Adds what the member at `weight` asks of each channel to `channels`.
  void add(float weight, std::span<float> channels) const;
  /// Derivative by the weight, at `weight`, of a loss whose derivatives by the channels are `by_channel`.
  float slope(float weight, std::span<const float> by_channel) const;
};

/// The channels that the jaw and the eyes listen to; -1 where the rig has none.
struct BoneChannels {
  int32_t jaw_open = -1, jaw_forward = -1, jaw_lateral = -1;
  std::array<int32_t, 2> eye_yaw = {-1, -1}, eye_pitch = {-1, -1};  ///< left, right
};

/// The order of names whose ASCII letters count alike in either case. Looking one up copies nothing.
struct IgnoringCase {
  using is_transparent = void;
  bool operator()(std::string_view a, std::string_view b) const;
};

/// A loaded rig with what every face of it shares. Immutable but for the models, which are made once each.
class Asset {
 public:
  explicit Asset(std::span<const uint8_t> bytes);

  const rig::RigFile& file() const { return file_; }
  const rig::Rig& rig() const { return file_.rig; }
  const std::vector<rig::Primitive>& primitives() const { return file_.primitives; }
  /// The binding of primitive `primitive` at `level`, or null.
  const rig::Binding* binding(std::size_t level, std::size_t primitive) const;
  const std::vector<Member>& members() const { return members_; }
  /// Place of a set's first member among them.
  uint32_t first_member(std::size_t set) const;
  const BoneChannels& bones() const { return bones_; }
  const sim::JawMuscles& jaw_muscles() const { return jaw_muscles_; }

  /// What `name` stands for, case-insensitive; nothing when no channel or member bears it. "#7" is channel 7.
  std::optional<Target> find(std::string_view name) const;

  /// What `name` drives: as `find`, else in any spelling of a channel's or member's name, or by the table of
  /// other programs' names (anatomy/data/aliases.json). Empty when it drives nothing.
  std::vector<Driven> resolve(std::string_view name) const;

  /// Tells this asset from every other of the process.
  uint64_t serial() const { return serial_; }

  /// The model of a level, made on first use; any thread may ask. Throws Failure when the lattice is unsound.
  const sim::FaceModel& model(std::size_t level) const;
  /// The same, laid out for real time.
  const sim::realtime::Model& realtime_model(std::size_t level) const;
  /// The primitives as faces of a level see them in `space`, made on first use; any thread may ask. Throws
  /// Failure when there is no such space.
  const std::vector<std::unique_ptr<MeshShape>>& shapes(std::size_t level, fascia_space space) const;

  // Arrays of texts in the shape the C interface hands them out.
  std::vector<const char*> channel_names, channel_groups, channel_units;
  std::vector<float> channel_minimum, channel_maximum, channel_rest;
  std::vector<std::vector<const char*>> set_members;    ///< by set
  std::vector<std::vector<const char*>> fibre_muscles;  ///< by level

  /// A hash of the rig's bytes.
  uint64_t contents() const { return contents_; }

 private:
  void index_channels();
  void index_sets();

  rig::RigFile file_;
  std::vector<Member> members_;
  std::map<std::string, Target, IgnoringCase> names_;
  std::map<std::string, Target, std::less<>> spellings_;  ///< as `spelled` gives them
  uint64_t serial_ = 0, contents_ = 0;
  BoneChannels bones_;
  sim::JawMuscles jaw_muscles_;
  mutable std::mutex models_mutex_;
  mutable std::vector<std::unique_ptr<sim::FaceModel>> models_;
  mutable std::vector<std::unique_ptr<sim::realtime::Model>> realtime_models_;
  mutable std::map<std::pair<std::size_t, fascia_space>, std::vector<std::unique_ptr<MeshShape>>> shapes_;

  const sim::FaceModel& model_under_lock(std::size_t level) const;
};

}  // namespace fascia::runtime

/// Behind the C handle: the asset lives as long as anything uses it.
struct fascia_asset {
  std::shared_ptr<const fascia::runtime::Asset> asset;
  fascia::runtime::CountedHandle counted{};
};
