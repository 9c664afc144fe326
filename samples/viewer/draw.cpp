#include "draw.h"

#include <algorithm>
#include <cmath>

#if defined(__GNUC__)
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wmissing-field-initializers"
#endif
#define STB_IMAGE_WRITE_IMPLEMENTATION
#define STB_IMAGE_WRITE_STATIC
#include <stb/stb_image_write.h>
#if defined(__GNUC__)
#pragma GCC diagnostic pop
#endif

namespace {

using Matrix = std::array<float, 16>;  // column-major

constexpr const char* vertex_shader = R"(#version 330 core
layout(location = 0) in vec3 position;
layout(location = 1) in vec3 normal;
uniform mat4 model, view, projection;
out vec3 towards, facing;
void main() {
  vec4 place = view * model * vec4(position, 1.0);
  towards = -place.xyz;
  facing = mat3(view * model) * normal;
  gl_Position = projection * place;
})";

constexpr const char* fragment_shader = R"(#version 330 core
in vec3 towards, facing;
uniform vec4 colour;
uniform bool lit;
out vec4 pixel;
void main() {
  if (!lit) { pixel = colour; return; }
  vec3 n = normalize(facing), v = normalize(towards);
  if (dot(n, v) < 0.0) n = -n;
  float key = max(dot(n, normalize(vec3(0.5, 0.6, 0.8))), 0.0), fill = max(dot(n, normalize(vec3(-0.8, 0.1, 0.5))), 0.0);
  float gloss = pow(max(dot(n, normalize(normalize(vec3(0.5, 0.6, 0.8)) + v)), 0.0), 40.0);
  pixel = vec4(colour.rgb * (0.22 + 0.7 * key + 0.25 * fill) + 0.08 * gloss, colour.a);
})";

GLuint compiled(GLenum kind, const char* text) {
  const GLuint shader = glCreateShader(kind);
  glShaderSource(shader, 1, &text, nullptr);
  glCompileShader(shader);
  GLint good = 0;
  glGetShaderiv(shader, GL_COMPILE_STATUS, &good);
  if (good == 0) {
    char log[1024] = "";
    glGetShaderInfoLog(shader, sizeof log, nullptr, log);
    throw std::runtime_error(std::string("shader: ") + log);
  }
  return shader;
}

Matrix identity() {
  return {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};
}

Matrix perspective(float height, float aspect, float near, float far) {
  Matrix m = {};
  m[0] = 1.0F / (height * aspect);
  m[5] = 1.0F / height;
  m[8] = -0.33F;  // the panel covers the left third
  m[10] = (near + far) / (near - far);
  m[11] = -1;
  m[14] = 2 * near * far / (near - far);
  return m;
}

Matrix view_of(const Orbit& orbit) {
  const float cy = std::cos(orbit.yaw), sy = std::sin(orbit.yaw), cp = std::cos(orbit.pitch),
              sp = std::sin(orbit.pitch);
  // Rows: the camera's right, up and backward axes.
  const float rows[3][3] = {{cy, 0, -sy}, {-sy * sp, cp, -cy * sp}, {sy * cp, sp, cy * cp}};
  Matrix m = identity();
  for (std::size_t r = 0; r < 3; ++r) {
    float shift = 0;
    for (std::size_t c = 0; c < 3; ++c) {
      m[c * 4 + r] = rows[r][c];
      shift -= rows[r][c] * orbit.target[c];
    }
    m[12 + r] = shift - (r == 2 ? orbit.distance : 0.0F);
  }
  return m;
}

/// Area-weighted vertex normals of a surface that does not move.
std::vector<float> smooth_normals(const fascia_surface& surface) {
  std::vector<float> normals(3 * surface.vertex_count, 0.0F);
  const float* p = surface.positions;
  for (uint32_t t = 0; t < surface.triangle_count; ++t) {
    const uint32_t* corner = surface.triangles + 3 * t;
    float a[3], b[3];
    for (int k = 0; k < 3; ++k) {
      a[k] = p[3 * corner[1] + k] - p[3 * corner[0] + k];
      b[k] = p[3 * corner[2] + k] - p[3 * corner[0] + k];
    }
    const float n[3] = {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
    for (int c = 0; c < 3; ++c)
      for (int k = 0; k < 3; ++k)
        normals[3 * corner[c] + k] += n[k];
  }
  return normals;
}

}  // namespace

Drawing::Part Drawing::make_part(const uint32_t* indices, std::size_t count) {
  Part part;
  part.count = static_cast<GLsizei>(count);
  glGenVertexArrays(1, &part.array);
  glBindVertexArray(part.array);
  GLuint buffers[3];
  glGenBuffers(3, buffers);
  part.positions = buffers[0];
  part.normals = buffers[1];
  part.indices = buffers[2];
  for (GLuint attribute = 0; attribute < 2; ++attribute) {
    glBindBuffer(GL_ARRAY_BUFFER, buffers[attribute]);
    glVertexAttribPointer(attribute, 3, GL_FLOAT, GL_FALSE, 0, nullptr);
    glEnableVertexAttribArray(attribute);
  }
  glBindBuffer(GL_ELEMENT_ARRAY_BUFFER, part.indices);
  glBufferData(GL_ELEMENT_ARRAY_BUFFER, static_cast<GLsizeiptr>(count * sizeof(uint32_t)), indices,
               GL_STATIC_DRAW);
  return part;
}

void Drawing::fill(GLuint buffer, const float* numbers, std::size_t count) {
  glBindBuffer(GL_ARRAY_BUFFER, buffer);
  glBufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(count * sizeof(float)), numbers, GL_STREAM_DRAW);
}

Drawing::Part Drawing::surface_part(const Scene& scene, const char* name) const {
  fascia_surface surface = described<fascia_surface>();
  check(fascia_asset_surface(scene.asset.get(), name, &surface), name);
  Part part = make_part(surface.triangles, std::size_t{3} * surface.triangle_count);
  const std::vector<float> normals = smooth_normals(surface);
  fill(part.positions, surface.positions, normals.size());
  fill(part.normals, normals.data(), normals.size());
  return part;
}

Drawing::Drawing(const Scene& scene) {
  program_ = glCreateProgram();
  glAttachShader(program_, compiled(GL_VERTEX_SHADER, vertex_shader));
  glAttachShader(program_, compiled(GL_FRAGMENT_SHADER, fragment_shader));
  glLinkProgram(program_);
  for (uint32_t m = 0; m < scene.meshes.size(); ++m) {
    skin_.push_back(make_part(scene.meshes[m].triangles, std::size_t{3} * scene.meshes[m].triangle_count));
    fascia_vectors positions = described<fascia_vectors>();
    check(fascia_face_positions(scene.face.get(), m, &positions), "positions");
    for (uint32_t v = 0; v < positions.count; ++v)
      for (std::size_t k = 0; k < 3; ++k) {
        lower_[k] = std::min(lower_[k], positions.data[3 * v + k]);
        upper_[k] = std::max(upper_[k], positions.data[3 * v + k]);
      }
  }
  cranium_ = surface_part(scene, "cranium");
  mandible_ = surface_part(scene, "mandible");
  teeth_upper_ = surface_part(scene, "teeth_upper");
  teeth_lower_ = surface_part(scene, "teeth_lower");
  smas_ = surface_part(scene, "smas");
  std::vector<uint32_t> lines;
  for (uint32_t f = 0; f < scene.fibres.fibre_count; ++f)
    for (uint32_t p = scene.fibres.offsets[f]; p + 1 < scene.fibres.offsets[f + 1]; ++p)
      lines.insert(lines.end(), {p, p + 1});
  fibres_ = make_part(lines.data(), lines.size());
}

Drawing::~Drawing() {
  std::vector<Part> parts = skin_;
  parts.insert(parts.end(), {cranium_, mandible_, teeth_upper_, teeth_lower_, smas_, fibres_});
  for (const Part& part : parts) {
    const GLuint buffers[3] = {part.positions, part.normals, part.indices};
    glDeleteBuffers(3, buffers);
    glDeleteVertexArrays(1, &part.array);
  }
  glDeleteProgram(program_);
}

Orbit Drawing::first_view() const {
  Orbit orbit;
  float size = 0.05F;
  for (std::size_t k = 0; k < 3; ++k) {
    if (lower_[k] > upper_[k]) continue;
    orbit.target[k] = 0.5F * (lower_[k] + upper_[k]);
    size = std::max(size, upper_[k] - lower_[k]);
  }
  orbit.distance = 2.0F * size;
  return orbit;
}

void Drawing::colour(float red, float green, float blue, float alpha, bool lit) const {
  glUniform4f(glGetUniformLocation(program_, "colour"), red, green, blue, alpha);
  glUniform1i(glGetUniformLocation(program_, "lit"), lit ? 1 : 0);
}

void Drawing::draw(const Scene& scene, const Layers& layers, const Orbit& orbit, int width, int height) {
  glViewport(0, 0, width, height);
  glClearColor(0.12F, 0.13F, 0.15F, 1);
  glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
  glEnable(GL_DEPTH_TEST);
  glEnable(GL_BLEND);
  glBlendFunc(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA);
  glUseProgram(program_);
  const auto matrix = [&](const char* name, const float* values) {
    glUniformMatrix4fv(glGetUniformLocation(program_, name), 1, GL_FALSE, values);
  };
  const Matrix still = identity();
  const float aspect = static_cast<float>(width) / static_cast<float>(std::max(height, 1));
  matrix("projection", perspective(0.27F, aspect, 0.05F * orbit.distance, 20.0F * orbit.distance).data());
  matrix("view", view_of(orbit).data());
  matrix("model", still.data());
  const auto show = [](const Part& part, GLenum kind) {
    glBindVertexArray(part.array);
    glDrawElements(kind, part.count, GL_UNSIGNED_INT, nullptr);
  };

  if (layers.skull) {
    colour(0.87F, 0.83F, 0.72F, 1, true);
    show(cranium_, GL_TRIANGLES);
    colour(0.95F, 0.94F, 0.9F, 1, true);
    show(teeth_upper_, GL_TRIANGLES);
    Matrix jaw = still;
    check(fascia_face_jaw(scene.face.get(), jaw.data()), "jaw");
    matrix("model", jaw.data());
    show(teeth_lower_, GL_TRIANGLES);
    colour(0.87F, 0.83F, 0.72F, 1, true);
    show(mandible_, GL_TRIANGLES);
    matrix("model", still.data());
  }
  if (layers.smas) {
    colour(0.85F, 0.8F, 0.55F, 0.8F, true);
    show(smas_, GL_TRIANGLES);
  }
  if (layers.fibres) {
    fascia_vectors points = described<fascia_vectors>();
    check(fascia_face_fibre_points(scene.face.get(), &points), "fibres");
    fill(fibres_.positions, points.data, std::size_t{3} * points.count);
    fill(fibres_.normals, points.data, std::size_t{3} * points.count);
    colour(0.8F, 0.15F, 0.12F, 1, false);
    show(fibres_, GL_LINES);
  }
  if (!layers.skin) return;
  glPolygonMode(GL_FRONT_AND_BACK, layers.wireframe ? GL_LINE : GL_FILL);
  for (uint32_t m = 0; m < skin_.size(); ++m) {
    fascia_vectors positions = described<fascia_vectors>(), normals = described<fascia_vectors>();
    check(fascia_face_positions(scene.face.get(), m, &positions), "positions");
    check(fascia_face_normals(scene.face.get(), m, &normals), "normals");
    fill(skin_[m].positions, positions.data, std::size_t{3} * positions.count);
    fill(skin_[m].normals, normals.data, std::size_t{3} * normals.count);
    colour(0.82F, 0.62F, 0.53F, layers.skin_opacity, true);
    show(skin_[m], GL_TRIANGLES);
  }
  glPolygonMode(GL_FRONT_AND_BACK, GL_FILL);
}

void write_screenshot(const std::string& path, int width, int height) {
  std::vector<unsigned char> pixels(static_cast<std::size_t>(width) * static_cast<std::size_t>(height) * 3);
  glPixelStorei(GL_PACK_ALIGNMENT, 1);
  glReadPixels(0, 0, width, height, GL_RGB, GL_UNSIGNED_BYTE, pixels.data());
  stbi_flip_vertically_on_write(1);
  if (stbi_write_png(path.c_str(), width, height, 3, pixels.data(), width * 3) == 0)
    throw std::runtime_error("cannot write " + path);
}
