#include "app/scene/face_picture.h"

#include <epoxy/gl.h>

#include <algorithm>
#include <chrono>
#include <vector>

#include "geometry/error.h"

namespace fascia::app {

FacePicture::FacePicture() {
  glGenFramebuffers(1, &framebuffer_);
  glGenTextures(1, &texture_);
  glGenRenderbuffers(1, &depth_);
}

FacePicture::~FacePicture() {
  glDeleteFramebuffers(1, &framebuffer_);
  glDeleteTextures(1, &texture_);
  glDeleteRenderbuffers(1, &depth_);
}

void FacePicture::resize(int width, int height) {
  width = std::max(width, 1);
  height = std::max(height, 1);
  if (width == width_ && height == height_) return;
  width_ = width;
  height_ = height;
  glBindTexture(GL_TEXTURE_2D, texture_);
  glTexImage2D(GL_TEXTURE_2D, 0, GL_RGBA8, width, height, 0, GL_RGBA, GL_UNSIGNED_BYTE, nullptr);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_LINEAR);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
  glBindRenderbuffer(GL_RENDERBUFFER, depth_);
  glRenderbufferStorage(GL_RENDERBUFFER, GL_DEPTH_COMPONENT24, width, height);
  glBindFramebuffer(GL_FRAMEBUFFER, framebuffer_);
  glFramebufferTexture2D(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, texture_, 0);
  glFramebufferRenderbuffer(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_RENDERBUFFER, depth_);
  const bool is_complete = glCheckFramebufferStatus(GL_FRAMEBUFFER) == GL_FRAMEBUFFER_COMPLETE;
  glBindFramebuffer(GL_FRAMEBUFFER, 0);
  if (!is_complete) throw Error("a window of this size is too large for OpenGL here: make it smaller");
}

/// Where even the plainest picture is too slow to follow the hand, it is drawn with fewer pixels.
double FacePicture::motion_resolution() {
  const double passed = milliseconds_[static_cast<int>(Care::quick)];
  const double fluid = 15.0, slow = 30.0, slowest = 60.0;  // milliseconds
  if (passed > slowest)
    resolution_ = 0.5;
  else if (passed > slow)
    resolution_ = std::min(resolution_, 0.75);
  else if (passed < fluid)
    resolution_ = 1.0;
  return resolution_;
}

void FacePicture::draw(const view::DrawList& list, const view::Camera& camera, view::Look look, Care care,
                       int x, int columns) {
  const auto started = std::chrono::steady_clock::now();
  look.has_shadows = look.has_mirrors = care != Care::quick;
  look.has_occlusion = care == Care::full;
  if (care == Care::quick) look.resolution = motion_resolution();
  look.samples = care == Care::full ? 8 : care == Care::good ? 2 : 1;
  renderer_.draw(list, camera, {framebuffer_, x, 0, std::max(columns, 1), height_}, look);
  // The time counts when the picture is there, not when it is ordered.
  glFinish();
  glBindFramebuffer(GL_FRAMEBUFFER, 0);
  const double passed =
      std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - started).count();
  double& mean = milliseconds_[static_cast<int>(care)];
  mean = mean == 0.0 ? passed : 0.8 * mean + 0.2 * passed;
}

bool FacePicture::warm_up() {
  using view::Shading;
  static constexpr Shading all[] = {Shading::plain, Shading::skin, Shading::eye,  Shading::mucosa,
                                    Shading::tooth, Shading::hair, Shading::bone, Shading::muscle,
                                    Shading::xray,  Shading::data};
  if (warmed_up_ == std::size(all)) return false;
  // With maps, as a driver may make other programs of those without.
  static const auto grey =
      std::make_shared<const view::Texture>(view::Texture{2, 2, std::vector<uint8_t>(16, 128), true});
  view::DrawList list;
  view::DrawSurface& surface = list.surfaces.emplace_back();
  surface.positions = {Vec3(-0.1, -0.1, 0), Vec3(0.1, -0.1, 0), Vec3(0, 0.1, 0)};
  surface.uvs = {Vec2(0, 0), Vec2(1, 0), Vec2(0, 1)};
  surface.triangles = {{0, 1, 2}};
  surface.shading = all[warmed_up_++];
  surface.colour_map = surface.normal_map = surface.surface_map = grey;
  view::Camera camera;
  camera.distance = 0.5;
  resize(std::max(width_, 64), std::max(height_, 64));
  draw(list, camera, view::Look(), Care::quick, 0, width_);
  milliseconds_[static_cast<int>(Care::quick)] = 0.0;
  return true;
}

void FacePicture::show(const view::Image& image) {
  if (image.width != width_ || image.height != height_) return;
  // Rows from the bottom, as OpenGL has them.
  std::vector<uint8_t> rows(image.pixels.size());
  const auto row = static_cast<std::ptrdiff_t>(width_) * 3;
  for (int line = 0; line < height_; ++line)
    std::copy_n(image.pixels.begin() + row * (height_ - 1 - line), row, rows.begin() + row * line);
  glBindTexture(GL_TEXTURE_2D, texture_);
  glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
  glTexSubImage2D(GL_TEXTURE_2D, 0, 0, 0, width_, height_, GL_RGB, GL_UNSIGNED_BYTE, rows.data());
}

view::Image read_pixels(int x, int y, int width, int height) {
  view::Image image(width, height, {0, 0, 0});
  std::vector<uint8_t> rows(image.pixels.size());
  glPixelStorei(GL_PACK_ALIGNMENT, 1);
  glReadPixels(x, y, width, height, GL_RGB, GL_UNSIGNED_BYTE, rows.data());
  const auto row = static_cast<std::ptrdiff_t>(width) * 3;
  for (int line = 0; line < height; ++line)
    std::copy_n(rows.begin() + row * (height - 1 - line), row, image.pixels.begin() + row * line);
  return image;
}

}  // namespace fascia::app
