#include "runtime/asset.h"

#include <algorithm>
#include <charconv>

#include "runtime/drivers/aliases.h"
#include "runtime/fnv.h"

namespace fascia::runtime {
namespace {

Failure unsound(std::size_t level, const std::string& fault) {
  return {FASCIA_ERROR_FORMAT, "FASCIA_tissue/levels/" + std::to_string(level) + ": " + fault};
}

/// Gives each of a set's members its response.
void read_responses(const rig::NamedSet& set, std::span<Member> members) {
  const std::size_t knots = set.response_weights.size();
  for (std::size_t m = 0; m < members.size() && knots > 0; ++m)
    try {
      members[m].response =
          Response(set.response_weights, std::span(set.responses).subspan(m * knots, knots));
    } catch (const Error& error) {
      throw Failure(FASCIA_ERROR_FORMAT, "FASCIA_actuation/sets/" + set.name +
                                             "/responses: " + set.members[m] + ": " + error.what());
    }
}

}  // namespace

void Member::add(float weight, std::span<float> channels) const {
  const float share = response.share(weight);
  for (const auto& [channel, most] : entries)
    channels[channel] += most * share;
  for (const auto& [channel, most] : turns)
    channels[channel] += most * weight;
}

float Member::slope(float weight, std::span<const float> by_channel) const {
  float by_share = 0.0F, by_weight = 0.0F;
  for (const auto& [channel, most] : entries)
    by_share += most * by_channel[channel];
  for (const auto& [channel, most] : turns)
    by_weight += most * by_channel[channel];
  return by_share * response.slope(weight) + by_weight;
}

bool IgnoringCase::operator()(std::string_view a, std::string_view b) const {
  const auto lower = [](char c) {
    return static_cast<unsigned char>(c >= 'A' && c <= 'Z' ? c - 'A' + 'a' : c);
  };
  return std::lexicographical_compare(a.begin(), a.end(), b.begin(), b.end(),
                                      [&](char left, char right) { return lower(left) < lower(right); });
}

Asset::Asset(std::span<const uint8_t> bytes)
    : file_(rig::read(bytes)), models_(file_.rig.tissue.levels.size()), realtime_models_(models_.size()) {
  static std::atomic<uint64_t> next{1};
  serial_ = next++;
  contents_ = hash_of(bytes.data(), bytes.size());
  index_channels();
  index_sets();
  for (const auto& [name, target] : names_)
    spellings_.emplace(spelled(name), target);
  if (const char* fault = sim::jaw_fault(sim::jaw_of(rig().skull.jaw)))
    throw Failure(FASCIA_ERROR_FORMAT, std::string("FASCIA_skull/jaw: ") + fault);
  jaw_muscles_ = sim::jaw_muscles_of(rig());
  for (std::size_t level = 0; level < models_.size(); ++level)
    if (const char* fault = sim::lattice_fault(sim::lattice_of(rig().tissue.levels[level])))
      throw unsound(level, fault);
  for (const rig::TissueLevel& level : rig().tissue.levels) {
    auto& muscles = fibre_muscles.emplace_back();
    for (const uint32_t muscle : level.fibre_muscle)
      muscles.push_back(rig().muscles[muscle].name.c_str());
  }
}

void Asset::index_channels() {
  const auto& channels = rig().actuation.channels;
  for (uint32_t i = 0; i < channels.size(); ++i) {
    channel_names.push_back(channels[i].name.c_str());
    channel_groups.push_back(channels[i].group.c_str());
    channel_units.push_back(channels[i].unit.c_str());
    channel_minimum.push_back(channels[i].minimum);
    channel_maximum.push_back(channels[i].maximum);
    channel_rest.push_back(channels[i].rest);
    names_.emplace(channels[i].name, Target{Target::Kind::channel, i});
  }
  const auto channel = [&](const char* name) {
    const auto target = find(name);
    return target ? static_cast<int32_t>(target->index) : -1;
  };
  bones_.jaw_open = channel("jaw_open");
  bones_.jaw_forward = channel("jaw_forward");
  bones_.jaw_lateral = channel("jaw_lateral");
  bones_.eye_yaw = {channel("eye_yaw_left"), channel("eye_yaw_right")};
  bones_.eye_pitch = {channel("eye_pitch_left"), channel("eye_pitch_right")};
}

void Asset::index_sets() {
  for (const rig::NamedSet& set : rig().actuation.sets) {
    const auto first = static_cast<uint32_t>(members_.size());
    members_.resize(first + set.members.size());
    for (std::size_t e = 0; e < set.weights.size(); ++e) {
      const uint32_t channel = set.channel_indices[e];
      Member& member = members_[first + set.member_indices[e]];
      auto& list = rig().actuation.channels[channel].group == "eye" ? member.turns : member.entries;
      list.emplace_back(channel, set.weights[e]);
    }
    read_responses(set, std::span(members_).subspan(first));
    auto& texts = set_members.emplace_back();
    for (uint32_t m = 0; m < set.members.size(); ++m) {
      texts.push_back(set.members[m].c_str());
      const Target target{Target::Kind::member, first + m};
      names_.emplace(set.name + ":" + set.members[m], target);
      names_.emplace(set.members[m], target);
    }
  }
}

uint32_t Asset::first_member(std::size_t set) const {
  std::size_t first = 0;
  for (std::size_t i = 0; i < set; ++i)
    first += set_members[i].size();
  return static_cast<uint32_t>(first);
}

const rig::Binding* Asset::binding(std::size_t level, std::size_t primitive) const {
  for (const rig::Binding& binding : rig().tissue.bindings[level])
    if (file_.primitive_of(binding) == primitive) return &binding;
  return nullptr;
}

std::optional<Target> Asset::find(std::string_view name) const {
  if (!name.empty() && name.front() == '#') {
    uint32_t index = 0;
    const char* end = name.data() + name.size();
    const auto parsed = std::from_chars(name.data() + 1, end, index);
    if (parsed.ec != std::errc() || parsed.ptr != end || index >= channel_names.size()) return std::nullopt;
    return Target{Target::Kind::channel, index};
  }
  const auto found = names_.find(name);
  if (found == names_.end()) return std::nullopt;
  return found->second;
}

std::vector<Driven> Asset::resolve(std::string_view name) const {
  if (const auto target = find(name)) return {{*target, 1.0F, false}};
  std::vector<Driven> driven;
  const Alias* alias = find_alias(name);
  if (alias && alias->measure != Measure::head) {
    for (const auto& [target_name, share] : alias->targets)
      if (const auto target = find(target_name))
        driven.push_back({*target, share, alias->measure == Measure::rotation});
    return driven;
  }
  for (const std::string& reading : readings(name)) {
    if (const auto target = find(reading)) return {{*target, 1.0F, false}};
    const auto found = spellings_.find(spelled(reading));
    if (found != spellings_.end()) return {{found->second, 1.0F, false}};
  }
  return driven;
}

const sim::FaceModel& Asset::model(std::size_t level) const {
  const std::lock_guard lock(models_mutex_);
  return model_under_lock(level);
}

const sim::realtime::Model& Asset::realtime_model(std::size_t level) const {
  const std::lock_guard lock(models_mutex_);
  auto& model = realtime_models_[level];
  if (!model) {
    auto made = std::make_unique<sim::realtime::Model>(model_under_lock(level));
    if (!made->valid()) throw unsound(level, made->fault());
    model = std::move(made);
  }
  return *model;
}

const std::vector<std::unique_ptr<MeshShape>>& Asset::shapes(std::size_t level, fascia_space space) const {
  require(space == FASCIA_SPACE_MESH || space == FASCIA_SPACE_INPUT || space == FASCIA_SPACE_METRES,
          "unknown space");
  const std::lock_guard lock(models_mutex_);
  auto& shapes = shapes_[{level, space}];
  for (std::size_t i = shapes.size(); i < primitives().size(); ++i)
    shapes.push_back(
        std::make_unique<MeshShape>(primitives()[i], binding(level, i), rig().input_to_metres, space));
  return shapes;
}

const sim::FaceModel& Asset::model_under_lock(std::size_t level) const {
  auto& model = models_[level];
  if (!model) {
    auto made =
        std::make_unique<sim::FaceModel>(sim::lattice_of(rig().tissue.levels[level]),
                                         sim::jaw_of(rig().skull.jaw), sim::face_options_of(rig().tissue));
    if (!made->valid()) throw unsound(level, made->fault());
    model = std::move(made);
  }
  return *model;
}

}  // namespace fascia::runtime
