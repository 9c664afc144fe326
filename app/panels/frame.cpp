// The bars around the picture: top, rail, status, notices, keys.
#include <algorithm>
#include <array>

#include "app/model/names.h"
#include "app/panels/screen.h"
#include "app/window/icons.h"
#include "app/window/theme.h"
#include "app/window/widgets.h"

namespace fascia::app {

namespace {

struct PanelEntry {
  const char *name, *title;
};
constexpr std::array<PanelEntry, 7> panels = {{{"pose", "Pose"},
                                               {"landmarks", "Landmarks"},
                                               {"muscles", "Muscles"},
                                               {"warnings", "Warnings"},
                                               {"compare", "Compare"},
                                               {"live", "Live"},
                                               {"export", "Export"}}};

}  // namespace

const std::vector<std::string>& mesh_endings() {
  static const std::vector<std::string> endings = {".glb", ".gltf", ".obj", ".ply", ".stl", ".vrm"};
  return endings;
}

void begin_area(const char* name, const Area& area, const ImVec4& background, ImVec2 padding, Scroll scroll) {
  const ImGuiWindowFlags still = ImGuiWindowFlags_NoScrollbar | ImGuiWindowFlags_NoScrollWithMouse;
  ImGui::SetNextWindowPos({area.x, area.y});
  ImGui::SetNextWindowSize({std::max(area.width, 1.0F), std::max(area.height, 1.0F)});
  ImGui::PushStyleColor(ImGuiCol_WindowBg, background);
  ImGui::PushStyleVar(ImGuiStyleVar_WindowPadding, padding);
  ImGui::Begin(name, nullptr,
               ImGuiWindowFlags_NoTitleBar | ImGuiWindowFlags_NoResize | ImGuiWindowFlags_NoMove |
                   (scroll == Scroll::no ? still : ImGuiWindowFlags_None) | ImGuiWindowFlags_NoSavedSettings |
                   ImGuiWindowFlags_NoBringToFrontOnFocus);
}

void end_area() {
  ImGui::End();
  ImGui::PopStyleVar();
  ImGui::PopStyleColor();
}

float list_height(float foot) {
  return std::max(ImGui::GetContentRegionAvail().y - foot, scaled(150));
}

void ask_to_open(Workspace& work, Screen& screen) {
  screen.browser.ask_to_open("Open a head or a rig", mesh_endings(),
                             [&work](const std::filesystem::path& file) { work.open(file); });
}

void ask_for_take(Workspace& work, Screen& screen) {
  screen.browser.ask_to_open("Load a recording", {".csv", ".json", ".glb", ".txt", ".tsv"},
                             [&work](const std::filesystem::path& file) { work.load_take(file); });
}

void ask_for_layer(Workspace& work, Screen& screen) {
  screen.browser.ask_to_open("Add a recording", {".csv", ".json", ".glb", ".txt", ".tsv"},
                             [&work](const std::filesystem::path& file) { work.load_layer(file); });
}

void ask_to_save_rig(Workspace& work, Screen& screen) {
  const std::string stem = std::filesystem::path(work.state().head).stem().string();
  screen.browser.ask_to_save("Save the rig", stem + "_rig.glb", {".glb"},
                             [&work](const std::filesystem::path& file) { work.save_rig(file); });
}

void show_top_bar(Workspace& work, Screen& screen, const Area& area) {
  const Palette& p = palette();
  begin_area("##top", area, p.panel, {scaled(14), scaled(7)});
  ImGui::PushFont(fonts().large);
  ImGui::SetCursorPosY(0.5F * (area.height - ImGui::GetFontSize()));
  ImGui::TextColored(p.accent, "Fascia");
  ImGui::PopFont();
  ImGui::SameLine(0, scaled(18));
  ImGui::SetCursorPosY(0.5F * (area.height - ImGui::GetFrameHeight()));
  if (ui::button("Open")) ask_to_open(work, screen);
  ui::tooltip("Open a head mesh or a rig (Ctrl+O)");
  if (work.rig) {
    ImGui::SameLine();
    if (ui::button("Save rig")) ask_to_save_rig(work, screen);
    ui::tooltip("Save the rig as a .glb file (Ctrl+S)");
    ImGui::SameLine(0, scaled(14));
    const auto& history = work.history();
    if (icon_button("Undo", "undo", history.can_undo() ? "Undo: " + history.undo_label() : "Nothing to undo",
                    false, history.can_undo()))
      work.undo();
    ImGui::SameLine(0, scaled(2));
    if (icon_button("Redo", "redo", history.can_redo() ? "Redo: " + history.redo_label() : "Nothing to redo",
                    false, history.can_redo()))
      work.redo();
    const std::string name = std::filesystem::path(work.state().head).filename().string() +
                             (work.has_unbuilt_edits() ? "  (edited)" : "");
    const float middle = 0.5F * (area.width - ImGui::CalcTextSize(name.c_str()).x);
    ImGui::SameLine(std::max(middle, ImGui::GetCursorPosX() + scaled(330)));
    ImGui::AlignTextToFramePadding();
    ImGui::TextColored(p.faint, "%s", ui::shortened(name, 0.4F * area.width).c_str());
  }
  ImGui::SameLine(area.width - scaled(128));
  if (ui::button(work.settings.is_light ? "Dark##theme" : "Light##theme", ui::Emphasis::quiet, scaled(62))) {
    work.settings.is_light = !work.settings.is_light;
    screen.wants_theme = true;
  }
  ImGui::SameLine(0, scaled(4));
  if (ui::button("Help", ui::Emphasis::quiet)) screen.shows_help = true;
  end_area();
}

void show_rail(Workspace& work, Screen& screen, const Area& area) {
  const Palette& p = palette();
  ImGui::PushStyleVar(ImGuiStyleVar_ItemSpacing, {0, scaled(6)});
  begin_area("##rail", area, p.window, {0, scaled(8)}, Scroll::down);
  ImDrawList* list = ImGui::GetWindowDrawList();
  // In a low window the entries stand closer, at last without their names; lower still, they scroll.
  const float all = area.height - scaled(16), entries = static_cast<float>(panels.size());
  const float cell = std::clamp((all - scaled(6) * (entries - 1.0F)) / entries, scaled(32), scaled(62));
  const bool has_names = cell > scaled(52);
  const float icon = has_names ? scaled(24) * cell / scaled(62) : 0.5F * cell;
  for (const PanelEntry& panel : panels) {
    const ImVec2 at = ImGui::GetCursorScreenPos();
    const bool is_chosen = work.settings.panel == panel.name;
    if (ImGui::InvisibleButton(panel.name, {area.width, cell})) work.settings.panel = panel.name;
    ui::note(panel.title);
    const bool is_hot = ImGui::IsItemHovered();
    if (is_chosen || is_hot)
      list->AddRectFilled({at.x + scaled(6), at.y + scaled(3)},
                          {at.x + area.width - scaled(6), at.y + cell - scaled(3)},
                          colour_of(is_chosen ? p.raised : p.panel), scaled(9));
    const ImU32 colour = colour_of(is_chosen ? p.accent : is_hot ? p.text : p.faint);
    draw_icon(list, panel.name, {at.x + 0.5F * area.width, at.y + icon}, scaled(21), colour);
    ImGui::PushFont(fonts().small);
    const float width = ImGui::CalcTextSize(panel.title).x;
    if (has_names)
      list->AddText({at.x + 0.5F * (area.width - width), at.y + cell - scaled(22)},
                    colour_of(is_chosen ? p.text : p.faint), panel.title);
    else
      ui::tooltip(panel.title);
    if (panel.name == std::string("warnings") && !work.warnings.empty()) {
      const std::string count = std::to_string(work.warnings.size());
      const ImVec2 middle(at.x + 0.5F * area.width + scaled(15), at.y + scaled(15));
      list->AddCircleFilled(middle, scaled(9), colour_of(p.warning));
      list->AddText(
          {middle.x - 0.5F * ImGui::CalcTextSize(count.c_str()).x, middle.y - 0.5F * ImGui::GetFontSize()},
          IM_COL32(30, 26, 20, 255), count.c_str());
    }
    if (panel.name == std::string("live") && work.live)
      list->AddCircleFilled({at.x + 0.5F * area.width + scaled(15), at.y + scaled(14)}, scaled(4),
                            colour_of(p.good));
    ImGui::PopFont();
  }
  (void)screen;
  end_area();
  ImGui::PopStyleVar();
}

void show_side_panel(Workspace& work, Screen& screen, const Area& area) {
  const Palette& p = palette();
  begin_area("##panel", area, p.panel, {scaled(16), scaled(14)}, Scroll::down);
  for (const PanelEntry& panel : panels)
    if (work.settings.panel == panel.name) {
      ImGui::PushFont(fonts().large);
      ImGui::TextUnformatted(panel.title);
      ImGui::PopFont();
    }
  const std::string& panel = work.settings.panel;
  if (panel == "landmarks")
    show_landmark_panel(work, screen);
  else if (panel == "muscles")
    show_muscle_panel(work, screen);
  else if (panel == "warnings")
    show_warning_panel(work, screen);
  else if (panel == "compare")
    show_compare_panel(work, screen);
  else if (panel == "live")
    show_live_panel(work, screen);
  else if (panel == "export")
    show_export_panel(work, screen);
  else
    show_pose_panel(work, screen);
  end_area();
}

void show_status(Workspace& work, Screen& screen, const Area& area) {
  const Palette& p = palette();
  begin_area("##status", area, p.window, {scaled(12), scaled(3)});
  ImGui::PushFont(fonts().small);
  char figures[96];
  std::snprintf(figures, sizeof figures, "simulation %.1f ms    picture %.0f ms",
                work.frame ? work.frame->step_milliseconds : 0.0,
                screen.picture.milliseconds(screen.drawn_care));
  const float right = ImGui::CalcTextSize(figures).x + scaled(24);
  const std::string command = work.present_command().text;
  ImGui::PushStyleVar(ImGuiStyleVar_FramePadding, ImVec2(scaled(8), scaled(1)));
  if (ui::button("Copy command"))
    if (const std::string text = work.copy_command(); !text.empty()) ImGui::SetClipboardText(text.c_str());
  ImGui::PopStyleVar();
  ui::tooltip("The command that does the same in a terminal");
  ImGui::SameLine();
  ImGui::TextColored(p.faint, "%s",
                     ui::shortened(command, area.width - right - ImGui::GetCursorPosX() - scaled(8)).c_str());
  if (!screen.is_scripted) {
    ImGui::SameLine(area.width - right + scaled(12));
    ImGui::TextColored(p.faint, "%s", figures);
  }
  ImGui::PopFont();
  end_area();
}

void show_notices(Workspace& work, const Area& area) {
  const Palette& p = palette();
  ImDrawList* list = ImGui::GetForegroundDrawList();
  float y = area.y + area.height - scaled(104);
  for (auto notice = work.notices.rbegin(); notice != work.notices.rend(); ++notice) {
    const float wrap = std::min(scaled(460), area.width - scaled(60));
    const ImVec2 size = ImGui::CalcTextSize(notice->text.c_str(), nullptr, false, wrap);
    const ImVec2 box(size.x + scaled(36), size.y + scaled(18));
    const ImVec2 at(area.x + area.width - box.x - scaled(14), y - box.y);
    const auto fade = static_cast<float>(std::clamp(5.0 * notice->age + 0.2, 0.0, 1.0));
    const ImVec4 side = notice->kind == Notice::Kind::error     ? p.bad
                        : notice->kind == Notice::Kind::warning ? p.warning
                                                                : p.good;
    list->AddRectFilled(at, {at.x + box.x, at.y + box.y}, colour_of(p.panel, 0.96F * fade), scaled(8));
    list->AddRect(at, {at.x + box.x, at.y + box.y}, colour_of(p.line, fade), scaled(8));
    list->AddRectFilled({at.x + scaled(9), at.y + scaled(9)}, {at.x + scaled(12), at.y + box.y - scaled(9)},
                        colour_of(side, fade), scaled(2));
    list->AddText(ImGui::GetFont(), ImGui::GetFontSize(), {at.x + scaled(22), at.y + scaled(9)},
                  colour_of(p.text, fade), notice->text.c_str(), nullptr, wrap);
    y -= box.y + scaled(8);
  }
}

const std::vector<KeyHelp>& keyboard_map() {
  static const std::vector<KeyHelp> keys = {
      {"Ctrl+O", "open a head or a rig"},
      {"Ctrl+S", "save the rig"},
      {"Ctrl+Z / Ctrl+Shift+Z", "undo / redo"},
      {"Space", "play, pause"},
      {"Home / End", "to the begin / end of the piece"},
      {"Left / Right", "a frame back / on"},
      {"1 2 3 4 5", "view from front, left, right, three-quarter, below"},
      {"F", "the whole face"},
      {"V / P", "turn / pull with the mouse"},
      {"Shift + drag", "the other of the two"},
      {"right drag, wheel", "shift, come nearer"},
      {"double click", "come nearer to a place; on a slider: back to rest"},
      {"Ctrl + click a slider", "type its value"},
      {"S M K L", "skin, muscles, skull, landmarks"},
      {"N", "neutral face"},
      {"R", "build again now"},
      {"X", "symmetric editing"},
      {"F1", "this page"},
  };
  return keys;
}

void show_help(Screen& screen) {
  if (screen.shows_help) ImGui::OpenPopup("##help");
  const ImVec2 window = ImGui::GetIO().DisplaySize;
  ImGui::SetNextWindowPos({0.5F * window.x, 0.5F * window.y}, ImGuiCond_Always, {0.5F, 0.5F});
  if (!ImGui::BeginPopupModal(
          "##help", nullptr,
          ImGuiWindowFlags_NoTitleBar | ImGuiWindowFlags_NoResize | ImGuiWindowFlags_AlwaysAutoResize))
    return;
  ImGui::PushFont(fonts().large);
  ImGui::TextUnformatted("Keys and mouse");
  ImGui::PopFont();
  ImGui::Dummy({0, scaled(4)});
  for (const KeyHelp& key : keyboard_map()) {
    ImGui::TextColored(palette().accent, "%s", key.key);
    ImGui::SameLine(scaled(200));
    ImGui::TextUnformatted(key.what);
  }
  ImGui::Dummy({0, scaled(6)});
  if (ui::button("Close", ui::Emphasis::strong, scaled(120)) ||
      ImGui::IsKeyPressed(ImGui::GetKeyIndex(ImGuiKey_Escape))) {
    screen.shows_help = false;
    ImGui::CloseCurrentPopup();
  }
  ImGui::EndPopup();
}

}  // namespace fascia::app
