#pragma once

#include <cstdint>
#include <memory>

#include "view/camera.h"
#include "view/image.h"
#include "view/scene.h"
#include "view/scene_renderer.h"

namespace fascia::app {

/// The picture of the face as a texture of the window's OpenGL context, drawn anew only when something has
/// changed. How carefully it is drawn follows from how long this machine takes: a moving face is kept fluid,
/// a still one is drawn once more with everything.
class FacePicture {
 public:
  FacePicture();
  ~FacePicture();
  FacePicture(const FacePicture&) = delete;
  FacePicture& operator=(const FacePicture&) = delete;

  enum class Care {
    quick,  ///< one sample a pixel, without shadows and occlusion
    good,   ///< with shadows
    full    ///< everything
  };

  /// Makes the texture `width` by `height`. Throws fascia::Error when that is too large for the driver.
  void resize(int width, int height);
  /// Draws into the rectangle from (x, 0) on, `columns` wide, over the whole height.
  void draw(const view::DrawList& list, const view::Camera& camera, view::Look look, Care care, int x,
            int columns);

  /// Compiles one more of the programs that pictures need, a frame each, so that the first picture does not
  /// wait for all of them. False when there are all.
  bool warm_up();

  /// Puts a picture of the texture's size in its place.
  void show(const view::Image& image);

  /// Mean milliseconds of the last pictures of that care; 0 before the first.
  double milliseconds(Care care) const { return milliseconds_[static_cast<int>(care)]; }
  unsigned texture() const { return texture_; }
  int width() const { return width_; }
  int height() const { return height_; }

 private:
  double motion_resolution();
  view::SceneRenderer renderer_;
  unsigned framebuffer_ = 0, texture_ = 0, depth_ = 0;
  int width_ = 0, height_ = 0;
  double milliseconds_[3] = {0.0, 0.0, 0.0};
  size_t warmed_up_ = 0;
  double resolution_ = 1.0;  ///< of pictures in motion
};

/// The pixels of a rectangle of the framebuffer that is bound, from its lower left corner.
view::Image read_pixels(int x, int y, int width, int height);

}  // namespace fascia::app
