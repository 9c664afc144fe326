#pragma once

#include <memory>
#include <vector>

#include "view/camera.h"
#include "view/environment.h"
#include "view/gl_objects.h"
#include "view/scene.h"
#include "view/shaders.h"
#include "view/surface_buffers.h"

namespace fascia::view {

/// Texture units while surfaces are drawn.
enum Unit { colour_unit, normal_unit, surface_unit, reflection_unit, shadow_unit, screen_unit };

/// Drawn last and blended over what lies behind it.
bool is_glass(const DrawSurface& surface);

/// The half space a surface is cut by, for the program's `cut`.
void set_cut(const Program& program, const DrawSurface& surface);
/// Back faces are left out but of what is seen from both sides.
void set_culling(const DrawSurface& surface);

/// A triangle over all of the framebuffer that is bound.
class Screen {
 public:
  Screen() { glGenVertexArrays(1, &array_); }
  ~Screen() { glDeleteVertexArrays(1, &array_); }
  Screen(const Screen&) = delete;
  Screen& operator=(const Screen&) = delete;
  void draw() const;

 private:
  GLuint array_ = 0;
};

/// A picture's surfaces and what they are seen by.
struct Shot {
  const DrawList& list;
  const std::vector<std::unique_ptr<VertexBuffers>>& buffers;  // of the list's surfaces
  const Environment& room;
  const Camera& camera;
  const Look& look;
  int width, height;         // pixels
  double enlargement = 1.0;  // pixels that surfaces are drawn at to one of the picture's, each way

  double aspect() const { return static_cast<double>(width) / height; }
};

/// The passes before the surfaces are drawn: how much of the key light and of the room's reaches each pixel.
class LightPasses {
 public:
  /// Nothing, for a look that needs none of them.
  void draw(const Shot& shot, TextureCache& textures);
  /// Sets what `program` reads of them, the maps included; `turn` (0..1) turns the pattern of samples.
  void set(const Program& program, const Shot& shot, double turn) const;

 private:
  /// From the scene to the light's clip space, and the box's width and depth there in metres.
  struct LightFrame {
    Mat4 matrix = Mat4::Identity();
    double span = 1.0, range = 1.0;
  };
  static LightFrame light_frame(const Shot& shot);
  void set_shadows(const Program& program, const Shot& shot, double turn) const;
  void set_holes(const Program& program, const DrawSurface& surface, TextureCache& textures) const;
  void draw_shadows(const Shot& shot, TextureCache& textures, int size);
  void draw_geometry(const Shot& shot, TextureCache& textures, int width, int height);
  void draw_screen_light(const Shot& shot, int width, int height);
  void draw_over_surfaces(GLuint picture, Canvas& canvas, int width, int height) const;

  Program depth_{surface_vertex_shader(), depth_fragment_shader()};
  Program geometry_{surface_vertex_shader(), geometry_fragment_shader()};
  Program screen_light_{screen_vertex_shader(), screen_light_fragment_shader()};
  Program blur_{screen_vertex_shader(), screen_blur_fragment_shader()};
  Canvas shadow_map_{0, Canvas::Depth::texture, 0};
  Canvas geometry_map_{GL_RGBA16F, Canvas::Depth::buffer, 0};
  Canvas raw_light_{GL_RGBA16F, Canvas::Depth::none, 0}, smooth_light_{GL_RGBA16F, Canvas::Depth::none, 0};
  Screen screen_;
  LightFrame frame_;
};

}  // namespace fascia::view
