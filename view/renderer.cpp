#include "view/renderer.h"

#include <algorithm>

#include "geometry/error.h"
#include "view/gl_objects.h"
#include "view/offscreen_context.h"
#include "view/scene_renderer.h"

namespace fascia::view {

struct Renderer::State {
  int width, height;
  OffscreenContext context;  // first: the others live in it
  SceneRenderer scene;
  Canvas picture{GL_RGBA8, Canvas::Depth::none, 0};

  State(int w, int h) : width(w), height(h) {}
};

namespace {

void check_size(int width, int height) {
  if (width < 1 || height < 1 || width > 8192 || height > 8192)
    throw Error("a picture must be 1 to 8192 pixels wide and high");
}

}  // namespace

Renderer::Renderer(int width, int height) {
  check_size(width, height);
  state_ = std::make_unique<State>(width, height);
}

Renderer::~Renderer() {
  state_->context.make_current();
}

void Renderer::resize(int width, int height) {
  check_size(width, height);
  state_->width = width;
  state_->height = height;
}

Image Renderer::draw(const DrawList& list, const Camera& camera, Colour background) const {
  Look look;
  look.background = background;
  return draw_with(list, camera, look);
}

Image Renderer::draw_with(const DrawList& list, const Camera& camera, const Look& look) const {
  State& s = *state_;
  s.context.make_current();
  s.picture.bind(s.width, s.height);
  s.scene.draw(list, camera, {s.picture.framebuffer(), 0, 0, s.width, s.height}, look);
  Image image(s.width, s.height, look.background), flipped = image;
  glPixelStorei(GL_PACK_ALIGNMENT, 1);
  glReadPixels(0, 0, s.width, s.height, GL_RGB, GL_UNSIGNED_BYTE, flipped.pixels.data());
  const size_t row = static_cast<size_t>(s.width) * 3;
  for (int y = 0; y < s.height; ++y)
    std::copy_n(
        flipped.pixels.begin() + static_cast<std::ptrdiff_t>(row * static_cast<size_t>(s.height - 1 - y)),
        row, image.pixels.begin() + static_cast<std::ptrdiff_t>(row * static_cast<size_t>(y)));
  return image;
}

}  // namespace fascia::view
