#include <algorithm>
#include <utility>

#include "app/panels/screen.h"
#include "app/window/icons.h"
#include "app/window/theme.h"
#include "app/window/widgets.h"

namespace fascia::app {

namespace {

void centred(const char* text, ImFont* font, const ImVec4& colour) {
  ImGui::PushFont(font);
  ImGui::SetCursorPosX(0.5F * (ImGui::GetWindowWidth() - ImGui::CalcTextSize(text).x));
  ImGui::TextColored(colour, "%s", text);
  ImGui::PopFont();
}

/// Fibres that run from bone to the corner of a mouth: the sign of the start page.
void draw_sign(ImDrawList* list, ImVec2 centre, float size) {
  const int fibres = 26;
  for (int i = 0; i < fibres; ++i) {
    const float share = static_cast<float>(i) / (fibres - 1), spread = share - 0.5F;
    const ImVec2 from(centre.x - (0.62F - 0.5F * spread * spread) * size,
                      centre.y + (0.1F + 0.16F * spread) * size);
    const ImVec2 to(centre.x + (0.66F - 0.9F * spread * spread) * size,
                    centre.y - (0.08F - 0.5F * spread) * size);
    const ImVec2 c1(centre.x - 0.2F * size, centre.y + (0.32F + 0.55F * spread) * size);
    const ImVec2 c2(centre.x + 0.2F * size, centre.y - (0.34F - 0.75F * spread) * size);
    const ImVec4 a = palette().accent, b = palette().warning;
    const ImVec4 colour(a.x + share * (b.x - a.x), a.y + share * (b.y - a.y), a.z + share * (b.z - a.z),
                        0.75F);
    list->AddBezierCubic(from, c1, c2, to, colour_of(colour), scaled(1.5F), 32);
  }
}

void show_recent(Workspace& work, float width) {
  if (work.settings.recent.empty()) return;
  ImGui::Dummy({0, scaled(14)});
  const float left = 0.5F * (ImGui::GetWindowWidth() - width);
  ImGui::SetCursorPosX(left);
  ImGui::PushFont(fonts().bold);
  ImGui::TextColored(palette().faint, "Recent");
  ImGui::PopFont();
  std::string opened;
  const size_t most = 5;
  for (size_t i = 0; i < std::min(most, work.settings.recent.size()); ++i) {
    const std::filesystem::path file = work.settings.recent[i];
    ImGui::SetCursorPosX(left);
    ImGui::PushID(static_cast<int>(i));
    if (ImGui::Selectable(("  " + file.filename().string()).c_str(), false, 0, {width, 0}))
      opened = file.string();
    ui::note("recent " + std::to_string(i + 1));
    ui::tooltip(file.string());
    ImGui::PopID();
  }
  if (!opened.empty()) work.open(opened);
}

/// The document of a window that crashed, to go on with or to give up.
void show_left_behind(Workspace& work, float left, float width) {
  ImGui::Dummy({0, scaled(6)});
  const std::string name = std::filesystem::path(work.left_behind()->head).filename().string();
  ImGui::SetCursorPosX(left);
  const float other = scaled(90);
  const bool goes_on = ui::button("Go on with " + name + ", where it ended last time", ui::Emphasis::plain,
                                  width - other - scaled(8));
  ImGui::SameLine(0, scaled(8));
  const bool gives_up = ui::button("Discard##left behind", ui::Emphasis::quiet, other);
  ui::tooltip("Removes what the window that crashed had saved");
  if (goes_on) work.restore();
  if (gives_up) work.forget_left_behind();
}

}  // namespace

void show_start(Workspace& work, Screen& screen, const Area& area) {
  const Palette& p = palette();
  begin_area("##start", area, p.window, {0, 0});
  ImDrawList* list = ImGui::GetWindowDrawList();
  const float top = std::max(0.5F * area.height - scaled(270), scaled(10));
  draw_sign(list, {area.x + 0.5F * area.width, area.y + top + scaled(78)}, scaled(150));
  ImGui::SetCursorPosY(top + scaled(150));
  centred("Fascia", fonts().title, p.text);
  centred("Any head, with the anatomy that moves its face", fonts().text, p.faint);
  ImGui::Dummy({0, scaled(18)});
  const float width = std::min(scaled(420), area.width - scaled(40));
  const float left = 0.5F * (area.width - width);
  const ImVec2 drop(area.x + left, area.y + ImGui::GetCursorPosY());
  const float height = scaled(118);
  list->AddRectFilled(drop, {drop.x + width, drop.y + height}, colour_of(p.panel), scaled(12));
  list->AddRect(drop, {drop.x + width, drop.y + height}, colour_of(p.line), scaled(12), 0, scaled(1.5F));
  ImGui::SetCursorPosY(ImGui::GetCursorPosY() + scaled(20));
  centred("Drop a head or a rig here", fonts().large, p.text);
  centred("GLB, glTF, VRM, OBJ, PLY or STL", fonts().small, p.faint);
  ImGui::SetCursorPosY(drop.y - area.y + height - scaled(46));
  ImGui::SetCursorPosX(left + 0.5F * width - scaled(172));
  if (ui::button("Open a file", ui::Emphasis::strong, scaled(160))) ask_to_open(work, screen);
  ImGui::SameLine(0, scaled(24));
  if (ui::button("Try the embedded head", ui::Emphasis::plain, scaled(160))) work.open_embedded_head();
  ImGui::SetCursorPosY(drop.y - area.y + height + scaled(6));
  if (work.left_behind()) show_left_behind(work, left, width);
  show_recent(work, width);
  end_area();
}

void show_build(Workspace& work, Screen& screen, const Area& area) {
  const Palette& p = palette();
  const BuildTask::Progress progress = work.build_progress();
  if (work.rig) {
    // A rebuild: small, at the top of the picture, which stays in use.
    const float width = scaled(330), height = scaled(46);
    begin_area("##rebuild", {area.x + area.width - width - scaled(14), area.y + scaled(12), width, height},
               p.panel, {scaled(12), scaled(7)});
    ImGui::PushFont(fonts().small);
    ImGui::TextUnformatted(progress.stage.c_str());
    ui::progress_bar(static_cast<float>(progress.share), width - scaled(90), scaled(5));
    ImGui::PopFont();
    ImGui::SetCursorPos({width - scaled(72), scaled(8)});
    if (ui::button("Cancel##build", ui::Emphasis::quiet)) work.cancel_build();
    end_area();
    return;
  }
  begin_area("##building", area, p.window, {0, 0});
  const float width = std::min(scaled(420), area.width - scaled(40)), left = 0.5F * (area.width - width);
  ImGui::SetCursorPosY(0.5F * area.height - scaled(90));
  centred("Building the face", fonts().large, p.text);
  centred(progress.stage.empty() ? "Beginning" : progress.stage.c_str(), fonts().text, p.faint);
  ImGui::Dummy({0, scaled(10)});
  ImGui::SetCursorPosX(left);
  ui::progress_bar(static_cast<float>(progress.share), width, scaled(8));
  char text[64];
  std::snprintf(text, sizeof text, "%.0f %%, %.1f s", 100.0 * progress.share, progress.seconds);
  centred(screen.is_scripted ? " " : text, fonts().small, p.faint);
  ImGui::Dummy({0, scaled(8)});
  ImGui::SetCursorPosX(0.5F * (area.width - scaled(120)));
  if (ui::button("Cancel##build", ui::Emphasis::plain, scaled(120))) work.cancel_build();
  end_area();
}

}  // namespace fascia::app
