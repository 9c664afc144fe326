#pragma once

#include <epoxy/gl.h>

#include <array>
#include <string>
#include <vector>

#include "scene.h"

/// What is shown.
struct Layers {
  bool skin = true, skull = false, smas = false, fibres = false, wireframe = false;
  float skin_opacity = 1.0F;
};

/// A camera that circles a point.
struct Orbit {
  std::array<float, 3> target = {0, 0, 0};
  float distance = 0.5F, yaw = 0.35F, pitch = 0.1F;
};

/// Draws a scene with OpenGL 3.3. Needs a current context from the constructor to the destructor.
class Drawing {
 public:
  explicit Drawing(const Scene& scene);
  ~Drawing();
  Drawing(const Drawing&) = delete;
  Drawing& operator=(const Drawing&) = delete;

  /// A camera that has the whole face in sight.
  Orbit first_view() const;
  void draw(const Scene& scene, const Layers& layers, const Orbit& orbit, int width, int height);

 private:
  /// Vertex and index buffers of a surface or of lines.
  struct Part {
    GLuint array = 0, positions = 0, normals = 0, indices = 0;
    GLsizei count = 0;
  };
  static Part make_part(const uint32_t* indices, std::size_t count);
  static void fill(GLuint buffer, const float* numbers, std::size_t count);
  Part surface_part(const Scene& scene, const char* name) const;
  void colour(float red, float green, float blue, float alpha, bool lit) const;

  GLuint program_ = 0;
  std::vector<Part> skin_;
  Part cranium_, mandible_, teeth_upper_, teeth_lower_, smas_, fibres_;
  std::array<float, 3> lower_ = {1e9F, 1e9F, 1e9F}, upper_ = {-1e9F, -1e9F, -1e9F};
};

/// The window's pixels as a PNG file. Throws when it cannot be written.
void write_screenshot(const std::string& path, int width, int height);
