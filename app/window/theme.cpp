#include "app/window/theme.h"

#include <array>
#include <filesystem>
#include <initializer_list>
#include <string>

namespace fascia::app {

namespace {

Palette chosen;
Fonts loaded;
float scale_in_use = 1.0F;

ImVec4 rgb(int hex, float opacity = 1.0F) {
  return {static_cast<float>(hex >> 16 & 255) / 255.0F, static_cast<float>(hex >> 8 & 255) / 255.0F,
          static_cast<float>(hex & 255) / 255.0F, opacity};
}

Palette dark() {
  Palette p;
  p.window = rgb(0x17181B);
  p.panel = rgb(0x1F2125);
  p.raised = rgb(0x2A2D32);
  p.hover = rgb(0x363A41);
  p.line = rgb(0x34373D);
  p.text = rgb(0xECE9E4);
  p.faint = rgb(0x9C9EA3);
  p.accent = rgb(0xE2694F);
  p.accent_text = rgb(0xFFFFFF);
  p.left = rgb(0x5BB8B0);
  p.right = rgb(0xE6AE5C);
  p.good = rgb(0x7FBF7F);
  p.warning = rgb(0xE6AE5C);
  p.bad = rgb(0xEB6A63);
  p.viewport = rgb(0x2A2D33);
  return p;
}

Palette light() {
  Palette p;
  p.window = rgb(0xE6E3DE);
  p.panel = rgb(0xF6F4F1);
  p.raised = rgb(0xE8E4DE);
  p.hover = rgb(0xDBD6CE);
  p.line = rgb(0xD3CEC6);
  p.text = rgb(0x26272A);
  p.faint = rgb(0x6B6C70);
  p.accent = rgb(0xCF4F35);
  p.accent_text = rgb(0xFFFFFF);
  p.left = rgb(0x1F8F86);
  p.right = rgb(0xB9761B);
  p.good = rgb(0x3F8F46);
  p.warning = rgb(0xB9761B);
  p.bad = rgb(0xC63A36);
  p.viewport = rgb(0xC9C6C0);
  return p;
}

ImFont* font_from(std::initializer_list<const char*> files, float size) {
  // Latin, and the punctuation that the panels use.
  static const ImWchar ranges[] = {0x0020, 0x017F, 0x2010, 0x2027, 0x2190, 0x21FF, 0x00B0, 0x00B7, 0};
  for (const char* file : files) {
    std::error_code status;
    if (!std::filesystem::is_regular_file(file, status)) continue;
    ImFontConfig config;
    config.OversampleH = 2;
    config.OversampleV = 2;
    if (ImFont* font = ImGui::GetIO().Fonts->AddFontFromFileTTF(file, size, &config, ranges)) return font;
  }
  ImFontConfig config;
  config.SizePixels = size;
  return ImGui::GetIO().Fonts->AddFontDefault(&config);
}

void load_fonts(float scale) {
  ImGui::GetIO().Fonts->Clear();
  const auto regular = {"/usr/share/fonts/truetype/lato/Lato-Medium.ttf",
                        "/usr/share/fonts/truetype/lato/Lato-Regular.ttf",
                        "/usr/share/fonts/truetype/dejavu/DejaVuSans.ttf"};
  const auto bold = {"/usr/share/fonts/truetype/lato/Lato-Bold.ttf",
                     "/usr/share/fonts/truetype/dejavu/DejaVuSans-Bold.ttf"};
  const auto title = {"/usr/share/fonts/truetype/lato/Lato-Black.ttf",
                      "/usr/share/fonts/truetype/dejavu/DejaVuSans-Bold.ttf"};
  loaded.text = font_from(regular, 15.0F * scale);
  loaded.bold = font_from(bold, 15.0F * scale);
  loaded.small = font_from(regular, 12.5F * scale);
  loaded.large = font_from(bold, 20.0F * scale);
  loaded.title = font_from(title, 44.0F * scale);
  ImGui::GetIO().FontDefault = loaded.text;
}

void set_colours(const Palette& p) {
  ImVec4* c = ImGui::GetStyle().Colors;
  const ImVec4 none(0, 0, 0, 0);
  const std::array<std::pair<ImGuiCol, ImVec4>, 36> pairs = {{
      {ImGuiCol_Text, p.text},
      {ImGuiCol_TextDisabled, p.faint},
      {ImGuiCol_WindowBg, p.panel},
      {ImGuiCol_ChildBg, none},
      {ImGuiCol_PopupBg, p.panel},
      {ImGuiCol_Border, p.line},
      {ImGuiCol_FrameBg, p.raised},
      {ImGuiCol_FrameBgHovered, p.hover},
      {ImGuiCol_FrameBgActive, p.hover},
      {ImGuiCol_TitleBg, p.panel},
      {ImGuiCol_TitleBgActive, p.panel},
      {ImGuiCol_ScrollbarBg, none},
      {ImGuiCol_ScrollbarGrab, p.hover},
      {ImGuiCol_ScrollbarGrabHovered, p.faint},
      {ImGuiCol_ScrollbarGrabActive, p.faint},
      {ImGuiCol_CheckMark, p.accent},
      {ImGuiCol_SliderGrab, p.text},
      {ImGuiCol_SliderGrabActive, p.text},
      {ImGuiCol_Button, p.raised},
      {ImGuiCol_ButtonHovered, p.hover},
      {ImGuiCol_ButtonActive, p.accent},
      {ImGuiCol_Header, p.raised},
      {ImGuiCol_HeaderHovered, p.hover},
      {ImGuiCol_HeaderActive, p.hover},
      {ImGuiCol_Separator, p.line},
      {ImGuiCol_SeparatorHovered, p.accent},
      {ImGuiCol_SeparatorActive, p.accent},
      {ImGuiCol_ResizeGrip, none},
      {ImGuiCol_Tab, p.raised},
      {ImGuiCol_TabHovered, p.hover},
      {ImGuiCol_TabActive, p.accent},
      {ImGuiCol_TextSelectedBg, ImVec4(p.accent.x, p.accent.y, p.accent.z, 0.35F)},
      {ImGuiCol_NavHighlight, p.accent},
      {ImGuiCol_PlotHistogram, p.accent},
      {ImGuiCol_ModalWindowDimBg, ImVec4(0, 0, 0, 0.5F)},
      {ImGuiCol_BorderShadow, none},
  }};
  for (const auto& [slot, colour] : pairs)
    c[slot] = colour;
}

}  // namespace

const Palette& palette() {
  return chosen;
}

const Fonts& fonts() {
  return loaded;
}

float ui_scale() {
  return scale_in_use;
}

ImU32 colour_of(const ImVec4& colour, float opacity) {
  return ImGui::GetColorU32(ImVec4(colour.x, colour.y, colour.z, colour.w * opacity));
}

void apply_theme(bool is_light, float scale) {
  const bool has_fonts = loaded.text != nullptr && scale == scale_in_use;
  scale_in_use = scale;
  chosen = is_light ? light() : dark();
  ImGuiStyle style;
  style.WindowPadding = {14, 12};
  style.FramePadding = {10, 6};
  style.ItemSpacing = {8, 7};
  style.ItemInnerSpacing = {6, 4};
  style.ScrollbarSize = 10;
  style.WindowBorderSize = 0;
  style.ChildBorderSize = 0;
  style.PopupBorderSize = 1;
  style.FrameBorderSize = 0;
  style.WindowRounding = 0;
  style.ChildRounding = 8;
  style.FrameRounding = 6;
  style.PopupRounding = 10;
  style.ScrollbarRounding = 6;
  style.GrabRounding = 5;
  style.GrabMinSize = 10;
  style.WindowMinSize = {4, 4};
  style.ScaleAllSizes(scale);
  ImGui::GetStyle() = style;
  set_colours(chosen);
  if (!has_fonts) load_fonts(scale);
}

}  // namespace fascia::app
