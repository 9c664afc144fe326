#include <algorithm>
#include <cmath>

#include "app/model/names.h"
#include "app/panels/screen.h"
#include "app/window/icons.h"
#include "app/window/theme.h"
#include "app/window/widgets.h"

namespace fascia::app {

namespace {

ImVec2 on_screen(const Area& area, const Vec3& pixel) {
  return {area.x + static_cast<float>(pixel[0]), area.y + static_cast<float>(pixel[1])};
}

/// The ray under the mouse; `area` is that of the face.
Ray ray_under(const Workspace& work, const Area& area, ImVec2 mouse) {
  return work.orbit.ray(static_cast<double>(mouse.x - area.x), static_cast<double>(mouse.y - area.y),
                        static_cast<double>(area.width), static_cast<double>(area.height));
}

bool shows_landmarks(const Workspace& work) {
  return work.settings.layers.landmarks || work.settings.panel == "landmarks";
}

// --- Landmarks

/// What of the skin is under the mouse; nothing beside the face's own part of the picture.
std::optional<SkinHit> skin_under(const Workspace& work, const Area& area) {
  const ImVec2 mouse = ImGui::GetIO().MousePos;
  if (!area.holds(mouse)) return std::nullopt;
  return pick_skin(*work.rig->asset, *work.frame, ray_under(work, area, mouse));
}

/// A landmark that faces the camera, as it stands on the screen.
struct PlacedLandmark {
  const rig::Landmark* landmark = nullptr;
  ImVec2 at;
  Vec3 now = Vec3::Zero();
};

std::vector<PlacedLandmark> placed_landmarks(const Workspace& work, const Area& area) {
  std::vector<PlacedLandmark> placed;
  for (const rig::Landmark& landmark : work.rig->rig->skull.landmarks) {
    const auto held = work.landmark_hold(landmark.name);
    if (!held || held->normal.dot(work.orbit.eye() - held->position) < 0.0) continue;
    const Vec3 now = held->position;
    const auto pixel =
        work.orbit.pixel(now, static_cast<double>(area.width), static_cast<double>(area.height));
    if (pixel) placed.push_back({&landmark, on_screen(area, *pixel), now});
  }
  return placed;
}

void draw_landmarks(const Workspace& work, Screen& screen, const Area& area,
                    const std::vector<PlacedLandmark>& placed) {
  ImDrawList* list = ImGui::GetWindowDrawList();
  const ImVec2 mouse = ImGui::GetIO().MousePos;
  float nearest = scaled(12);
  screen.hovered_landmark.clear();
  for (const PlacedLandmark& one : placed) {
    const float distance = std::hypot(one.at.x - mouse.x, one.at.y - mouse.y);
    if (distance < nearest && area.holds(mouse) && screen.dragged_landmark.empty()) {
      nearest = distance;
      screen.hovered_landmark = one.landmark->name;
    }
  }
  for (const PlacedLandmark& one : placed) {
    const std::string& name = one.landmark->name;
    const bool is_hot = name == screen.hovered_landmark || name == screen.dragged_landmark;
    const bool is_selected = name == work.selected_landmark;
    const float radius = scaled(is_hot || is_selected ? 6.0F : 3.6F);
    const ImVec4 colour = landmark_colour(work, *one.landmark);
    list->AddCircleFilled(one.at, radius + scaled(1.6F), IM_COL32(15, 15, 18, 190), 20);
    list->AddCircleFilled(one.at, radius, colour_of(colour), 20);
    if (is_selected) list->AddCircle(one.at, radius + scaled(4), colour_of(colour), 24, scaled(1.6F));
    if (!is_hot && !is_selected) continue;
    const std::string text = full_title(name);
    const ImVec2 size = ImGui::CalcTextSize(text.c_str());
    const ImVec2 from(one.at.x + scaled(14), one.at.y - 0.5F * size.y - scaled(3));
    list->AddRectFilled(from, {from.x + size.x + scaled(14), from.y + size.y + scaled(6)},
                        IM_COL32(20, 21, 24, 225), scaled(6));
    list->AddText({from.x + scaled(7), from.y + scaled(3)}, IM_COL32(240, 238, 234, 255), text.c_str());
  }
}

// --- The mouse

void begin_press(Workspace& work, Screen& screen, const Area& area) {
  const ImGuiIO& io = ImGui::GetIO();
  screen.pressed_at = io.MousePos;
  screen.has_moved = false;
  if (!screen.hovered_landmark.empty()) {
    screen.dragged_landmark = screen.hovered_landmark;
    work.selected_landmark = screen.hovered_landmark;
    return;
  }
  if (begin_stroke(work, screen, skin_under(work, area))) return;
  if ((screen.tool == Tool::pull) != io.KeyShift) {
    if (const auto hit = skin_under(work, area)) {
      work.poke(*hit);
      return;
    }
  }
  screen.is_turning = true;
}

void move_press(Workspace& work, Screen& screen, const Area& area) {
  const ImGuiIO& io = ImGui::GetIO();
  const float least = scaled(3);
  if (std::hypot(io.MousePos.x - screen.pressed_at.x, io.MousePos.y - screen.pressed_at.y) > least)
    screen.has_moved = true;
  if (!screen.has_moved) return;
  if (screen.sketch.is_drawing) return extend_stroke(work, screen, skin_under(work, area));
  if (!screen.dragged_landmark.empty()) {
    if (const auto hit = skin_under(work, area)) work.move_landmark(screen.dragged_landmark, hit->rest, true);
  } else if (work.held()) {
    // The hand moves in the plane of the screen through where it took hold.
    const Poke& held = *work.held();
    const Ray ray = ray_under(work, area, io.MousePos);
    const double depth = (held.target - ray.origin).dot(-work.orbit.back());
    work.pull(ray.origin + depth / ray.direction.dot(-work.orbit.back()) * ray.direction);
  } else if (screen.is_turning) {
    work.orbit.turn(-0.35 * static_cast<double>(io.MouseDelta.x),
                    0.35 * static_cast<double>(io.MouseDelta.y));
  }
}

/// A press without a motion chooses the muscle under the mouse.
void click(Workspace& work, Screen& screen, const Area& area) {
  if (!work.settings.layers.muscles && work.settings.panel != "muscles") return;
  const auto hit = skin_under(work, area);
  const double reach = 0.012;  // metres from the skin to the deepest mimic muscle
  const auto fibre = hit ? pick_fibre(*work.rig->asset, *work.frame, hit->position, reach, {}) : std::nullopt;
  work.selected_muscle = fibre ? work.rig->asset->fibre_muscles[*fibre] : "";
  (void)screen;
}

void end_press(Workspace& work, Screen& screen, const Area& area) {
  if (screen.sketch.is_drawing) return end_stroke(work, screen);
  if (!screen.has_moved && screen.dragged_landmark.empty() && !screen.sketch.end) click(work, screen, area);
  if (!screen.dragged_landmark.empty()) work.seal();
  screen.dragged_landmark.clear();
  screen.is_turning = false;
  work.let_go();
}

void use_mouse(Workspace& work, Screen& screen, const Area& area, bool is_hovered) {
  const ImGuiIO& io = ImGui::GetIO();
  if (is_hovered && io.MouseWheel != 0.0F)
    work.orbit.zoom(std::pow(0.88, static_cast<double>(io.MouseWheel)));
  if (is_hovered && ImGui::IsMouseClicked(0)) begin_press(work, screen, area);
  if (is_hovered && ImGui::IsMouseDoubleClicked(0) && screen.hovered_landmark.empty() && !screen.sketch.end)
    if (const auto hit = skin_under(work, area)) work.orbit.look_at(hit->position, Vec3::Zero(), 0.4);
  const bool is_pressed =
      screen.is_turning || !screen.dragged_landmark.empty() || screen.sketch.is_drawing || work.held();
  if (is_pressed && io.MouseDown[0]) move_press(work, screen, area);
  if (is_pressed && !io.MouseDown[0]) end_press(work, screen, area);
  if (is_hovered && (ImGui::IsMouseClicked(1) || ImGui::IsMouseClicked(2))) screen.is_shifting = true;
  if (!io.MouseDown[1] && !io.MouseDown[2]) screen.is_shifting = false;
  if (screen.is_shifting)
    work.orbit.shift(static_cast<double>(io.MouseDelta.x), -static_cast<double>(io.MouseDelta.y),
                     static_cast<double>(area.height));
}

// --- What lies over the picture

void show_layer_chips(Workspace& work, const Area& area) {
  Layers& l = work.settings.layers;
  ImGui::SetCursorScreenPos({area.x + scaled(14), area.y + scaled(12)});
  // Rows as wide as the picture.
  const float left = area.x + scaled(14), right = area.x + area.width - scaled(14);
  const auto chip = [&](const char* name, bool& is_on) {
    const ImVec2 at = ImGui::GetCursorScreenPos();
    const float width = ImGui::CalcTextSize(name, nullptr, true).x + scaled(22);
    if (at.x > left && at.x + width > right) ImGui::SetCursorScreenPos({left, at.y + scaled(34)});
    ui::chip(name, is_on);
    ImGui::SameLine(0, scaled(6));
  };
  const bool had_depth = l.has_depth();
  chip("Skin##layer", l.skin);
  chip("Fat##layer", l.fat);
  chip("SMAS##layer", l.smas);
  chip("Muscles##layer", l.muscles);
  chip("Ligaments##layer", l.ligaments);
  chip("Skull##layer", l.skull);
  chip("Lattice##layer", l.lattice);
  chip("Landmarks##layer", l.landmarks);
  chip("Compression##layer", l.strain);
  if (work.rig->appearance) chip("Textures##layer", l.has_textures);
  const bool has_depth = l.has_depth();
  if (has_depth && !had_depth && l.skin_opacity > 0.99) l.skin_opacity = 0.35;
  if (!has_depth && had_depth) l.skin_opacity = 1.0;
  if (!l.skin || !has_depth) return;
  ImGui::SetCursorScreenPos({area.x + scaled(16), ImGui::GetCursorScreenPos().y + scaled(36)});
  auto opacity = static_cast<float>(l.skin_opacity);
  bool has_ended = false;
  ui::SliderLook look{0.05F, 1.0F, 0.35F, palette().accent, "", "%.2f"};
  if (ui::slider("Skin opacity", opacity, look, scaled(180), has_ended))
    l.skin_opacity = static_cast<double>(opacity);
  ui::tooltip("How much the skin hides what lies beneath");
}

void show_views(Workspace& work, Screen& screen, const Area& area) {
  const char* const views[] = {"Front", "Left", "Right", "Three-quarter", "Below"};
  const char* const names[] = {"front", "left", "right", "three-quarter", "below"};
  int chosen = -1;
  const float width = std::min(scaled(400), area.width - scaled(200));
  ImGui::SetCursorScreenPos({area.x + scaled(14), area.y + area.height - scaled(44)});
  if (width > scaled(330)) {
    ui::choice("view", views, 5, chosen, width);
  } else {
    // No room for all of them side by side.
    if (ui::button("View", ui::Emphasis::plain, scaled(64))) ImGui::OpenPopup("##views");
    if (ImGui::BeginPopup("##views")) {
      for (int i = 0; i < 5; ++i) {
        if (ImGui::Selectable(views[i])) chosen = i;
        ui::note(views[i]);
      }
      ImGui::EndPopup();
    }
  }
  if (chosen >= 0) work.orbit.go_to(names[chosen]);
  const char* const tools[] = {"Turn", "Pull"};
  int tool = screen.tool == Tool::pull ? 1 : 0;
  ImGui::SetCursorScreenPos({area.x + area.width - scaled(154), area.y + area.height - scaled(44)});
  if (ui::choice("tool", tools, 2, tool, scaled(140))) screen.tool = tool == 1 ? Tool::pull : Tool::turn;
}

void show_legend(const Workspace& work, const Area& area) {
  const bool has_distances = work.has_distances();
  if (!has_distances && !work.settings.layers.strain) return;
  ImDrawList* list = ImGui::GetWindowDrawList();
  ImGui::PushFont(fonts().small);
  const double most = has_distances ? work.comparison.scale_mm : 30.0;
  const char* title = has_distances ? "mm" : "% shorter";
  char marks[3][16];
  const float width = scaled(14), height = scaled(180), gap = scaled(5);
  float widest = ImGui::CalcTextSize(title).x - width - gap;
  for (int i = 0; i <= 2; ++i) {
    std::snprintf(marks[i], sizeof marks[i], "%.3g", 0.5 * i * most);
    widest = std::max(widest, ImGui::CalcTextSize(marks[i]).x);
  }
  const float box = width + gap + widest, margin = scaled(12);
  const float x = area.x + area.width - box - 2.0F * margin, y = area.y + 0.5F * (area.height - height);
  list->AddRectFilled({x - margin, y - scaled(28)}, {x + box + margin, y + height + margin},
                      IM_COL32(20, 21, 24, 170), scaled(8));
  const int steps = 48;
  const auto shade = [](double share) {
    const Vec3 c = heat_colour(share);
    return IM_COL32(static_cast<int>(255 * c[0]), static_cast<int>(255 * c[1]), static_cast<int>(255 * c[2]),
                    255);
  };
  for (int i = 0; i < steps; ++i) {
    const float from = y + height * static_cast<float>(i) / steps,
                to = y + height * static_cast<float>(i + 1) / steps;
    list->AddRectFilled({x, from}, {x + width, to + 0.5F}, shade(1.0 - (i + 0.5) / steps));
  }
  const ImU32 white = IM_COL32(235, 233, 229, 255);
  for (int i = 0; i <= 2; ++i)
    list->AddText({x + width + gap, y + height * (1.0F - 0.5F * static_cast<float>(i)) - scaled(7)}, white,
                  marks[i]);
  list->AddText({x, y - scaled(22)}, white, title);
  ImGui::PopFont();
}

void show_muscle_name(const Workspace& work, const Area& area) {
  if (work.selected_muscle.empty() || !work.settings.layers.muscles) return;
  ImDrawList* list = ImGui::GetWindowDrawList();
  const std::string text = full_title(work.selected_muscle);
  ImGui::PushFont(fonts().large);
  const ImVec2 size = ImGui::CalcTextSize(text.c_str());
  const ImVec2 at(area.x + 0.5F * (area.width - size.x), area.y + area.height - scaled(92));
  list->AddRectFilled({at.x - scaled(16), at.y - scaled(7)},
                      {at.x + size.x + scaled(16), at.y + size.y + scaled(7)}, IM_COL32(20, 21, 24, 205),
                      scaled(10));
  list->AddText(at, IM_COL32(255, 217, 90, 255), text.c_str());
  ImGui::PopFont();
}

}  // namespace

ImVec4 landmark_colour(const Workspace& work, const rig::Landmark& landmark) {
  const Palette& p = palette();
  if (landmark_edit(work.state(), landmark.name)) return ImVec4(0.42F, 0.66F, 1.0F, 1.0F);
  const float sure = 0.75F, doubtful = 0.4F;
  return landmark.confidence > sure ? p.good : landmark.confidence > doubtful ? p.warning : p.bad;
}

Area face_area(const Workspace& work, const Area& viewport) {
  if (!work.is_divided()) return viewport;
  const float scale = ImGui::GetIO().DisplayFramebufferScale.x;
  // As the picture is divided, in whole pixels.
  const float left = std::floor(0.5F * std::floor(viewport.width * scale)) / scale;
  return {viewport.x + left, viewport.y, viewport.width - left, viewport.height};
}

void show_viewport(Workspace& work, Screen& screen, const Area& area) {
  screen.viewport = area;
  begin_area("##viewport", area, palette().viewport, {0, 0});
  if (work.rig && work.frame && area.width > 8 && area.height > 8) {
    renew_picture(work, screen, area);
    ImDrawList* list = ImGui::GetWindowDrawList();
    if (!screen.picture_key.empty())
      list->AddImage(reinterpret_cast<ImTextureID>(static_cast<uintptr_t>(screen.picture.texture())),
                     {area.x, area.y}, {area.x + area.width, area.y + area.height}, {0, 1}, {1, 0});
    ImGui::SetCursorScreenPos({area.x, area.y});
    ImGui::SetNextItemWidth(area.width);
    const Area face = face_area(work, area);
    if (shows_landmarks(work)) {
      list->PushClipRect({face.x, face.y}, {face.x + face.width, face.y + face.height}, true);
      draw_landmarks(work, screen, face, placed_landmarks(work, face));
      list->PopClipRect();
    } else {
      screen.hovered_landmark.clear();
    }
    list->PushClipRect({face.x, face.y}, {face.x + face.width, face.y + face.height}, true);
    draw_sketches(work, screen, face);
    list->PopClipRect();
    show_legend(work, area);
    show_muscle_name(work, area);
    show_layer_chips(work, area);
    show_views(work, screen, area);
    const bool is_over_item = ImGui::IsAnyItemHovered() || ImGui::IsAnyItemActive();
    use_mouse(work, screen, face, ImGui::IsWindowHovered() && !is_over_item);
  }
  end_area();
}

}  // namespace fascia::app
