#include "scene.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <iterator>

namespace {

std::vector<char> file_bytes(const std::string& path) {
  std::ifstream stream(path, std::ios::binary);
  if (!stream) throw std::runtime_error("cannot read " + path);
  return {std::istreambuf_iterator<char>(stream), {}};
}

}  // namespace

void check(fascia_result result, const std::string& what) {
  if (result != FASCIA_OK) throw std::runtime_error(what + ": " + fascia_last_message());
}

Scene::Scene(const std::string& rig, const std::string& curve_file) {
  const std::vector<char> bytes = file_bytes(rig);
  fascia_asset* loaded = nullptr;
  check(fascia_asset_load(bytes.data(), bytes.size(), &loaded), rig);
  asset.reset(loaded);
  check(fascia_asset_get_info(loaded, &info), "info");
  check(fascia_asset_get_channels(loaded, &channels), "channels");
  check(fascia_asset_fibres(loaded, info.level_count - 1, &fibres), "fibres");
  for (uint32_t i = 0; i < info.mesh_count; ++i) {
    meshes.push_back(described<fascia_mesh_info>());
    check(fascia_asset_get_mesh(loaded, i, &meshes.back()), "mesh");
  }
  for (uint32_t i = 0; i < info.set_count; ++i) {
    sets.push_back(described<fascia_set_info>());
    check(fascia_asset_get_set(loaded, i, &sets.back()), "set");
    members.emplace_back(sets.back().member_count, 0.0F);
  }
  fascia_face_options options = fascia_default_face_options();
  options.space = FASCIA_SPACE_METRES;
  fascia_face* made = nullptr;
  check(fascia_face_create(loaded, &options, &made), "face");
  face.reset(made);
  if (curve_file.empty()) return;
  const std::vector<char> motion = file_bytes(curve_file);
  fascia_curves* read = nullptr;
  check(fascia_curves_load(motion.data(), motion.size(), &read), curve_file);
  curves.reset(read);
  fascia_curves_info length = described<fascia_curves_info>();
  check(fascia_curves_get_info(read, &length), "curves");
  duration = length.duration;
  playing = true;
}

void Scene::advance(double seconds) {
  if (curves) {
    if (playing) time = duration > 0 ? std::fmod(time + seconds, duration) : 0;
    check(fascia_curves_apply(curves.get(), time, 1.0F, face.get()), "curves");
  }
  const fascia_result result =
      fascia_face_step(face.get(), static_cast<float>(std::clamp(seconds, 0.0, 0.1)));
  // A face that diverged stands at its bones again and goes on.
  if (result == FASCIA_ERROR_DIVERGED)
    std::fprintf(stderr, "%s\n", fascia_last_message());
  else
    check(result, "step");
}
