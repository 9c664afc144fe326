// skinning.glsl on the graphics card (or Mesa's software one) against the runtime's own vertices.
#include <epoxy/egl.h>
#include <epoxy/gl.h>
#include <gtest/gtest.h>

#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include "tests/runtime/skinned_rig.h"

namespace {

using namespace fascia::test;

/// A context without a window; not `ready` where the system has none.
struct Context {
  Context() {
    display = eglGetPlatformDisplayEXT(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, nullptr);
    if (display == EGL_NO_DISPLAY || !eglInitialize(display, nullptr, nullptr)) return;
    eglBindAPI(EGL_OPENGL_API);
    const EGLint config_wants[] = {EGL_SURFACE_TYPE, EGL_PBUFFER_BIT, EGL_RENDERABLE_TYPE, EGL_OPENGL_BIT,
                                   EGL_NONE};
    EGLConfig config = nullptr;
    EGLint count = 0;
    if (!eglChooseConfig(display, config_wants, &config, 1, &count) || count == 0) return;
    const EGLint wants[] = {EGL_CONTEXT_MAJOR_VERSION, 3, EGL_CONTEXT_MINOR_VERSION, 3, EGL_NONE};
    context = eglCreateContext(display, config, EGL_NO_CONTEXT, wants);
    ready = context != EGL_NO_CONTEXT && eglMakeCurrent(display, EGL_NO_SURFACE, EGL_NO_SURFACE, context);
  }
  ~Context() {
    if (context != EGL_NO_CONTEXT) eglDestroyContext(display, context);
  }
  Context(const Context&) = delete;
  Context& operator=(const Context&) = delete;
  EGLDisplay display = EGL_NO_DISPLAY;
  EGLContext context = EGL_NO_CONTEXT;
  bool ready = false;
};

GLuint compiled(GLenum kind, const std::string& source) {
  const GLuint shader = glCreateShader(kind);
  const char* text = source.c_str();
  glShaderSource(shader, 1, &text, nullptr);
  glCompileShader(shader);
  GLint good = 0;
  glGetShaderiv(shader, GL_COMPILE_STATUS, &good);
  char log[1000] = {};
  glGetShaderInfoLog(shader, sizeof log, nullptr, log);
  EXPECT_TRUE(good) << log;
  return shader;
}

GLuint program_with_feedback() {
  std::ifstream file(FASCIA_SHADERS "/skinning.glsl");
  std::ostringstream functions;
  functions << file.rdbuf();
  const GLuint vertex = compiled(GL_VERTEX_SHADER, "#version 330 core\n" + functions.str() + R"(
layout(location = 0) in vec3 rest;
layout(location = 1) in uvec4 nodes;
layout(location = 2) in vec4 weights;
layout(location = 3) in float jaw;
layout(location = 4) in uint eye;
out vec3 place;
void main() { place = fascia_place(rest, fascia_pull(nodes, weights), jaw, eye); })");
  const GLuint program = glCreateProgram();
  glAttachShader(program, vertex);
  const char* outputs[] = {"place"};
  glTransformFeedbackVaryings(program, 1, outputs, GL_INTERLEAVED_ATTRIBS);
  glLinkProgram(program);
  GLint good = 0;
  glGetProgramiv(program, GL_LINK_STATUS, &good);
  EXPECT_TRUE(good);
  return program;
}

template <class T>
GLuint buffer_of(const T* data, std::size_t count) {
  GLuint buffer = 0;
  glGenBuffers(1, &buffer);
  glBindBuffer(GL_ARRAY_BUFFER, buffer);
  glBufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(count * sizeof(T)), data, GL_STATIC_DRAW);
  return buffer;
}

std::vector<float> skinned_on_the_card(const Skinned& data) {
  const fascia_skinning& skinning = data.skinning;
  const GLuint program = program_with_feedback();
  GLuint array = 0, texture = 0;
  glGenVertexArrays(1, &array);
  glBindVertexArray(array);
  const std::size_t count = skinning.vertex_count;
  buffer_of(skinning.rest, 3 * count);
  glVertexAttribPointer(0, 3, GL_FLOAT, GL_FALSE, 0, nullptr);
  buffer_of(skinning.nodes, 4 * count);
  glVertexAttribIPointer(1, 4, GL_UNSIGNED_INT, 0, nullptr);
  buffer_of(skinning.weights, 4 * count);
  glVertexAttribPointer(2, 4, GL_FLOAT, GL_FALSE, 0, nullptr);
  buffer_of(skinning.jaw, count);
  glVertexAttribPointer(3, 1, GL_FLOAT, GL_FALSE, 0, nullptr);
  buffer_of(skinning.eyes, count);
  glVertexAttribIPointer(4, 1, GL_UNSIGNED_INT, 0, nullptr);
  for (GLuint i = 0; i < 5; ++i)
    glEnableVertexAttribArray(i);
  constexpr GLsizei width = 64;
  const GLsizei height = (static_cast<GLsizei>(skinning.node_count) + width - 1) / width;
  std::vector<float> texels(static_cast<std::size_t>(4 * width * height));
  std::copy(data.nodes.begin(), data.nodes.end(), texels.begin());
  glGenTextures(1, &texture);
  glBindTexture(GL_TEXTURE_2D, texture);
  glTexImage2D(GL_TEXTURE_2D, 0, GL_RGBA32F, width, height, 0, GL_RGBA, GL_FLOAT, texels.data());
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
  glUseProgram(program);
  glUniform1i(glGetUniformLocation(program, "fascia_nodes"), 0);
  glUniformMatrix4fv(glGetUniformLocation(program, "fascia_bones"), 3, GL_FALSE, data.bones);
  std::vector<float> places(3 * count);
  const GLuint feedback = buffer_of(places.data(), places.size());
  glBindBufferBase(GL_TRANSFORM_FEEDBACK_BUFFER, 0, feedback);
  GLuint frame = 0, target = 0;  // drawing needs a complete framebuffer, though nothing is drawn
  glGenFramebuffers(1, &frame);
  glBindFramebuffer(GL_FRAMEBUFFER, frame);
  glGenRenderbuffers(1, &target);
  glBindRenderbuffer(GL_RENDERBUFFER, target);
  glRenderbufferStorage(GL_RENDERBUFFER, GL_RGBA8, 4, 4);
  glFramebufferRenderbuffer(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_RENDERBUFFER, target);
  glEnable(GL_RASTERIZER_DISCARD);
  glBeginTransformFeedback(GL_POINTS);
  glDrawArrays(GL_POINTS, 0, static_cast<GLsizei>(count));
  glEndTransformFeedback();
  glFinish();
  glGetBufferSubData(GL_TRANSFORM_FEEDBACK_BUFFER, 0, static_cast<GLsizeiptr>(places.size() * sizeof(float)),
                     places.data());
  EXPECT_EQ(glGetError(), static_cast<GLenum>(GL_NO_ERROR));
  return places;
}

TEST(Shader, SkinsAsTheRuntimeDoes) {
  const Context context;
  if (!context.ready) GTEST_SKIP() << "no OpenGL without a window here";
  const Loaded rig(rig_with_bones());
  const Face face(rig.asset, FASCIA_SPACE_METRES);
  drive_everything(face.face);
  const Skinned data(face.face);
  ASSERT_EQ(data.skinning.influences, 4U);
  const std::vector<float> positions = face.positions(), on_card = skinned_on_the_card(data);
  EXPECT_GT(largest_motion(positions, {data.skinning.rest, data.skinning.rest + positions.size()}), 5e-3);
  EXPECT_LT(largest_motion(positions, on_card), 1e-5);
}

}  // namespace
