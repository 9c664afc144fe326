#pragma once

#include <epoxy/gl.h>

#include <map>
#include <string>

#include "geometry/mesh.h"

namespace fascia::view {

/// A linked OpenGL program and the places of its uniforms.
class Program {
 public:
  /// Throws fascia::Error with the driver's words when it refuses the sources.
  Program(const std::string& vertex, const std::string& fragment);
  ~Program();
  Program(const Program&) = delete;
  Program& operator=(const Program&) = delete;

  void use() const { glUseProgram(name_); }
  GLint place(const char* uniform) const;
  void set(const char* uniform, int value) const { glUniform1i(place(uniform), value); }
  void set(const char* uniform, double value) const {
    glUniform1f(place(uniform), static_cast<float>(value));
  }
  void set(const char* uniform, const Vec3& value) const;
  void set(const char* uniform, const Mat4& value) const;

 private:
  GLuint name_ = 0;
  mutable std::map<std::string, GLint> places_;
};

/// A framebuffer with a colour image, a depth image or both, made anew when its size changes.
class Canvas {
 public:
  enum class Depth { none, buffer, texture };
  /// `colour` 0: no colour image. `samples` 0: a texture to sample from, else a multisampled buffer.
  Canvas(GLenum colour, Depth depth, int samples, GLenum filter = GL_NEAREST)
      : colour_format_(colour), depth_(depth), samples_(samples), filter_(filter) {}
  ~Canvas() { release(); }
  Canvas(const Canvas&) = delete;
  Canvas& operator=(const Canvas&) = delete;

  /// Binds it for drawing, with its viewport. Throws fascia::Error when the driver has no room for it.
  void bind(int width, int height);
  /// Draws by the depth image of `other` (of the same size, bound before) in place of one of its own, until
  /// either is made anew.
  void use_depth_of(const Canvas& other);
  GLuint framebuffer() const { return framebuffer_; }
  GLuint colour() const { return colour_; }
  GLuint depth() const { return depth_image_; }

 private:
  void release();
  void make(int width, int height);

  GLenum colour_format_;
  Depth depth_;
  int samples_;
  GLenum filter_;
  int width_ = 0, height_ = 0;
  GLuint framebuffer_ = 0, colour_ = 0, depth_image_ = 0;
};

/// Binds `texture` to unit `unit`.
void bind_texture(int unit, GLenum kind, GLuint texture);

}  // namespace fascia::view
