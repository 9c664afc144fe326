#pragma once

#include <imgui.h>

#include <string>

namespace fascia::app {

/// Draws the sign of a panel or a control (pose, landmarks, muscles, warnings, compare, live, export, play,
/// pause, loop, record, undo, redo) into a square of `size` pixels around `centre`.
void draw_icon(ImDrawList* list, const std::string& name, ImVec2 centre, float size, ImU32 colour);

/// A square button with a sign; its name is what a script clicks and what the tooltip says.
bool icon_button(const std::string& name, const std::string& icon, const std::string& help,
                 bool is_on = false, bool is_enabled = true);

}  // namespace fascia::app
