#pragma once

#include <string>

#include "view/scene.h"

/// The programs' sources, GLSL 3.30.
namespace fascia::view {

/// Position, normal, colour, texture coordinate and eye coordinate of a surface's vertices.
std::string surface_vertex_shader();
/// One for each kind of shading, with and without holes (cuts, cut-out textures): what does not concern it is
/// not compiled in, and what has no holes is tested for depth before it is shaded.
std::string surface_fragment_shader(Shading shading, bool has_holes);
std::string line_fragment_shader();

/// Depth alone, but for holes in the colour map; for shadows.
std::string depth_fragment_shader();
/// Normal and distance in the eye's frame; for the screen's light.
std::string geometry_fragment_shader();

/// One triangle over the whole picture; `place` runs over 0..1.
std::string screen_vertex_shader();
/// From `geometry`, for each of its pixels: how open the surface is to the room (ambient occlusion), its
/// distance, the key light's share that reaches it (soft shadows) and how thick the stuff before the light
/// is, metres.
std::string screen_light_fragment_shader();
/// Takes out that pass's grain, 4 x 4, along surfaces only.
std::string screen_blur_fragment_shader();
std::string backdrop_fragment_shader();
/// Copies `picture`; with `grain` half a step of noise goes over it, so that gradients do not band.
std::string copy_fragment_shader();

}  // namespace fascia::view
