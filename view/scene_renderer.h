#pragma once

#include <memory>

#include "view/camera.h"
#include "view/scene.h"

namespace fascia::view {

/// Where to draw: a framebuffer object of the current context (0: the window's own) and a rectangle in it, in
/// pixels from its lower left corner.
struct Target {
  unsigned framebuffer = 0;
  int x = 0, y = 0, width = 0, height = 0;
};

/// Draws scenes in whatever OpenGL 3.3 core context is current: a window's or none's. Every member needs the
/// context current in which the renderer was made. Afterwards depth test, culling, blending and scissor test
/// are off and `target` is bound; other state is not restored.
class SceneRenderer {
 public:
  /// Throws fascia::Error when the driver refuses the shaders.
  SceneRenderer();
  ~SceneRenderer();
  SceneRenderer(const SceneRenderer&) = delete;
  SceneRenderer& operator=(const SceneRenderer&) = delete;

  /// The same list, camera, size and look give the same pixels on one machine. Throws fascia::Error when the
  /// picture is too large for the driver or a surface's lists do not fit together.
  void draw(const DrawList& list, const Camera& camera, const Target& target, const Look& look = {});

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace fascia::view
