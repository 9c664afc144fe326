// Recordings that play together, one row each below the timeline.
#include <algorithm>

#include "app/panels/screen.h"
#include "app/window/theme.h"
#include "app/window/widgets.h"

namespace fascia::app {

namespace {

constexpr float layer_row = 34.0F;  ///< pixels
constexpr int most_layer_rows = 4;  ///< more scroll

int layer_rows(const Workspace& work) {
  const auto layers = static_cast<int>(work.state().take.layers.size());
  return work.take && layers > 0 ? layers + 1 : 0;
}

void show_layer(Workspace& work, int layer, const std::string& file, double weight, bool is_muted,
                float width) {
  const std::string mark = "##layer" + std::to_string(layer + 2);
  ImGui::PushID(layer);
  bool is_heard = !is_muted;
  if (ui::check(mark, is_heard)) work.mute_layer(layer, !is_heard);
  ui::tooltip(is_muted ? "Muted: it does not move the face" : "Mute");
  ImGui::SameLine(0, scaled(8));
  const float left = ImGui::GetCursorPosX(), name_width = std::min(scaled(240), 0.4F * width);
  ImGui::TextColored(
      is_muted ? palette().faint : palette().text, "%s",
      ui::shortened(std::filesystem::path(file).filename().string(), name_width - scaled(10)).c_str());
  ImGui::SameLine(left + name_width);
  auto value = static_cast<float>(weight);
  bool has_ended = false;
  ui::SliderLook look{0.0F, 2.0F, 1.0F, palette().accent, "", "%.2f"};
  if (ui::slider("Weight of layer " + std::to_string(layer + 2), value, look,
                 std::min(scaled(220), width - name_width - scaled(90)), has_ended))
    work.weigh_layer(layer, static_cast<double>(value));
  if (has_ended) work.seal();
  ImGui::SameLine(0, scaled(8));
  if (ui::button("x##layer" + std::to_string(layer + 2), ui::Emphasis::plain, scaled(26)))
    work.remove_layer(layer);
  ui::tooltip("Take it away");
  ImGui::PopID();
}

}  // namespace

float timeline_height(const Workspace& work) {
  const auto rows = static_cast<float>(std::min(layer_rows(work), most_layer_rows));
  return scaled((work.take ? 88.0F : 48.0F) + (rows > 0.0F ? layer_row * rows + 6.0F : 0.0F));
}

void show_layers(Workspace& work, float width) {
  const int rows = layer_rows(work);
  if (rows == 0) return;
  const auto height = static_cast<float>(std::min(rows, most_layer_rows)) * scaled(layer_row);
  ImGui::BeginChild("##layers", {width, height});
  const TakeChoice choice = work.state().take;  // as it is before a row changes it
  show_layer(work, -1, choice.file, choice.weight, choice.is_muted, width);
  for (size_t i = 0; i < choice.layers.size(); ++i)
    show_layer(work, static_cast<int>(i), choice.layers[i].file, choice.layers[i].weight,
               choice.layers[i].is_muted, width);
  ImGui::EndChild();
}

}  // namespace fascia::app
