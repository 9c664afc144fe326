#pragma once

#include <memory>

#include "view/camera.h"
#include "view/image.h"
#include "view/scene.h"

namespace fascia::view {

/// Draws pictures without a display: EGL's surfaceless platform, on the processor where there is no graphics
/// card.
class Renderer {
 public:
  /// Throws fascia::Error when there is no EGL or OpenGL 3.3 to be had.
  Renderer(int width, int height);
  ~Renderer();
  Renderer(const Renderer&) = delete;
  Renderer& operator=(const Renderer&) = delete;

  /// Pictures have another size from now on; what was made for drawing is kept. Throws as the constructor
  /// does.
  void resize(int width, int height);

  Image draw(const DrawList& list, const Camera& camera, Colour background = {38, 42, 48}) const;
  /// The same with lights and finish of one's own.
  Image draw_with(const DrawList& list, const Camera& camera, const Look& look) const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace fascia::view
