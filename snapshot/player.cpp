#include "snapshot/player.h"

#include "geometry/error.h"

namespace fascia::snapshot {

namespace {

template <class T>
T sized() {
  T value = {};
  value.struct_size = sizeof(T);
  return value;
}

void check(fascia_result result, const std::string& what) {
  if (result == FASCIA_ERROR_MEMORY) throw std::bad_alloc();
  if (result != FASCIA_OK) throw Error(what + ": " + fascia_last_message());
}

}  // namespace

Player::Player(std::span<const uint8_t> rig, const std::string& name, const std::string& level)
    : name_(name) {
  fascia_asset* asset = nullptr;
  check(fascia_asset_load(rig.data(), rig.size(), &asset), name);
  asset_.reset(asset, Release());
  auto info = sized<fascia_asset_info>();
  check(fascia_asset_get_info(asset, &info), name);
  std::string known;
  for (uint32_t i = 0; i < info.level_count; ++i) {
    auto entry = sized<fascia_level_info>();
    check(fascia_asset_get_level(asset, i, &entry), name);
    known += (i > 0 ? ", " : "") + std::string(entry.name);
    if (level.empty() || level == entry.name) {
      level_ = static_cast<int32_t>(i);
      level_name_ = entry.name;
    }
  }
  if (level_ < 0) throw Error(name + ": the rig has no level '" + level + "'; it has: " + known);
  create();
  auto meshes = std::make_shared<std::vector<PlayedMesh>>();
  for (uint32_t m = 0; m < info.mesh_count; ++m) {
    auto entry = sized<fascia_mesh_info>();
    check(fascia_asset_get_mesh(asset, m, &entry), name);
    const std::span<const float> now = positions(m);
    meshes->push_back({entry.mesh, entry.primitive, entry.part, {now.begin(), now.end()}});
  }
  meshes_ = meshes;
}

Player Player::sibling() const {
  Player other;
  other.name_ = name_;
  other.level_name_ = level_name_;
  other.level_ = level_;
  other.asset_ = asset_;
  other.meshes_ = meshes_;
  other.create();
  return other;
}

void Player::create() {
  fascia_face_options options = fascia_default_face_options();
  options.space = FASCIA_SPACE_METRES;
  options.level = level_;
  fascia_face* face = nullptr;
  check(fascia_face_create(asset_.get(), &options, &face), name_);
  face_.reset(face);
}

std::vector<Pose> Player::all_poses() const {
  std::vector<Pose> poses;
  auto channels = sized<fascia_channels>();
  check(fascia_asset_get_channels(asset_.get(), &channels), name_);
  for (uint32_t c = 0; c < channels.count; ++c) {
    const std::string channel = channels.names[c];
    if (channels.maximum[c] > channels.rest[c])
      poses.push_back({channel, {{channel, static_cast<double>(channels.maximum[c])}}});
    if (channels.minimum[c] < channels.rest[c])
      poses.push_back({channel + " least", {{channel, static_cast<double>(channels.minimum[c])}}});
  }
  auto info = sized<fascia_asset_info>();
  check(fascia_asset_get_info(asset_.get(), &info), name_);
  for (uint32_t s = 0; s < info.set_count; ++s) {
    auto set = sized<fascia_set_info>();
    check(fascia_asset_get_set(asset_.get(), s, &set), name_);
    if (std::string(set.name) != "arkit") continue;
    for (uint32_t m = 0; m < set.member_count; ++m) {
      const std::string member = "arkit:" + std::string(set.members[m]);
      poses.push_back({member, {{member, 1.0}}});
    }
  }
  return poses;
}

void Player::pose(const Values& values) {
  check(fascia_face_clear(face_.get()), name_);
  check(fascia_face_reset(face_.get()), name_);
  for (const auto& [name, value] : values) {
    const fascia_result result = fascia_face_set(face_.get(), name.c_str(), static_cast<float>(value));
    if (result == FASCIA_ERROR_NAME)
      throw Error(name_ + ": the rig has no channel or shape '" + name +
                  "'; take it out of the poses, or see what there is with 'fascia info RIG --channels'");
    check(result, "'" + name + "'");
  }
  check(fascia_face_pose(face_.get()), name_);
}

void Player::begin(const fascia_curves* curves) {
  check(fascia_face_clear(face_.get()), name_);
  check(fascia_face_reset(face_.get()), name_);
  check(fascia_curves_apply(curves, 0.0, 1.0F, face_.get()), name_);
  check(fascia_face_pose(face_.get()), name_);
}

bool Player::step(const fascia_curves* curves, double time, double seconds) {
  check(fascia_curves_apply(curves, time, 1.0F, face_.get()), name_);
  const fascia_result result = fascia_face_step(face_.get(), static_cast<float>(seconds));
  if (result == FASCIA_ERROR_DIVERGED) return false;
  check(result, name_);
  return true;
}

std::span<const float> Player::positions(size_t mesh) const {
  auto vectors = sized<fascia_vectors>();
  check(fascia_face_positions(face_.get(), static_cast<uint32_t>(mesh), &vectors), name_);
  return {vectors.data, static_cast<size_t>(vectors.count) * 3};
}

std::shared_ptr<fascia_curves> load_curves(std::span<const uint8_t> bytes, const std::string& name) {
  fascia_curves* curves = nullptr;
  check(fascia_curves_load(bytes.data(), bytes.size(), &curves), name);
  return {curves, [](fascia_curves* held) { fascia_curves_release(held); }};
}

}  // namespace fascia::snapshot
