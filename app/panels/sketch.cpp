// Regions of the picked muscle, drawn on the skin with the mouse.
#include <algorithm>
#include <cmath>

#define GLFW_INCLUDE_NONE  // epoxy has OpenGL
#include <GLFW/glfw3.h>

#include "app/model/names.h"
#include "app/panels/screen.h"
#include "app/window/theme.h"
#include "app/window/widgets.h"

namespace fascia::app {

namespace {

constexpr MuscleEnd muscle_ends[] = {MuscleEnd::origin, MuscleEnd::insertion};

ImU32 end_colour(MuscleEnd end, float opacity) {
  const int alpha = static_cast<int>(255.0F * opacity);
  return end == MuscleEnd::origin ? IM_COL32(96, 196, 255, alpha) : IM_COL32(255, 170, 72, alpha);
}

/// A line on the skin as it is seen: faint where it is on the far side.
void draw_line(const Workspace& work, const Area& area, const std::vector<SkinHit>& points, MuscleEnd end,
               bool is_closed) {
  ImDrawList* list = ImGui::GetWindowDrawList();
  const size_t count = points.size();
  for (size_t i = 0; i + (is_closed ? 0 : 1) < count; ++i) {
    const SkinHit &from = points[i], &to = points[(i + 1) % count];
    const auto a =
        work.orbit.pixel(from.position, static_cast<double>(area.width), static_cast<double>(area.height));
    const auto b =
        work.orbit.pixel(to.position, static_cast<double>(area.width), static_cast<double>(area.height));
    if (!a || !b) continue;
    const bool is_near = from.normal.dot(work.orbit.eye() - from.position) > 0.0;
    const ImVec2 p(area.x + static_cast<float>((*a)[0]), area.y + static_cast<float>((*a)[1]));
    const ImVec2 q(area.x + static_cast<float>((*b)[0]), area.y + static_cast<float>((*b)[1]));
    if (is_near) list->AddLine(p, q, IM_COL32(15, 15, 18, 170), scaled(4.4F));
    list->AddLine(p, q, end_colour(end, is_near ? 1.0F : 0.18F), scaled(is_near ? 2.2F : 1.4F));
  }
}

std::string ends_name(MuscleEnd end) {
  return end == MuscleEnd::origin ? "Origin" : "Insertion";
}

}  // namespace

void show_sketch_buttons(Workspace& work, Screen& screen, const std::string& muscle, bool is_ring) {
  if (is_ring) return ui::hint("A ring follows its opening and has no regions to draw.");
  SketchTool& sketch = screen.sketch;
  const float half = 0.5F * (ImGui::GetContentRegionAvail().x - scaled(14));
  for (const MuscleEnd end : muscle_ends) {
    const bool is_drawn = !muscle_sketch(work.state(), muscle, end, work.rig->head_to_metres).empty();
    const bool is_active = sketch.end == end && sketch.muscle == muscle;
    const float remove = is_drawn ? scaled(30) : 0.0F;
    if (end == MuscleEnd::insertion) ImGui::SameLine(0, scaled(8));
    if (ui::button("Draw " + std::string(name_of(end)),
                   is_active ? ui::Emphasis::strong : ui::Emphasis::plain, half - remove)) {
      sketch = {};
      if (!is_active) {
        sketch.muscle = muscle;
        sketch.end = end;
        work.settings.layers.skin = true;
      }
    }
    ui::tooltip(ends_name(end) +
                ": draw a closed curve around it on the skin with the mouse; Escape gives up");
    if (!is_drawn) continue;
    ImGui::SameLine(0, scaled(4));
    if (ui::button("x##" + std::string(name_of(end)), ui::Emphasis::plain, remove - scaled(4)))
      work.clear_sketch(muscle, end);
    ui::tooltip("Take the curve out: the builder finds the " + std::string(name_of(end)) + " itself");
  }
}

bool begin_stroke(const Workspace& work, Screen& screen, const std::optional<SkinHit>& hit) {
  SketchTool& sketch = screen.sketch;
  if (!sketch.end || !hit || work.rig->asset->parts[hit->part].part != "skin") return false;
  sketch.stroke = {*hit};
  sketch.is_drawing = true;
  return true;
}

void extend_stroke(const Workspace& work, Screen& screen, const std::optional<SkinHit>& hit) {
  SketchTool& sketch = screen.sketch;
  const double least = 0.0004;  // metres: a hand that stands still adds nothing
  if (hit && work.rig->asset->parts[hit->part].part == "skin" &&
      (hit->rest - sketch.stroke.back().rest).norm() > least)
    sketch.stroke.push_back(*hit);
}

void end_stroke(Workspace& work, Screen& screen) {
  SketchTool& sketch = screen.sketch;
  std::vector<Vec3> stroke;
  for (const SkinHit& hit : sketch.stroke)
    stroke.push_back(hit.rest);
  sketch.is_drawing = false;
  sketch.stroke.clear();
  // After a curve that is none the tool stays in the hand.
  if (work.sketch_region(sketch.muscle, *sketch.end, stroke).empty()) sketch = {};
}

void draw_sketches(Workspace& work, Screen& screen, const Area& area) {
  SketchTool& sketch = screen.sketch;
  if (sketch.end && (ImGui::IsKeyPressed(GLFW_KEY_ESCAPE, false) || work.selected_muscle != sketch.muscle ||
                     work.settings.panel != "muscles"))
    sketch = {};
  if (work.settings.panel != "muscles" || work.selected_muscle.empty()) return;
  for (const MuscleEnd end : muscle_ends) {
    const bool is_replaced = sketch.is_drawing && sketch.end == end;
    if (!is_replaced) draw_line(work, area, work.sketch_now(work.selected_muscle, end), end, true);
  }
  if (!sketch.end) return;
  draw_line(work, area, sketch.stroke, *sketch.end, false);
  const std::string text =
      ui::shortened("Draw a closed curve around the " + std::string(name_of(*sketch.end)) + " of " +
                        full_title(sketch.muscle) + " on the skin",
                    area.width - scaled(60));
  const ImVec2 size = ImGui::CalcTextSize(text.c_str());
  const ImVec2 at(area.x + 0.5F * (area.width - size.x), area.y + area.height - scaled(126));
  ImDrawList* list = ImGui::GetWindowDrawList();
  list->AddRectFilled({at.x - scaled(12), at.y - scaled(6)},
                      {at.x + size.x + scaled(12), at.y + size.y + scaled(6)}, IM_COL32(20, 21, 24, 220),
                      scaled(8));
  list->AddText(at, end_colour(*sketch.end, 1.0F), text.c_str());
}

}  // namespace fascia::app
