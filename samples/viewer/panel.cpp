#include "panel.h"

#include <imgui.h>

#include <algorithm>
#include <cstring>

namespace {

void show_channels(Scene& scene) {
  float* values = fascia_face_values(scene.face.get());
  const float* used = fascia_face_effective_values(scene.face.get());
  const fascia_channels& channels = scene.channels;
  std::vector<const char*> groups;
  for (uint32_t c = 0; c < channels.count; ++c) {
    const auto same = [&](const char* group) { return std::strcmp(group, channels.groups[c]) == 0; };
    if (std::none_of(groups.begin(), groups.end(), same)) groups.push_back(channels.groups[c]);
  }
  for (const char* group : groups) {
    if (!ImGui::CollapsingHeader(group, ImGuiTreeNodeFlags_DefaultOpen)) continue;
    for (uint32_t c = 0; c < channels.count; ++c) {
      if (std::strcmp(group, channels.groups[c]) != 0) continue;
      ImGui::PushID(static_cast<int>(c));
      ImGui::SetNextItemWidth(130);
      ImGui::SliderFloat(channels.names[c], &values[c], channels.minimum[c], channels.maximum[c], "%.2f");
      if (ImGui::IsItemHovered()) ImGui::SetTooltip("now %.3f", static_cast<double>(used[c]));
      ImGui::PopID();
    }
  }
}

void show_set(Scene& scene, std::size_t set) {
  const fascia_set_info& info = scene.sets[set];
  for (uint32_t m = 0; m < info.member_count; ++m) {
    float& value = scene.members[set][m];
    ImGui::SetNextItemWidth(130);
    if (!ImGui::SliderFloat(info.members[m], &value, 0.0F, 1.0F, "%.2f")) continue;
    check(fascia_face_set(scene.face.get(), (std::string(info.name) + ":" + info.members[m]).c_str(), value),
          "set");
  }
}

void show_layers(Layers& layers) {
  ImGui::Checkbox("skin", &layers.skin);
  ImGui::SameLine();
  ImGui::Checkbox("skull", &layers.skull);
  ImGui::SameLine();
  ImGui::Checkbox("SMAS", &layers.smas);
  ImGui::SameLine();
  ImGui::Checkbox("muscles", &layers.fibres);
  ImGui::SetNextItemWidth(130);
  ImGui::SliderFloat("opacity", &layers.skin_opacity, 0.05F, 1.0F, "%.2f");
  ImGui::SameLine();
  ImGui::Checkbox("wireframe", &layers.wireframe);
}

void show_timeline(Scene& scene) {
  if (!scene.curves) return;
  if (ImGui::Button(scene.playing ? "pause" : "play ")) scene.playing = !scene.playing;
  ImGui::SameLine();
  auto time = static_cast<float>(scene.time);
  ImGui::SetNextItemWidth(-60);
  if (ImGui::SliderFloat("s", &time, 0.0F, static_cast<float>(scene.duration), "%.2f"))
    scene.time = static_cast<double>(time);
}

}  // namespace

void show_panel(Scene& scene, Layers& layers) {
  ImGui::SetNextWindowPos({8, 8}, ImGuiCond_FirstUseEver);
  ImGui::SetNextWindowSize({360, 620}, ImGuiCond_FirstUseEver);
  ImGui::Begin("Face");
  show_layers(layers);
  show_timeline(scene);
  if (ImGui::Button("neutral")) {
    check(fascia_face_clear(scene.face.get()), "clear");
    for (auto& values : scene.members)
      std::fill(values.begin(), values.end(), 0.0F);
  }
  ImGui::SameLine();
  if (ImGui::Button("reset motion")) check(fascia_face_reset(scene.face.get()), "reset");
  if (ImGui::BeginTabBar("vocabularies")) {
    if (ImGui::BeginTabItem("channels")) {
      ImGui::BeginChild("channels");
      show_channels(scene);
      ImGui::EndChild();
      ImGui::EndTabItem();
    }
    for (std::size_t set = 0; set < scene.sets.size(); ++set) {
      if (!ImGui::BeginTabItem(scene.sets[set].name)) continue;
      ImGui::BeginChild("members");
      show_set(scene, set);
      ImGui::EndChild();
      ImGui::EndTabItem();
    }
    ImGui::EndTabBar();
  }
  ImGui::End();
}
