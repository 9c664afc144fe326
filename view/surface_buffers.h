#pragma once

#include <epoxy/gl.h>

#include <map>
#include <memory>
#include <vector>

#include "view/scene.h"

namespace fascia::view {

/// A surface's or a line's vertices and triangles on their way to the graphics card.
class VertexBuffers {
 public:
  VertexBuffers();
  ~VertexBuffers();
  VertexBuffers(const VertexBuffers&) = delete;
  VertexBuffers& operator=(const VertexBuffers&) = delete;

  /// Throws fascia::Error when the surface's lists do not fit together.
  void upload(const DrawSurface& surface);
  void upload(const DrawLines& lines);
  void draw_triangles() const;
  void draw_lines() const;

 private:
  void send(const std::vector<float>& data, GLsizeiptr index_bytes, const void* indices);

  GLuint array_ = 0, vertices_ = 0, indices_ = 0;
  GLsizei count_ = 0;
  std::vector<GLint> firsts_;
  std::vector<GLsizei> counts_;
};

/// Copies of textures on the graphics card, as long as their originals live.
class TextureCache {
 public:
  ~TextureCache();
  /// The texture's name there; makes the copy with its smaller versions at the first call.
  GLuint name(const std::shared_ptr<const Texture>& texture);
  /// Lets go of copies whose originals are gone.
  void tidy();

 private:
  struct Entry {
    std::weak_ptr<const Texture> original;
    GLuint name = 0;
  };
  std::map<const Texture*, Entry> entries_;
};

}  // namespace fascia::view
