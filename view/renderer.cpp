#include "view/renderer.h"

#include <epoxy/egl.h>
#include <epoxy/gl.h>

#include <Eigen/Geometry>
#include <array>
#include <cmath>
#include <map>

#include "geometry/error.h"

namespace fascia::view {

namespace {

// Two soft lights, a rim and a little sky; enough to read form by, the same on every machine.
const char* vertex_source = R"(#version 330 core
layout(location = 0) in vec3 position;
layout(location = 1) in vec3 normal;
layout(location = 2) in vec3 colour;
uniform mat4 to_clip;
uniform mat4 to_eye;
out vec3 eye_normal;
out vec3 eye_position;
out vec3 base;
void main() {
  gl_Position = to_clip * vec4(position, 1.0);
  eye_normal = mat3(to_eye) * normal;
  eye_position = (to_eye * vec4(position, 1.0)).xyz;
  base = colour;
})";

const char* surface_source = R"(#version 330 core
in vec3 eye_normal;
in vec3 eye_position;
in vec3 base;
uniform float opacity;
uniform float shine;
out vec4 pixel;
void main() {
  vec3 n = normalize(eye_normal);
  vec3 v = normalize(-eye_position);
  bool back = !gl_FrontFacing;
  if (back) n = -n;
  vec3 key = normalize(vec3(0.45, 0.65, 0.75));
  vec3 fill = normalize(vec3(-0.8, 0.1, 0.5));
  float d = max(dot(n, key), 0.0) * 0.72 + max(dot(n, fill), 0.0) * 0.24 + 0.16 + 0.1 * max(n.y, 0.0);
  float s = shine * pow(max(dot(n, normalize(key + v)), 0.0), 28.0);
  float rim = 0.12 * pow(1.0 - max(dot(n, v), 0.0), 3.0);
  vec3 linear_base = pow(base, vec3(2.2));
  vec3 lit = linear_base * d + vec3(s + rim) * 0.5;
  if (back) lit *= 0.45;
  pixel = vec4(pow(clamp(lit, 0.0, 1.0), vec3(1.0 / 2.2)), opacity);
})";

const char* line_source = R"(#version 330 core
in vec3 eye_normal;
in vec3 eye_position;
in vec3 base;
uniform float opacity;
out vec4 pixel;
void main() { pixel = vec4(base, opacity); })";

GLuint compile(GLenum kind, const char* source) {
  const GLuint shader = glCreateShader(kind);
  glShaderSource(shader, 1, &source, nullptr);
  glCompileShader(shader);
  GLint good = 0;
  glGetShaderiv(shader, GL_COMPILE_STATUS, &good);
  if (!good) {
    char log[1024] = "";
    glGetShaderInfoLog(shader, sizeof log, nullptr, log);
    throw Error(std::string("the OpenGL driver refuses the shaders: ") + log);
  }
  return shader;
}

GLuint link(const char* fragment) {
  const GLuint program = glCreateProgram();
  const GLuint parts[2] = {compile(GL_VERTEX_SHADER, vertex_source), compile(GL_FRAGMENT_SHADER, fragment)};
  for (GLuint part : parts)
    glAttachShader(program, part);
  glLinkProgram(program);
  for (GLuint part : parts)
    glDeleteShader(part);
  return program;
}

Mat4 look(const Camera& camera) {
  const double yaw = camera.yaw * EIGEN_PI / 180.0, pitch = camera.pitch * EIGEN_PI / 180.0;
  const Vec3 back(std::sin(yaw) * std::cos(pitch), std::sin(pitch), std::cos(yaw) * std::cos(pitch));
  const Vec3 eye = camera.target + camera.distance * back;
  const Vec3 right = Vec3::UnitY().cross(back).normalized(), up = back.cross(right);
  Mat4 view = Mat4::Identity();
  view.row(0).head<3>() = right;
  view.row(1).head<3>() = up;
  view.row(2).head<3>() = back;
  view.topRightCorner<3, 1>() = -view.topLeftCorner<3, 3>() * eye;
  return view;
}

Mat4 perspective(const Camera& camera, double aspect) {
  const double near = 0.05 * camera.distance, far = 4.0 * camera.distance;
  const double f = 1.0 / std::tan(camera.field_of_view * EIGEN_PI / 360.0);
  Mat4 p = Mat4::Zero();
  p(0, 0) = f / aspect;
  p(1, 1) = f;
  p(2, 2) = (far + near) / (near - far);
  p(2, 3) = 2 * far * near / (near - far);
  p(3, 2) = -1;
  return p;
}

/// Vertex normals that see through texture seams: vertices at one place share theirs.
std::vector<Vec3> seamless_normals(const DrawSurface& surface) {
  std::map<std::array<double, 3>, int> first;
  std::vector<int> shared;
  for (const Vec3& p : surface.positions)
    shared.push_back(first.try_emplace({p[0], p[1], p[2]}, static_cast<int>(shared.size())).first->second);
  TriangleMesh welded{surface.positions, surface.triangles};
  for (Triangle& t : welded.triangles)
    for (int& corner : t)
      corner = shared[static_cast<size_t>(corner)];
  std::vector<Vec3> normals = vertex_normals(welded);
  for (size_t v = 0; v < normals.size(); ++v)
    normals[v] = normals[static_cast<size_t>(shared[v])];
  return normals;
}

/// Position, normal and colour of every vertex, interleaved.
std::vector<float> interleave(const std::vector<Vec3>& positions, const std::vector<Vec3>& normals,
                              const std::vector<Vec3>& colours, const Vec3& colour) {
  std::vector<float> data;
  data.reserve(positions.size() * 9);
  for (size_t i = 0; i < positions.size(); ++i)
    for (const Vec3& v : {positions[i], normals.empty() ? Vec3(Vec3::UnitZ()) : normals[i],
                          colours.empty() ? colour : colours[i]})
      for (int k = 0; k < 3; ++k)
        data.push_back(static_cast<float>(v[k]));
  return data;
}

}  // namespace

Camera named_camera(const std::string& view, const Bounds& box, double fill) {
  Camera camera;
  if (view == "front")
    camera.yaw = 0;
  else if (view == "side")
    camera.yaw = 90;
  else if (view == "right")
    camera.yaw = -90;
  else if (view == "three-quarter")
    camera.yaw = 38;
  else if (view == "back")
    camera.yaw = 180;
  else
    throw Error("view '" + view + "' is unknown: use front, side, right, three-quarter, back or turntable");
  camera.target = box.centre();
  const double height = std::max({box.size()[1], box.size()[0], 0.8 * box.size()[2]});
  camera.distance =
      0.5 * height / fill / std::tan(camera.field_of_view * EIGEN_PI / 360.0) + 0.35 * box.size()[2];
  return camera;
}

struct Renderer::State {
  int width = 0, height = 0;
  EGLDisplay display = EGL_NO_DISPLAY;
  EGLContext context = EGL_NO_CONTEXT;
  GLuint surface_program = 0, line_program = 0;
  GLuint drawn = 0, resolved = 0;
  GLuint buffers[3] = {0, 0, 0};
  GLuint array = 0, vertices = 0, indices = 0;

  void make_context() {
    const auto get_display =
        reinterpret_cast<PFNEGLGETPLATFORMDISPLAYEXTPROC>(eglGetProcAddress("eglGetPlatformDisplayEXT"));
    if (get_display) display = get_display(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, nullptr);
    if (display == EGL_NO_DISPLAY) display = eglGetDisplay(EGL_DEFAULT_DISPLAY);
    if (display == EGL_NO_DISPLAY || !eglInitialize(display, nullptr, nullptr) || !eglBindAPI(EGL_OPENGL_API))
      throw Error("no OpenGL without a display: install Mesa's EGL (Debian: libegl1 libgl1-mesa-dri)");
    const EGLint wanted[] = {EGL_SURFACE_TYPE, EGL_PBUFFER_BIT, EGL_RENDERABLE_TYPE, EGL_OPENGL_BIT,
                             EGL_NONE};
    EGLConfig config = nullptr;
    EGLint count = 0;
    eglChooseConfig(display, wanted, &config, 1, &count);
    const EGLint version[] = {EGL_CONTEXT_MAJOR_VERSION, 3, EGL_CONTEXT_MINOR_VERSION, 3, EGL_NONE};
    context = eglCreateContext(display, count ? config : nullptr, EGL_NO_CONTEXT, version);
    if (context == EGL_NO_CONTEXT || !eglMakeCurrent(display, EGL_NO_SURFACE, EGL_NO_SURFACE, context))
      throw Error("OpenGL 3.3 is not to be had on this machine");
  }

  void make_targets() {
    glGenFramebuffers(1, &drawn);
    glGenFramebuffers(1, &resolved);
    glGenRenderbuffers(3, buffers);
    glBindFramebuffer(GL_FRAMEBUFFER, drawn);
    glBindRenderbuffer(GL_RENDERBUFFER, buffers[0]);
    glRenderbufferStorageMultisample(GL_RENDERBUFFER, 4, GL_RGBA8, width, height);
    glFramebufferRenderbuffer(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_RENDERBUFFER, buffers[0]);
    glBindRenderbuffer(GL_RENDERBUFFER, buffers[1]);
    glRenderbufferStorageMultisample(GL_RENDERBUFFER, 4, GL_DEPTH_COMPONENT24, width, height);
    glFramebufferRenderbuffer(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_RENDERBUFFER, buffers[1]);
    glBindFramebuffer(GL_FRAMEBUFFER, resolved);
    glBindRenderbuffer(GL_RENDERBUFFER, buffers[2]);
    glRenderbufferStorage(GL_RENDERBUFFER, GL_RGBA8, width, height);
    glFramebufferRenderbuffer(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_RENDERBUFFER, buffers[2]);
    if (glCheckFramebufferStatus(GL_FRAMEBUFFER) != GL_FRAMEBUFFER_COMPLETE)
      throw Error("pictures of " + std::to_string(width) + " x " + std::to_string(height) +
                  " are too large for OpenGL here");
  }

  void make_arrays() {
    glGenVertexArrays(1, &array);
    glBindVertexArray(array);
    glGenBuffers(1, &vertices);
    glGenBuffers(1, &indices);
    glBindBuffer(GL_ARRAY_BUFFER, vertices);
    glBindBuffer(GL_ELEMENT_ARRAY_BUFFER, indices);
    for (GLuint k = 0; k < 3; ++k) {
      glEnableVertexAttribArray(k);
      glVertexAttribPointer(k, 3, GL_FLOAT, GL_FALSE, 36,
                            reinterpret_cast<void*>(static_cast<uintptr_t>(12 * k)));
    }
  }

  void set_matrices(GLuint program, const Camera& camera) const {
    const Mat4 eye = look(camera);
    const Eigen::Matrix4f to_eye = eye.cast<float>();
    const Eigen::Matrix4f to_clip =
        (perspective(camera, static_cast<double>(width) / height) * eye).cast<float>();
    glUseProgram(program);
    glUniformMatrix4fv(glGetUniformLocation(program, "to_eye"), 1, GL_FALSE, to_eye.data());
    glUniformMatrix4fv(glGetUniformLocation(program, "to_clip"), 1, GL_FALSE, to_clip.data());
  }

  void draw_surface(const DrawSurface& surface) const {
    const std::vector<Vec3> normals = seamless_normals(surface);
    const std::vector<float> data =
        interleave(surface.positions, normals, surface.vertex_colours, surface.colour);
    glBufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(data.size() * 4), data.data(), GL_STREAM_DRAW);
    glBufferData(GL_ELEMENT_ARRAY_BUFFER, static_cast<GLsizeiptr>(surface.triangles.size() * 12),
                 surface.triangles.data(), GL_STREAM_DRAW);
    glUniform1f(glGetUniformLocation(surface_program, "opacity"), static_cast<float>(surface.opacity));
    glUniform1f(glGetUniformLocation(surface_program, "shine"), static_cast<float>(surface.shine));
    if (surface.is_two_sided)
      glDisable(GL_CULL_FACE);
    else
      glEnable(GL_CULL_FACE);
    glDrawElements(GL_TRIANGLES, static_cast<GLsizei>(surface.triangles.size() * 3), GL_UNSIGNED_INT,
                   nullptr);
  }

  void draw_lines(const DrawLines& bundle) const {
    glLineWidth(static_cast<float>(bundle.width));
    glUniform1f(glGetUniformLocation(line_program, "opacity"), 1.0F);
    for (const auto& line : bundle.lines) {
      const std::vector<float> data = interleave(line, {}, {}, bundle.colour);
      glBufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(data.size() * 4), data.data(), GL_STREAM_DRAW);
      glDrawArrays(GL_LINE_STRIP, 0, static_cast<GLsizei>(line.size()));
    }
  }
};

Renderer::Renderer(int width, int height) : state_(std::make_unique<State>()) {
  if (width < 1 || height < 1 || width > 8192 || height > 8192)
    throw Error("a picture must be 1 to 8192 pixels wide and high");
  state_->width = width;
  state_->height = height;
  state_->make_context();
  state_->surface_program = link(surface_source);
  state_->line_program = link(line_source);
  state_->make_targets();
  state_->make_arrays();
}

Renderer::~Renderer() {
  if (state_->context != EGL_NO_CONTEXT) {
    eglMakeCurrent(state_->display, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
    eglDestroyContext(state_->display, state_->context);
  }
  // The display stays initialised: other renderers of this process share it.
}

Image Renderer::draw(const DrawList& list, const Camera& camera, Colour background) const {
  eglMakeCurrent(state_->display, EGL_NO_SURFACE, EGL_NO_SURFACE, state_->context);
  glBindFramebuffer(GL_FRAMEBUFFER, state_->drawn);
  glViewport(0, 0, state_->width, state_->height);
  glClearColor(background[0] / 255.0F, background[1] / 255.0F, background[2] / 255.0F, 1.0F);
  glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
  glEnable(GL_DEPTH_TEST);
  glDisable(GL_BLEND);
  state_->set_matrices(state_->surface_program, camera);
  for (const DrawSurface& surface : list.surfaces)
    if (surface.opacity >= 1.0 && !surface.triangles.empty()) state_->draw_surface(surface);
  state_->set_matrices(state_->line_program, camera);
  for (const DrawLines& bundle : list.lines)
    state_->draw_lines(bundle);
  // Glass last: its depth first, so that only its nearest side is blended.
  state_->set_matrices(state_->surface_program, camera);
  for (const DrawSurface& surface : list.surfaces) {
    if (surface.opacity >= 1.0 || surface.triangles.empty()) continue;
    glColorMask(GL_FALSE, GL_FALSE, GL_FALSE, GL_FALSE);
    state_->draw_surface(surface);
    glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
    glEnable(GL_BLEND);
    glBlendFunc(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA);
    glDepthFunc(GL_LEQUAL);
    state_->draw_surface(surface);
    glDepthFunc(GL_LESS);
    glDisable(GL_BLEND);
  }
  glBindFramebuffer(GL_READ_FRAMEBUFFER, state_->drawn);
  glBindFramebuffer(GL_DRAW_FRAMEBUFFER, state_->resolved);
  glBlitFramebuffer(0, 0, state_->width, state_->height, 0, 0, state_->width, state_->height,
                    GL_COLOR_BUFFER_BIT, GL_NEAREST);
  glBindFramebuffer(GL_READ_FRAMEBUFFER, state_->resolved);
  Image image(state_->width, state_->height, background), flipped = image;
  glPixelStorei(GL_PACK_ALIGNMENT, 1);
  glReadPixels(0, 0, state_->width, state_->height, GL_RGB, GL_UNSIGNED_BYTE, flipped.pixels.data());
  const size_t row = static_cast<size_t>(state_->width) * 3;
  for (int y = 0; y < state_->height; ++y)
    std::copy_n(flipped.pixels.begin() +
                    static_cast<std::ptrdiff_t>(row * static_cast<size_t>(state_->height - 1 - y)),
                row, image.pixels.begin() + static_cast<std::ptrdiff_t>(row * static_cast<size_t>(y)));
  return image;
}

}  // namespace fascia::view
