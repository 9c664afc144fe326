#include "view/gl_objects.h"

#include "geometry/error.h"

namespace fascia::view {

namespace {

GLuint compile(GLenum kind, const std::string& source) {
  const GLuint shader = glCreateShader(kind);
  const char* text = source.c_str();
  glShaderSource(shader, 1, &text, nullptr);
  glCompileShader(shader);
  GLint good = 0;
  glGetShaderiv(shader, GL_COMPILE_STATUS, &good);
  if (!good) {
    char log[2048] = "";
    glGetShaderInfoLog(shader, sizeof log, nullptr, log);
    throw Error(std::string("the OpenGL driver refuses the shaders: ") + log);
  }
  return shader;
}

}  // namespace

Program::Program(const std::string& vertex, const std::string& fragment) : name_(glCreateProgram()) {
  const GLuint parts[2] = {compile(GL_VERTEX_SHADER, vertex), compile(GL_FRAGMENT_SHADER, fragment)};
  for (GLuint part : parts)
    glAttachShader(name_, part);
  glLinkProgram(name_);
  for (GLuint part : parts)
    glDeleteShader(part);
  GLint good = 0;
  glGetProgramiv(name_, GL_LINK_STATUS, &good);
  if (!good) {
    char log[2048] = "";
    glGetProgramInfoLog(name_, sizeof log, nullptr, log);
    throw Error(std::string("the OpenGL driver refuses the shaders: ") + log);
  }
}

Program::~Program() {
  glDeleteProgram(name_);
}

void Program::set(const char* uniform, const Vec3& value) const {
  const Eigen::Vector3f single = value.cast<float>();
  glUniform3fv(place(uniform), 1, single.data());
}

void Program::set(const char* uniform, const Mat4& value) const {
  const Eigen::Matrix4f single = value.cast<float>();
  glUniformMatrix4fv(place(uniform), 1, GL_FALSE, single.data());
}

GLint Program::place(const char* uniform) const {
  const auto [entry, is_new] = places_.try_emplace(uniform, -1);
  if (is_new) entry->second = glGetUniformLocation(name_, uniform);
  return entry->second;
}

void Canvas::bind(int width, int height) {
  if (width != width_ || height != height_) {
    release();
    make(width, height);
  }
  glBindFramebuffer(GL_FRAMEBUFFER, framebuffer_);
  glViewport(0, 0, width, height);
}

void Canvas::use_depth_of(const Canvas& other) {
  glBindFramebuffer(GL_FRAMEBUFFER, framebuffer_);
  if (other.depth_ == Depth::buffer)
    glFramebufferRenderbuffer(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_RENDERBUFFER, other.depth_image_);
  else
    glFramebufferTexture2D(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_TEXTURE_2D, other.depth_image_, 0);
}

void Canvas::make(int width, int height) {
  GLint bound = 0;
  glGetIntegerv(GL_TEXTURE_BINDING_2D, &bound);
  const auto image = [&](GLenum format, GLenum attachment, bool is_buffer, bool is_depth) {
    GLuint name = 0;
    if (is_buffer) {
      glGenRenderbuffers(1, &name);
      glBindRenderbuffer(GL_RENDERBUFFER, name);
      glRenderbufferStorageMultisample(GL_RENDERBUFFER, samples_, format, width, height);
      glFramebufferRenderbuffer(GL_FRAMEBUFFER, attachment, GL_RENDERBUFFER, name);
      return name;
    }
    glGenTextures(1, &name);
    glBindTexture(GL_TEXTURE_2D, name);
    glTexImage2D(GL_TEXTURE_2D, 0, static_cast<GLint>(format), width, height, 0,
                 is_depth ? GL_DEPTH_COMPONENT : GL_RGBA, GL_FLOAT, nullptr);
    for (const GLenum which : {GL_TEXTURE_MIN_FILTER, GL_TEXTURE_MAG_FILTER})
      glTexParameteri(GL_TEXTURE_2D, which, static_cast<GLint>(filter_));
    for (const GLenum which : {GL_TEXTURE_WRAP_S, GL_TEXTURE_WRAP_T})
      glTexParameteri(GL_TEXTURE_2D, which, GL_CLAMP_TO_EDGE);
    glFramebufferTexture2D(GL_FRAMEBUFFER, attachment, GL_TEXTURE_2D, name, 0);
    return name;
  };
  glGenFramebuffers(1, &framebuffer_);
  glBindFramebuffer(GL_FRAMEBUFFER, framebuffer_);
  if (colour_format_) {
    colour_ = image(colour_format_, GL_COLOR_ATTACHMENT0, samples_ > 0, false);
  } else {
    glDrawBuffer(GL_NONE);
    glReadBuffer(GL_NONE);
  }
  if (depth_ != Depth::none)
    depth_image_ = image(GL_DEPTH_COMPONENT24, GL_DEPTH_ATTACHMENT, depth_ == Depth::buffer, true);
  glBindTexture(GL_TEXTURE_2D, static_cast<GLuint>(bound));
  if (glCheckFramebufferStatus(GL_FRAMEBUFFER) != GL_FRAMEBUFFER_COMPLETE) {
    release();
    throw Error("pictures of " + std::to_string(width) + " x " + std::to_string(height) +
                " are too large for OpenGL here");
  }
  width_ = width;
  height_ = height;
}

void Canvas::release() {
  if (framebuffer_) glDeleteFramebuffers(1, &framebuffer_);
  if (colour_ && samples_ > 0) glDeleteRenderbuffers(1, &colour_);
  if (colour_ && samples_ == 0) glDeleteTextures(1, &colour_);
  if (depth_image_ && depth_ == Depth::buffer) glDeleteRenderbuffers(1, &depth_image_);
  if (depth_image_ && depth_ == Depth::texture) glDeleteTextures(1, &depth_image_);
  framebuffer_ = colour_ = depth_image_ = 0;
  width_ = height_ = 0;
}

void bind_texture(int unit, GLenum kind, GLuint texture) {
  glActiveTexture(GL_TEXTURE0 + static_cast<GLenum>(unit));
  glBindTexture(kind, texture);
}

}  // namespace fascia::view
