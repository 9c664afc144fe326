#pragma once

#include "draw.h"
#include "scene.h"

/// The controls: sliders of all channels by group, a tab for each named set, layers, and the timeline. Call
/// between ImGui::NewFrame and ImGui::Render.
void show_panel(Scene& scene, Layers& layers);
