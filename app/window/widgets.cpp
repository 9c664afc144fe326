#include "app/window/widgets.h"

#include <imgui_internal.h>
#include <imgui_stdlib.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "app/window/theme.h"

namespace fascia::app::ui {

namespace {

std::map<std::string, ImVec4> noted, noting;

std::string shown(const std::string& name) {
  return name.substr(0, name.find("##"));
}

}  // namespace

const std::map<std::string, ImVec4>& items() {
  return noted;
}

void begin_items() {
  noted = std::exchange(noting, {});
}

void note(const std::string& name) {
  const ImVec2 a = ImGui::GetItemRectMin(), b = ImGui::GetItemRectMax();
  if (ImGui::IsItemVisible()) noting[name] = {a.x, a.y, b.x, b.y};
}

bool button(const std::string& name, Emphasis emphasis, float width) {
  const Palette& p = palette();
  const ImVec4 none(0, 0, 0, 0);
  int colours = 0;
  if (emphasis == Emphasis::strong) {
    ImGui::PushStyleColor(ImGuiCol_Button, p.accent);
    ImGui::PushStyleColor(ImGuiCol_ButtonHovered, ImVec4(p.accent.x, p.accent.y, p.accent.z, 0.85F));
    ImGui::PushStyleColor(ImGuiCol_Text, p.accent_text);
    colours = 3;
  } else if (emphasis == Emphasis::quiet) {
    ImGui::PushStyleColor(ImGuiCol_Button, none);
    colours = 1;
  }
  const bool is_pressed = ImGui::Button(name.c_str(), ImVec2(width, 0.0F));
  ImGui::PopStyleColor(colours);
  note(name);
  return is_pressed;
}

bool chip(const std::string& name, bool& is_on) {
  const Palette& p = palette();
  const std::string text = shown(name);
  const ImVec2 size = ImGui::CalcTextSize(text.c_str());
  const ImVec2 box(size.x + scaled(22), size.y + scaled(10));
  const ImVec2 at = ImGui::GetCursorScreenPos();
  const bool is_pressed = ImGui::InvisibleButton(name.c_str(), box);
  note(name);
  if (is_pressed) is_on = !is_on;
  ImDrawList* list = ImGui::GetWindowDrawList();
  const ImVec4 fill = is_on ? p.accent : ImGui::IsItemHovered() ? p.hover : p.raised;
  list->AddRectFilled(at, {at.x + box.x, at.y + box.y}, colour_of(fill, is_on ? 1.0F : 0.92F), 0.5F * box.y);
  list->AddText({at.x + scaled(11), at.y + scaled(5)}, colour_of(is_on ? p.accent_text : p.text),
                text.c_str());
  return is_pressed;
}

bool choice(const char* kind, const char* const* names, int count, int& chosen, float width) {
  const Palette& p = palette();
  const ImVec2 at = ImGui::GetCursorScreenPos();
  const float height = ImGui::GetFrameHeight();
  ImDrawList* list = ImGui::GetWindowDrawList();
  list->AddRectFilled(at, {at.x + width, at.y + height}, colour_of(p.raised), scaled(6));
  bool has_changed = false;
  float total = 0.0F;
  for (int i = 0; i < count; ++i)
    total += ImGui::CalcTextSize(names[i]).x;
  const float room = std::max((width - total) / static_cast<float>(count), 2.0F);
  float x = at.x;
  for (int i = 0; i < count; ++i) {
    const ImVec2 text = ImGui::CalcTextSize(names[i]);
    const float cell = text.x + room;
    ImGui::SetCursorScreenPos({x, at.y});
    if (ImGui::InvisibleButton(names[i], {cell, height}) && chosen != i) {
      chosen = i;
      has_changed = true;
    }
    note(std::string(kind) + " " + names[i]);
    if (chosen == i)
      list->AddRectFilled({x + 2, at.y + 2}, {x + cell - 2, at.y + height - 2}, colour_of(p.accent),
                          scaled(5));
    else if (ImGui::IsItemHovered())
      list->AddRectFilled({x + 2, at.y + 2}, {x + cell - 2, at.y + height - 2}, colour_of(p.hover),
                          scaled(5));
    list->AddText({x + 0.5F * room, at.y + 0.5F * (height - text.y)},
                  colour_of(chosen == i ? p.accent_text : p.text), names[i]);
    x += cell;
  }
  ImGui::SetCursorScreenPos(at);
  ImGui::Dummy({width, height});
  return has_changed;
}

bool check(const std::string& name, bool& is_on) {
  ImGui::PushStyleVar(ImGuiStyleVar_FramePadding, ImVec2(scaled(3), scaled(3)));
  const bool has_changed = ImGui::Checkbox(name.c_str(), &is_on);
  ImGui::PopStyleVar();
  note(name);
  return has_changed;
}

bool slider(const std::string& name, float& value, const SliderLook& look, float width, bool& has_ended) {
  const Palette& p = palette();
  const float height = scaled(20), tag_width = *look.tag ? scaled(16) : 0.0F, number = scaled(40);
  const ImVec2 at = ImGui::GetCursorScreenPos();
  const float track = std::max(width - tag_width - number, scaled(30));
  const float begin = at.x + tag_width, middle = at.y + 0.5F * height;
  ImDrawList* list = ImGui::GetWindowDrawList();
  // Dear ImGui's own slider lies invisibly over ours: it knows keys, typing and fine movement.
  ImGui::SetCursorScreenPos({begin, at.y});
  ImGui::SetNextItemWidth(track);
  const std::string id = "##" + name;
  const bool is_typing = ImGui::TempInputIsActive(ImGui::GetID(id.c_str()));
  const ImVec4 none(0, 0, 0, 0);
  if (!is_typing)
    for (const ImGuiCol slot : {ImGuiCol_FrameBg, ImGuiCol_FrameBgHovered, ImGuiCol_FrameBgActive,
                                ImGuiCol_SliderGrab, ImGuiCol_SliderGrabActive, ImGuiCol_Text})
      ImGui::PushStyleColor(slot, none);
  ImGui::PushStyleVar(ImGuiStyleVar_FramePadding, ImVec2(0, 0.5F * (height - ImGui::GetFontSize())));
  bool has_changed = ImGui::SliderFloat(id.c_str(), &value, look.minimum, look.maximum, look.format,
                                        ImGuiSliderFlags_AlwaysClamp);
  ImGui::PopStyleVar();
  if (!is_typing) ImGui::PopStyleColor(6);
  note(name);
  has_ended = ImGui::IsItemDeactivatedAfterEdit();
  const bool is_hot = ImGui::IsItemHovered() || ImGui::IsItemActive();
  if (ImGui::IsItemHovered() && ImGui::IsMouseDoubleClicked(0)) {
    value = look.rest;
    has_changed = has_ended = true;
  }
  if (!is_typing) {
    const float span = std::max(look.maximum - look.minimum, 1e-6F), knob = scaled(is_hot ? 6.5F : 5.5F);
    const auto place = [&](float v) {
      return begin + knob + (track - 2.0F * knob) * std::clamp((v - look.minimum) / span, 0.0F, 1.0F);
    };
    const float thick = scaled(2), x = place(value), rest = place(look.rest);
    list->AddRectFilled({begin, middle - thick}, {begin + track, middle + thick},
                        colour_of(is_hot ? p.hover : p.raised), thick);
    if (look.rest > look.minimum)
      list->AddRectFilled({rest - scaled(1), middle - scaled(4)}, {rest + scaled(1), middle + scaled(4)},
                          colour_of(p.hover));
    const bool is_set = std::abs(value - look.rest) > 1e-4F;
    if (is_set)
      list->AddRectFilled({std::min(look.rest > look.minimum ? rest : begin, x), middle - thick},
                          {std::max(rest, x), middle + thick}, colour_of(look.tint), thick);
    list->AddCircleFilled({x, middle}, knob, colour_of(is_set ? look.tint : is_hot ? p.text : p.faint), 20);
  }
  char text[32];
  std::snprintf(text, sizeof text, look.format, static_cast<double>(value));
  ImGui::PushFont(fonts().small);
  const float text_y = middle - 0.5F * ImGui::GetFontSize();
  if (*look.tag) list->AddText({at.x, text_y}, colour_of(look.tint), look.tag);
  list->AddText({at.x + width - ImGui::CalcTextSize(text).x, text_y}, colour_of(p.faint), text);
  ImGui::PopFont();
  ImGui::SetCursorScreenPos(at);
  ImGui::Dummy({width, height});
  return has_changed;
}

void heading(const char* text) {
  ImGui::Dummy({0, scaled(4)});
  ImGui::PushFont(fonts().bold);
  ImGui::TextUnformatted(text);
  ImGui::PopFont();
}

void hint(const std::string& text) {
  ImGui::PushStyleColor(ImGuiCol_Text, palette().faint);
  ImGui::PushTextWrapPos(0.0F);
  ImGui::TextUnformatted(text.c_str());
  ImGui::PopTextWrapPos();
  ImGui::PopStyleColor();
}

bool star(const std::string& name, bool is_on) {
  const float size = ImGui::GetFontSize();
  const ImVec2 at = ImGui::GetCursorScreenPos();
  const bool is_pressed = ImGui::InvisibleButton(name.c_str(), {size, size});
  note(name);
  ImVec2 points[10];
  for (int i = 0; i < 10; ++i) {
    const float angle = 0.6283185F * static_cast<float>(i) - 1.5707963F,
                radius = (i % 2 ? 0.2F : 0.46F) * size;
    points[i] = {at.x + 0.5F * size + radius * std::cos(angle),
                 at.y + 0.5F * size + radius * std::sin(angle)};
  }
  ImDrawList* list = ImGui::GetWindowDrawList();
  const ImU32 colour = colour_of(is_on ? palette().warning : palette().faint, is_on ? 1.0F : 0.6F);
  if (is_on) {
    // A star is not convex: five tips and the middle.
    for (int i = 0; i < 10; i += 2)
      list->AddTriangleFilled(points[i], points[(i + 1) % 10], points[(i + 9) % 10], colour);
    const ImVec2 middle[5] = {points[1], points[3], points[5], points[7], points[9]};
    list->AddConvexPolyFilled(middle, 5, colour);
  } else {
    list->AddPolyline(points, 10, colour, ImDrawFlags_Closed, 1.0F);
  }
  return is_pressed;
}

bool search(const char* hint_text, std::string& text, float width) {
  ImGui::SetNextItemWidth(width);
  const bool has_changed =
      ImGui::InputTextWithHint((std::string("##") + hint_text).c_str(), hint_text, &text);
  note(hint_text);
  return has_changed;
}

void progress_bar(float share, float width, float height) {
  const ImVec2 at = ImGui::GetCursorScreenPos();
  ImDrawList* list = ImGui::GetWindowDrawList();
  list->AddRectFilled(at, {at.x + width, at.y + height}, colour_of(palette().hover), 0.5F * height);
  list->AddRectFilled(at, {at.x + std::max(width * std::clamp(share, 0.0F, 1.0F), height), at.y + height},
                      colour_of(palette().accent), 0.5F * height);
  ImGui::Dummy({width, height});
}

std::string shortened(const std::string& text, float width) {
  if (ImGui::CalcTextSize(text.c_str()).x <= width) return text;
  std::string cut = text;
  while (!cut.empty() && ImGui::CalcTextSize((cut + "...").c_str()).x > width)
    cut.pop_back();
  // No half of a letter of several bytes.
  while (!cut.empty() && (static_cast<unsigned char>(cut.back()) & 0xC0) == 0x80)
    cut.pop_back();
  return cut + "...";
}

void tooltip(const std::string& text) {
  if (!ImGui::IsItemHovered()) return;
  ImGui::BeginTooltip();
  ImGui::PushTextWrapPos(scaled(320));
  ImGui::TextUnformatted(text.c_str());
  ImGui::PopTextWrapPos();
  ImGui::EndTooltip();
}

}  // namespace fascia::app::ui
