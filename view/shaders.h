#pragma once

#include <string>

#include "view/scene.h"

/// The programs' sources, GLSL 3.30.
namespace fascia::view {

/// Position, normal, colour, texture coordinate and eye coordinate of a surface's vertices.
std::string surface_vertex_shader();
/// One for each kind of shading: what does not concern it is not compiled in.
std::string surface_fragment_shader(Shading shading);
std::string line_fragment_shader();

/// Depth alone, but for holes in the colour map; for shadows.
std::string depth_fragment_shader();
/// Normal and distance in the eye's frame; for ambient occlusion.
std::string geometry_fragment_shader();

/// One triangle over the whole picture; `place` runs over 0..1.
std::string screen_vertex_shader();
/// Ambient occlusion from `geometry`: McGuire, Mara & Luebke 2012, Scalable ambient obscurance, equation 1.
std::string occlusion_fragment_shader();
/// Takes out that pass's grain, 4 x 4, along surfaces only.
std::string occlusion_blur_fragment_shader();
std::string backdrop_fragment_shader();
/// Copies `picture`; with `grain` half a step of noise goes over it, so that gradients do not band.
std::string copy_fragment_shader();

}  // namespace fascia::view
