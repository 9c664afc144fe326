#include "view/surface_buffers.h"

#include <algorithm>

#include "geometry/error.h"
#include "view/smooth_normals.h"

namespace fascia::view {

namespace {

constexpr size_t floats_a_vertex = 14;

void check_lists(const DrawSurface& surface) {
  const size_t count = surface.positions.size();
  const auto fits = [&](size_t size) { return size == 0 || size == count; };
  if (!fits(surface.vertex_colours.size()) || !fits(surface.uvs.size()) || !fits(surface.normals.size()) ||
      !fits(surface.eye_coordinates.size()) || (surface.seams && surface.seams->size() != count))
    throw Error("a surface to draw has lists of different lengths: give one entry a vertex, or none");
  for (const Triangle& t : surface.triangles)
    for (int corner : t)
      if (corner < 0 || static_cast<size_t>(corner) >= count)
        throw Error("a surface to draw has a triangle with a vertex that is not there");
}

void add(std::vector<float>& data, const Vec3& v) {
  for (int k = 0; k < 3; ++k)
    data.push_back(static_cast<float>(v[k]));
}

}  // namespace

VertexBuffers::VertexBuffers() {
  glGenVertexArrays(1, &array_);
  glBindVertexArray(array_);
  glGenBuffers(1, &vertices_);
  glGenBuffers(1, &indices_);
  glBindBuffer(GL_ARRAY_BUFFER, vertices_);
  glBindBuffer(GL_ELEMENT_ARRAY_BUFFER, indices_);
  const GLint sizes[] = {3, 3, 3, 2, 3};
  uintptr_t offset = 0;
  for (GLuint k = 0; k < 5; ++k) {
    glEnableVertexAttribArray(k);
    glVertexAttribPointer(k, sizes[k], GL_FLOAT, GL_FALSE, 4 * floats_a_vertex,
                          reinterpret_cast<void*>(offset));
    offset += 4 * static_cast<uintptr_t>(sizes[k]);
  }
}

VertexBuffers::~VertexBuffers() {
  glDeleteVertexArrays(1, &array_);
  glDeleteBuffers(1, &vertices_);
  glDeleteBuffers(1, &indices_);
}

void VertexBuffers::send(const std::vector<float>& data, GLsizeiptr index_bytes, const void* indices) {
  glBindVertexArray(array_);
  glBindBuffer(GL_ARRAY_BUFFER, vertices_);
  glBufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(data.size() * 4), data.data(), GL_STREAM_DRAW);
  glBufferData(GL_ELEMENT_ARRAY_BUFFER, index_bytes, indices, GL_STREAM_DRAW);
}

void VertexBuffers::upload(const DrawSurface& surface) {
  check_lists(surface);
  std::vector<Vec3> computed;
  if (surface.normals.empty())
    computed = smooth_normals(surface.positions, surface.triangles,
                              surface.seams ? *surface.seams : seams_of(surface.positions));
  const std::vector<Vec3>& normals = surface.normals.empty() ? computed : surface.normals;
  std::vector<float> data;
  data.reserve(surface.positions.size() * floats_a_vertex);
  for (size_t i = 0; i < surface.positions.size(); ++i) {
    add(data, surface.positions[i]);
    add(data, normals[i]);
    add(data, surface.vertex_colours.empty() ? surface.colour : surface.vertex_colours[i]);
    data.push_back(surface.uvs.empty() ? 0.0F : static_cast<float>(surface.uvs[i][0]));
    data.push_back(surface.uvs.empty() ? 0.0F : static_cast<float>(surface.uvs[i][1]));
    add(data, surface.eye_coordinates.empty() ? Vec3(Vec3::UnitZ()) : surface.eye_coordinates[i]);
  }
  send(data, static_cast<GLsizeiptr>(surface.triangles.size() * sizeof(Triangle)), surface.triangles.data());
  count_ = static_cast<GLsizei>(surface.triangles.size() * 3);
}

void VertexBuffers::upload(const DrawLines& bundle) {
  std::vector<float> data;
  firsts_.clear();
  counts_.clear();
  for (const std::vector<Vec3>& line : bundle.lines) {
    if (line.size() < 2) continue;
    firsts_.push_back(static_cast<GLint>(data.size() / floats_a_vertex));
    counts_.push_back(static_cast<GLsizei>(line.size()));
    for (const Vec3& p : line) {
      add(data, p);
      add(data, Vec3::UnitZ());
      add(data, bundle.colour);
      data.resize(data.size() + 5);
    }
  }
  send(data, 0, nullptr);
}

void VertexBuffers::draw_triangles() const {
  glBindVertexArray(array_);
  glDrawElements(GL_TRIANGLES, count_, GL_UNSIGNED_INT, nullptr);
}

void VertexBuffers::draw_lines() const {
  glBindVertexArray(array_);
  glMultiDrawArrays(GL_LINE_STRIP, firsts_.data(), counts_.data(), static_cast<GLsizei>(firsts_.size()));
}

TextureCache::~TextureCache() {
  for (const auto& [original, entry] : entries_)
    glDeleteTextures(1, &entry.name);
}

GLuint TextureCache::name(const std::shared_ptr<const Texture>& texture) {
  if (!texture) return 0;
  Entry& entry = entries_[texture.get()];
  if (entry.name && !entry.original.expired()) return entry.name;
  if (entry.name) glDeleteTextures(1, &entry.name);
  if (texture->width < 1 || texture->height < 1 ||
      texture->pixels.size() !=
          static_cast<size_t>(texture->width) * static_cast<size_t>(texture->height) * 4)
    throw Error("a texture's pixels do not fit its size");
  entry.original = texture;
  glGenTextures(1, &entry.name);
  glActiveTexture(GL_TEXTURE0);
  glBindTexture(GL_TEXTURE_2D, entry.name);
  glPixelStorei(GL_UNPACK_ALIGNMENT, 4);
  glTexImage2D(GL_TEXTURE_2D, 0, GL_RGBA8, texture->width, texture->height, 0, GL_RGBA, GL_UNSIGNED_BYTE,
               texture->pixels.data());
  glGenerateMipmap(GL_TEXTURE_2D);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_LINEAR_MIPMAP_NEAREST);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
  return entry.name;
}

void TextureCache::tidy() {
  for (auto entry = entries_.begin(); entry != entries_.end();) {
    if (entry->second.original.expired()) {
      glDeleteTextures(1, &entry->second.name);
      entry = entries_.erase(entry);
    } else {
      ++entry;
    }
  }
}

}  // namespace fascia::view
