#include "runtime/api.h"

using namespace fascia::runtime;

namespace {

const fascia::rig::Surface& surface_named(const Asset& asset, const std::string& name) {
  const fascia::rig::Rig& rig = asset.rig();
  if (name == "cranium") return rig.skull.cranium;
  if (name == "mandible") return rig.skull.mandible;
  if (name == "teeth_upper") return rig.skull.teeth_upper;
  if (name == "teeth_lower") return rig.skull.teeth_lower;
  if (name == "smas") return rig.smas.surface;
  throw Failure(FASCIA_ERROR_NAME,
                "there is no surface " + name + ": use cranium, mandible, teeth_upper, teeth_lower or smas");
}

template <class T>
const float* floats(const std::vector<T>& vectors) {
  return vectors.empty() ? nullptr : reinterpret_cast<const float*>(vectors.data());
}

template <class T>
const uint32_t* indices(const std::vector<T>& lists) {
  return lists.empty() ? nullptr : reinterpret_cast<const uint32_t*>(lists.data());
}

uint32_t count32(std::size_t count) {
  return static_cast<uint32_t>(count);
}

}  // namespace

extern "C" {

fascia_result fascia_asset_load(const void* bytes, size_t size, fascia_asset** asset) {
  return guarded([&] {
    require(asset != nullptr && (bytes != nullptr || size == 0), "fascia_asset_load: bytes or asset is null");
    require(size > 0, "the file is empty");
    const auto* begin = static_cast<const uint8_t*>(bytes);
    auto loaded = std::make_shared<const Asset>(std::span<const uint8_t>(begin, size));
    hand_over(std::unique_ptr<fascia_asset>(new fascia_asset{std::move(loaded)}), asset);
    return FASCIA_OK;
  });
}

void fascia_asset_release(fascia_asset* asset) {
  released(asset);
}

fascia_result fascia_asset_get_info(const fascia_asset* handle, fascia_asset_info* info) {
  return guarded([&] {
    const Asset& asset = checked(handle);
    const fascia::rig::Rig& rig = asset.rig();
    fascia_asset_info value{};
    value.level_count = count32(rig.tissue.levels.size());
    value.mesh_count = count32(asset.primitives().size());
    value.channel_count = count32(rig.actuation.channels.size());
    value.set_count = count32(rig.actuation.sets.size());
    value.muscle_count = count32(rig.muscles.size());
    std::memcpy(value.input_to_metres, rig.input_to_metres.data(), sizeof value.input_to_metres);
    hand_out(value, info);
    return FASCIA_OK;
  });
}

fascia_result fascia_asset_get_level(const fascia_asset* handle, uint32_t index, fascia_level_info* info) {
  return guarded([&] {
    const auto& levels = checked(handle).rig().tissue.levels;
    check_index(index, levels.size(), "level");
    const auto& level = levels[index];
    hand_out(fascia_level_info{0, count32(level.rest.size()), count32(level.spring_nodes.size()),
                               count32(level.fibre_muscle.size()), level.name.c_str()},
             info);
    return FASCIA_OK;
  });
}

fascia_result fascia_asset_get_mesh(const fascia_asset* handle, uint32_t index, fascia_mesh_info* info) {
  return guarded([&] {
    const Asset& asset = checked(handle);
    check_index(index, asset.primitives().size(), "mesh");
    const auto& primitive = asset.primitives()[index];
    const char* part = "";
    for (std::size_t level = asset.rig().tissue.levels.size(); level-- > 0;)
      if (const auto* binding = asset.binding(level, index)) part = binding->part.c_str();
    hand_out(fascia_mesh_info{0, primitive.mesh, primitive.primitive, count32(primitive.positions.size()),
                              count32(primitive.triangles.size()), 0, primitive.name.c_str(), part,
                              indices(primitive.triangles)},
             info);
    return FASCIA_OK;
  });
}

fascia_result fascia_asset_get_channels(const fascia_asset* handle, fascia_channels* channels) {
  return guarded([&] {
    const Asset& asset = checked(handle);
    hand_out(
        fascia_channels{0, count32(asset.channel_names.size()), asset.channel_names.data(),
                        asset.channel_groups.data(), asset.channel_units.data(), asset.channel_minimum.data(),
                        asset.channel_maximum.data(), asset.channel_rest.data()},
        channels);
    return FASCIA_OK;
  });
}

fascia_result fascia_asset_get_set(const fascia_asset* handle, uint32_t index, fascia_set_info* info) {
  return guarded([&] {
    const Asset& asset = checked(handle);
    check_index(index, asset.set_members.size(), "set");
    const auto& members = asset.set_members[index];
    hand_out(fascia_set_info{0, count32(members.size()), asset.rig().actuation.sets[index].name.c_str(),
                             members.data()},
             info);
    return FASCIA_OK;
  });
}

int32_t fascia_asset_find_channel(const fascia_asset* handle, const char* name) {
  int32_t index = -1;
  guarded([&] {
    require(name != nullptr, "the name is null");
    const auto target = checked(handle).find(name);
    if (target && target->kind == fascia::runtime::Target::Kind::channel)
      index = static_cast<int32_t>(target->index);
    return FASCIA_OK;
  });
  return index;
}

fascia_result fascia_asset_find_member(const fascia_asset* handle, const char* name, uint32_t* set,
                                       uint32_t* member) {
  return guarded([&] {
    require(name != nullptr && set != nullptr && member != nullptr, "the name, set or member is null");
    const Asset& asset = checked(handle);
    const auto target = asset.find(name);
    if (!target || target->kind != Target::Kind::member)
      throw Failure(FASCIA_ERROR_NAME, "no set of the rig has a member \"" + std::string(name) + "\"");
    uint32_t rest = target->index, found = 0;
    for (; rest >= asset.set_members[found].size(); ++found)
      rest -= count32(asset.set_members[found].size());
    *set = found;
    *member = rest;
    return FASCIA_OK;
  });
}

fascia_result fascia_asset_texcoords(const fascia_asset* handle, uint32_t mesh, fascia_vectors* texcoords) {
  return guarded([&] {
    const Asset& asset = checked(handle);
    check_index(mesh, asset.primitives().size(), "mesh");
    hand_out_vectors(asset.primitives()[mesh].texture, texcoords);
    return FASCIA_OK;
  });
}

fascia_result fascia_asset_surface(const fascia_asset* handle, const char* name, fascia_surface* surface) {
  return guarded([&] {
    require(name != nullptr, "the name is null");
    const auto& found = surface_named(checked(handle), name);
    hand_out(fascia_surface{0, count32(found.positions.size()), count32(found.triangles.size()), 0,
                            floats(found.positions), indices(found.triangles)},
             surface);
    return FASCIA_OK;
  });
}

fascia_result fascia_asset_fibres(const fascia_asset* handle, uint32_t index, fascia_fibres* fibres) {
  return guarded([&] {
    const Asset& asset = checked(handle);
    check_index(index, asset.rig().tissue.levels.size(), "level");
    const auto& level = asset.rig().tissue.levels[index];
    hand_out(fascia_fibres{0, count32(level.fibre_muscle.size()), count32(level.fibre_rest.size()), 0,
                           level.fibre_offsets.data(), level.fibre_channel.data(),
                           asset.fibre_muscles[index].data(), floats(level.fibre_rest)},
             fibres);
    return FASCIA_OK;
  });
}

}  // extern "C"
