#include "app/window/icons.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "app/window/theme.h"
#include "app/window/widgets.h"

namespace fascia::app {

namespace {

constexpr float pi = 3.14159265F;

/// Draws in a square from -1 to 1.
class Pen {
 public:
  Pen(ImDrawList* list, ImVec2 centre, float size, ImU32 colour)
      : list_(list),
        centre_(centre),
        half_(0.5F * size),
        colour_(colour),
        width_(std::max(1.3F, size / 13.0F)) {}

  void line(std::initializer_list<ImVec2> points, bool is_closed = false) {
    std::vector<ImVec2> placed;
    for (const ImVec2& p : points)
      placed.push_back(at(p));
    list_->AddPolyline(placed.data(), static_cast<int>(placed.size()), colour_,
                       is_closed ? ImDrawFlags_Closed : ImDrawFlags_None, width_);
  }
  void arc(ImVec2 middle, float radius, float from, float to) {
    list_->PathArcTo(at(middle), radius * half_, from, to, 24);
    list_->PathStroke(colour_, ImDrawFlags_None, width_);
  }
  void dot(ImVec2 middle, float radius) { list_->AddCircleFilled(at(middle), radius * half_, colour_, 16); }
  void fill(std::initializer_list<ImVec2> points) {
    std::vector<ImVec2> placed;
    for (const ImVec2& p : points)
      placed.push_back(at(p));
    list_->AddConvexPolyFilled(placed.data(), static_cast<int>(placed.size()), colour_);
  }
  void curve(ImVec2 a, ImVec2 b, ImVec2 c, ImVec2 d) {
    list_->AddBezierCubic(at(a), at(b), at(c), at(d), colour_, width_, 20);
  }

 private:
  ImVec2 at(ImVec2 p) const { return {centre_.x + half_ * p.x, centre_.y + half_ * p.y}; }
  ImDrawList* list_;
  ImVec2 centre_;
  float half_;
  ImU32 colour_;
  float width_;
};

}  // namespace

void draw_icon(ImDrawList* list, const std::string& name, ImVec2 centre, float size, ImU32 colour) {
  Pen pen(list, centre, size, colour);
  if (name == "pose") {
    pen.arc({0, 0}, 0.92F, 0, 2 * pi);
    pen.dot({-0.34F, -0.25F}, 0.13F);
    pen.dot({0.34F, -0.25F}, 0.13F);
    pen.arc({0, 0.08F}, 0.5F, 0.15F * pi, 0.85F * pi);
  } else if (name == "landmarks") {
    pen.arc({0, 0}, 0.5F, 0, 2 * pi);
    pen.dot({0, 0}, 0.14F);
    for (const auto& [x, y] : {std::pair(1.0F, 0.0F), {-1.0F, 0.0F}, {0.0F, 1.0F}, {0.0F, -1.0F}})
      pen.line({{0.5F * x, 0.5F * y}, {0.98F * x, 0.98F * y}});
  } else if (name == "muscles") {
    for (const float bend : {-0.75F, -0.25F, 0.25F, 0.75F})
      pen.curve({-0.9F, 0.7F}, {-0.4F, -0.2F + 0.6F * bend}, {0.3F, -0.4F + 0.9F * bend}, {0.9F, -0.7F});
    pen.dot({-0.9F, 0.7F}, 0.15F);
    pen.dot({0.9F, -0.7F}, 0.15F);
  } else if (name == "warnings") {
    pen.line({{0, -0.85F}, {0.95F, 0.8F}, {-0.95F, 0.8F}}, true);
    pen.line({{0, -0.25F}, {0, 0.28F}});
    pen.dot({0, 0.53F}, 0.1F);
  } else if (name == "compare") {
    pen.arc({0, 0}, 0.9F, 0, 2 * pi);
    pen.line({{0, -0.9F}, {0, 0.9F}});
    for (const float y : {-0.5F, -0.1F, 0.3F, 0.65F})
      pen.line({{0, y}, {std::sqrt(0.81F - y * y), y}});
  } else if (name == "live") {
    pen.dot({0, 0}, 0.18F);
    for (const float radius : {0.5F, 0.9F}) {
      pen.arc({0, 0}, radius, -0.3F * pi, 0.3F * pi);
      pen.arc({0, 0}, radius, 0.7F * pi, 1.3F * pi);
    }
  } else if (name == "export") {
    pen.line({{-0.85F, 0.2F}, {-0.85F, 0.85F}, {0.85F, 0.85F}, {0.85F, 0.2F}});
    pen.line({{0, 0.4F}, {0, -0.85F}});
    pen.line({{-0.4F, -0.45F}, {0, -0.87F}, {0.4F, -0.45F}});
  } else if (name == "play") {
    pen.fill({{-0.5F, -0.75F}, {0.8F, 0.0F}, {-0.5F, 0.75F}});
  } else if (name == "pause") {
    pen.fill({{-0.6F, -0.7F}, {-0.15F, -0.7F}, {-0.15F, 0.7F}, {-0.6F, 0.7F}});
    pen.fill({{0.15F, -0.7F}, {0.6F, -0.7F}, {0.6F, 0.7F}, {0.15F, 0.7F}});
  } else if (name == "loop") {
    pen.arc({0, 0}, 0.7F, -0.35F * pi, 1.3F * pi);
    pen.fill({{0.3F, -1.0F}, {0.75F, -0.5F}, {0.05F, -0.4F}});
  } else if (name == "record") {
    pen.dot({0, 0}, 0.62F);
  } else if (name == "undo" || name == "redo") {
    const float s = name == "undo" ? 1.0F : -1.0F;
    pen.line({{-0.35F * s, -0.8F}, {-0.85F * s, -0.35F}, {-0.35F * s, 0.1F}});
    pen.curve({-0.85F * s, -0.35F}, {0.5F * s, -0.5F}, {1.0F * s, 0.1F}, {0.35F * s, 0.75F});
  }
}

bool icon_button(const std::string& name, const std::string& icon, const std::string& help, bool is_on,
                 bool is_enabled) {
  const Palette& p = palette();
  const float size = ImGui::GetFrameHeight();
  const ImVec2 at = ImGui::GetCursorScreenPos();
  const bool is_pressed = ImGui::InvisibleButton(name.c_str(), {size, size}) && is_enabled;
  ui::note(name);
  ImDrawList* list = ImGui::GetWindowDrawList();
  if (is_on || (is_enabled && ImGui::IsItemHovered()))
    list->AddRectFilled(at, {at.x + size, at.y + size}, colour_of(is_on ? p.raised : p.hover), scaled(6));
  draw_icon(list, icon, {at.x + 0.5F * size, at.y + 0.5F * size}, 0.5F * size,
            colour_of(is_on ? p.accent : p.text, is_enabled ? 1.0F : 0.35F));
  ui::tooltip(help);
  return is_pressed;
}

}  // namespace fascia::app
