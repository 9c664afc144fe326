// Wrinkles that follow the muscles: draws a posed head without a window, once with its skin as it is and once
// with wrinkles where the skin is compressed (wrinkles.glsl).
//   sample_wrinkles RIG.glb PICTURE.png [NAME=VALUE ...]      say frontalis_medial_left=1 or
//   arkit:browInnerUp=1
// Exit 77 where there is no OpenGL.
#include <epoxy/egl.h>
#include <epoxy/gl.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fascia/fascia.hpp>
#include <fstream>
#include <iterator>
#include <stdexcept>
#include <string>
#include <vector>

#define STB_IMAGE_WRITE_IMPLEMENTATION
#define STB_IMAGE_WRITE_STATIC
#include <stb/stb_image_write.h>

namespace {

namespace api = fascia::api;
constexpr int width = 560, height = 700;
using Pixels = std::vector<unsigned char>;

// The frame of the tangent map lies level: its first axis runs across the face, its second up. A head with
// texture coordinates would have fascia_face_tangents here.
constexpr const char* vertex_stage = R"(
layout(location = 0) in vec3 position;
layout(location = 1) in vec3 normal;
layout(location = 2) in vec3 rest;
layout(location = 3) in vec3 rest_normal;
layout(location = 4) in vec3 compression;
uniform vec3 centre;
uniform float reach;
out vec3 facing, place;
out vec2 wrinkle;
vec3 across(vec3 n) { return normalize(cross(vec3(0, 1, 0), n) + vec3(1e-6, 0, 0)); }
vec3 turned(vec3 p) { return vec3(0.92 * p.x - 0.39 * p.z, p.y, 0.39 * p.x + 0.92 * p.z); }
void main() {
  vec3 tangent = across(rest_normal);
  wrinkle = fascia_wrinkle_amount(compression, tangent, cross(rest_normal, tangent));
  facing = normal;
  place = rest;
  vec3 p = turned(position - centre) / reach;
  gl_Position = vec4(p.x * 1.25, p.y, -0.3 * p.z, 1.0);
})";

constexpr const char* fragment_stage = R"(
in vec3 facing, place;
in vec2 wrinkle;
uniform vec3 colour;
uniform float strength;
out vec4 pixel;
// Furrows 6 mm apart as a normal map: `along` counts the metres across them.
vec3 furrows(float along, float sideways, bool is_first_axis) {
  float d = fract(along / 0.006 + 0.2 * sin(160.0 * sideways)) - 0.5;
  float slope = 9.0 * d * exp(-40.0 * d * d);
  vec3 n = normalize(is_first_axis ? vec3(-slope, 0, 1) : vec3(0, -slope, 1));
  return 0.5 + 0.5 * n;
}
void main() {
  vec3 n = normalize(facing), tangent = normalize(cross(vec3(0, 1, 0), n) + vec3(1e-6, 0, 0));
  vec3 m = fascia_wrinkled_normal(vec3(0.5, 0.5, 1.0), furrows(place.x, place.y, true), furrows(place.y, place.x, false),
                                  strength * wrinkle);
  n = mat3(tangent, cross(n, tangent), n) * m;
  float key = max(dot(n, normalize(vec3(0.4, 0.8, 0.6))), 0.0), fill = max(dot(n, normalize(vec3(-0.8, 0.0, 0.6))), 0.0);
  pixel = vec4(colour * (0.34 + 0.72 * key + 0.25 * fill), 1.0);
})";

// A context without a window.
bool make_context() {
  const EGLDisplay display =
      eglGetPlatformDisplayEXT(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, nullptr);
  if (display == EGL_NO_DISPLAY || !eglInitialize(display, nullptr, nullptr)) return false;
  eglBindAPI(EGL_OPENGL_API);
  const EGLint wanted[] = {EGL_SURFACE_TYPE, EGL_PBUFFER_BIT, EGL_RENDERABLE_TYPE, EGL_OPENGL_BIT, EGL_NONE};
  EGLConfig config = nullptr;
  EGLint count = 0;
  if (!eglChooseConfig(display, wanted, &config, 1, &count) || count == 0) return false;
  const EGLint version[] = {EGL_CONTEXT_MAJOR_VERSION, 3, EGL_CONTEXT_MINOR_VERSION, 3, EGL_NONE};
  const EGLContext context = eglCreateContext(display, config, EGL_NO_CONTEXT, version);
  return context != EGL_NO_CONTEXT && eglMakeCurrent(display, EGL_NO_SURFACE, EGL_NO_SURFACE, context);
}

void make_target() {
  GLuint frame = 0, targets[2] = {};
  glGenFramebuffers(1, &frame);
  glBindFramebuffer(GL_FRAMEBUFFER, frame);
  glGenRenderbuffers(2, targets);
  const GLenum formats[] = {GL_RGB8, GL_DEPTH_COMPONENT24},
               places[] = {GL_COLOR_ATTACHMENT0, GL_DEPTH_ATTACHMENT};
  for (int i = 0; i < 2; ++i) {
    glBindRenderbuffer(GL_RENDERBUFFER, targets[i]);
    glRenderbufferStorage(GL_RENDERBUFFER, formats[i], width, height);
    glFramebufferRenderbuffer(GL_FRAMEBUFFER, places[i], GL_RENDERBUFFER, targets[i]);
  }
  glViewport(0, 0, width, height);
  glEnable(GL_DEPTH_TEST);
}

std::string text_of(const char* path) {
  std::ifstream file(path, std::ios::binary);
  if (!file) throw std::runtime_error(std::string(path) + " cannot be read");
  return {std::istreambuf_iterator<char>(file), {}};
}

GLuint make_program() {
  const std::string functions = text_of(WRINKLES_GLSL);
  const GLuint program = glCreateProgram();
  for (const auto& [kind, stage] :
       {std::pair{GL_VERTEX_SHADER, vertex_stage}, {GL_FRAGMENT_SHADER, fragment_stage}}) {
    const std::string source = "#version 330 core\n" + functions + stage;
    const char* text = source.c_str();
    const GLuint shader = glCreateShader(static_cast<GLenum>(kind));
    glShaderSource(shader, 1, &text, nullptr);
    glCompileShader(shader);
    GLint is_good = 0;
    glGetShaderiv(shader, GL_COMPILE_STATUS, &is_good);
    char log[1000] = "";
    glGetShaderInfoLog(shader, sizeof log, nullptr, log);
    if (is_good == 0) throw std::runtime_error(log);
    glAttachShader(program, shader);
  }
  glLinkProgram(program);
  GLint is_linked = 0;
  glGetProgramiv(program, GL_LINK_STATUS, &is_linked);
  if (is_linked == 0) throw std::runtime_error("the shaders do not link");
  return program;
}

// A mesh of the rig in vertex buffers. Rest is taken from a face that has not moved.
struct Part {
  Part(api::Face& rest, api::Face& posed, std::uint32_t index) {
    const fascia_mesh_info mesh = posed.asset().mesh(index);
    is_skin = std::strcmp(mesh.part, "skin") == 0;
    count = static_cast<GLsizei>(3 * mesh.triangle_count);
    glGenVertexArrays(1, &array);
    glBindVertexArray(array);
    attribute(0, posed.positions(index));
    attribute(1, posed.normals(index));
    attribute(2, rest.positions(index));
    attribute(3, rest.normals(index));
    attribute(4, posed.compression(index));
    GLuint triangles = 0;
    glGenBuffers(1, &triangles);
    glBindBuffer(GL_ELEMENT_ARRAY_BUFFER, triangles);
    glBufferData(GL_ELEMENT_ARRAY_BUFFER, count * static_cast<GLsizeiptr>(sizeof(std::uint32_t)),
                 mesh.triangles, GL_STATIC_DRAW);
  }
  static void attribute(GLuint place, std::span<const api::Vector3> vectors) {
    GLuint buffer = 0;
    glGenBuffers(1, &buffer);
    glBindBuffer(GL_ARRAY_BUFFER, buffer);
    glBufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(vectors.size_bytes()), vectors.data(),
                 GL_STATIC_DRAW);
    glVertexAttribPointer(place, 3, GL_FLOAT, GL_FALSE, 0, nullptr);
    glEnableVertexAttribArray(place);
  }
  GLuint array = 0;
  GLsizei count = 0;
  bool is_skin = false;
};

// Where the skin lies: the middle of its box, and half its height.
struct Frame {
  explicit Frame(api::Face& face) {
    api::Vector3 low = {1e9F, 1e9F, 1e9F}, high = {-1e9F, -1e9F, -1e9F};
    for (std::uint32_t mesh = 0; mesh < face.asset().info().mesh_count; ++mesh)
      for (const api::Vector3& p : face.positions(mesh))
        for (std::size_t k = 0; k < 3; ++k) {
          low[k] = std::min(low[k], p[k]);
          high[k] = std::max(high[k], p[k]);
        }
    for (std::size_t k = 0; k < 3; ++k)
      centre[k] = (low[k] + high[k]) / 2;
    reach = 0.54F * (high[1] - low[1]);
  }
  api::Vector3 centre = {};
  float reach = 1;
};

Pixels draw(GLuint program, const std::vector<Part>& parts, const Frame& frame, float strength) {
  glClearColor(0.93F, 0.93F, 0.92F, 1);
  glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
  glUseProgram(program);
  glUniform3fv(glGetUniformLocation(program, "centre"), 1, frame.centre.data());
  glUniform1f(glGetUniformLocation(program, "reach"), frame.reach);
  for (const Part& part : parts) {
    glUniform1f(glGetUniformLocation(program, "strength"), part.is_skin ? strength : 0);
    if (part.is_skin)
      glUniform3f(glGetUniformLocation(program, "colour"), 0.86F, 0.66F, 0.57F);
    else
      glUniform3f(glGetUniformLocation(program, "colour"), 0.9F, 0.89F, 0.86F);
    glBindVertexArray(part.array);
    glDrawElements(GL_TRIANGLES, part.count, GL_UNSIGNED_INT, nullptr);
  }
  Pixels pixels(std::size_t{3} * width * height);
  glPixelStorei(GL_PACK_ALIGNMENT, 1);
  glReadPixels(0, 0, width, height, GL_RGB, GL_UNSIGNED_BYTE, pixels.data());
  if (glGetError() != GL_NO_ERROR) throw std::runtime_error("OpenGL reports an error");
  return pixels;
}

// Pixels in which a colour differs by more than a twelfth.
std::size_t changed(const Pixels& a, const Pixels& b) {
  std::size_t count = 0;
  for (std::size_t i = 0; i < a.size(); i += 3)
    count += std::abs(a[i] - b[i]) > 20 || std::abs(a[i + 1] - b[i + 1]) > 20 ||
             std::abs(a[i + 2] - b[i + 2]) > 20;
  return count;
}

void write_beside(const char* path, const Pixels& left, const Pixels& right) {
  Pixels both;
  for (int row = height - 1; row >= 0; --row)  // OpenGL's first row is the lowest
    for (const Pixels* each : {&left, &right}) {
      const auto begin = each->begin() + std::ptrdiff_t{3} * row * width;
      both.insert(both.end(), begin, begin + std::ptrdiff_t{3} * width);
    }
  if (stbi_write_png(path, 2 * width, height, 3, both.data(), 0) == 0)
    throw std::runtime_error(std::string(path) + " cannot be written");
}

void run(int argc, char** argv) {
  const std::string bytes = text_of(argv[1]);
  const api::Asset asset =
      api::Asset::load({reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size()});
  fascia_face_options options = fascia_default_face_options();
  options.space = FASCIA_SPACE_METRES;  // the axes of compression
  api::Face rest(asset, options), posed(asset, options);
  for (int i = 3; i < argc; ++i) {
    const std::string word = argv[i];
    const std::size_t sign = word.find('=');
    if (sign == std::string::npos) throw std::runtime_error(word + " is not NAME=VALUE");
    posed.set(word.substr(0, sign), std::strtof(word.c_str() + sign + 1, nullptr));
  }
  posed.pose();

  make_target();
  const GLuint program = make_program();
  std::vector<Part> parts;
  for (std::uint32_t mesh = 0; mesh < asset.info().mesh_count; ++mesh)
    parts.emplace_back(rest, posed, mesh);
  const Frame frame(rest);
  const Pixels smooth = draw(program, parts, frame, 0), wrinkled = draw(program, parts, frame, 1);
  write_beside(argv[2], smooth, wrinkled);
  std::printf("wrinkles change %zu pixels\n", changed(smooth, wrinkled));
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 3) {
    std::fprintf(stderr, "usage: sample_wrinkles RIG.glb PICTURE.png [NAME=VALUE ...]\n");
    return 2;
  }
  if (!make_context()) {
    std::puts("no OpenGL without a window here");
    return 77;
  }
  try {
    run(argc, argv);
    return 0;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "sample_wrinkles: %s\n", error.what());
    return 1;
  }
}
