#include "view/light_passes.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace fascia::view {

namespace {

constexpr double occlusion_radius = 0.030;  // m: across a mouth's corner or an eye's

/// Shadows and occlusion fall from what is solid; a hair card's holes let light through.
bool is_solid(const DrawSurface& surface) {
  return surface.opacity >= 1.0 && surface.shading != Shading::xray;
}

/// The picture's pixels to one of shadows and occlusion, each way: films make do with half their size.
int screen_divisor(const Look& look) {
  return look.samples > 4 ? 1 : 2;
}

bool has_light_passes(const Look& look) {
  return look.has_shadows || look.has_occlusion || look.has_mirrors;
}

}  // namespace

bool is_glass(const DrawSurface& surface) {
  return surface.opacity < 1.0 || surface.is_blended || surface.shading == Shading::xray;
}

void set_cut(const Program& program, const DrawSurface& surface) {
  const Eigen::Vector4f cut = surface.cut.value_or(Eigen::Vector4d(0, 0, 0, 1)).cast<float>();
  glUniform4fv(program.place("cut"), 1, cut.data());
}

void set_culling(const DrawSurface& surface) {
  if (surface.is_two_sided)
    glDisable(GL_CULL_FACE);
  else
    glEnable(GL_CULL_FACE);
}

void Screen::draw() const {
  glBindVertexArray(array_);
  glDrawArrays(GL_TRIANGLES, 0, 3);
}

void LightPasses::draw(const Shot& shot, TextureCache& textures) {
  if (!has_light_passes(shot.look)) return;
  frame_ = light_frame(shot);
  if (shot.look.has_shadows) draw_shadows(shot, textures, shot.width * shot.height > 700 * 700 ? 2048 : 1024);
  const int divisor = screen_divisor(shot.look), width = (shot.width + divisor - 1) / divisor,
            height = (shot.height + divisor - 1) / divisor;
  draw_geometry(shot, textures, width, height);
  draw_screen_light(shot, width, height);
}

LightPasses::LightFrame LightPasses::light_frame(const Shot& shot) {
  const Vec3 back = shot.room.key_direction.normalized(), right = Vec3::UnitY().cross(back).normalized();
  Mat3 turn;
  turn.row(0) = right;
  turn.row(1) = back.cross(right);
  turn.row(2) = back;
  Bounds box;
  for (const DrawSurface& surface : shot.list.surfaces)
    if (is_solid(surface))
      for (const Vec3& p : surface.positions) {
        const Vec3 q = turn * p;
        box.lower = box.lower.cwiseMin(q);
        box.upper = box.upper.cwiseMax(q);
      }
  LightFrame frame;
  if (!(box.size().minCoeff() >= 0.0)) return frame;
  frame.span = 1.04 * std::max({box.size()[0], box.size()[1], 1e-3});
  frame.range = 1.04 * std::max(box.size()[2], 1e-3);
  frame.matrix.topLeftCorner<3, 3>() =
      Vec3(2.0 / frame.span, 2.0 / frame.span, -2.0 / frame.range).asDiagonal() * turn;
  frame.matrix.topRightCorner<3, 1>() =
      -(Vec3(2.0 / frame.span, 2.0 / frame.span, -2.0 / frame.range).asDiagonal() * box.centre());
  return frame;
}

void LightPasses::draw_shadows(const Shot& shot, TextureCache& textures, int size) {
  shadow_map_.bind(size, size);
  glClear(GL_DEPTH_BUFFER_BIT);
  glEnable(GL_DEPTH_TEST);
  glDisable(GL_CULL_FACE);
  depth_.use();
  depth_.set("to_clip", frame_.matrix);
  depth_.set("colour_map", colour_unit);
  for (size_t i = 0; i < shot.list.surfaces.size(); ++i) {
    const DrawSurface& surface = shot.list.surfaces[i];
    if (!is_solid(surface)) continue;
    set_holes(depth_, surface, textures);
    shot.buffers[i]->draw_triangles();
  }
}

void LightPasses::set_holes(const Program& program, const DrawSurface& surface,
                            TextureCache& textures) const {
  const bool has_holes = surface.colour_map && (surface.alpha_cutoff >= 0.0 || surface.is_blended);
  program.set("has_holes", has_holes ? 1 : 0);
  program.set("cutoff", surface.alpha_cutoff >= 0.0 ? surface.alpha_cutoff : 0.5);
  set_cut(program, surface);
  if (has_holes) bind_texture(colour_unit, GL_TEXTURE_2D, textures.name(surface.colour_map));
}

void LightPasses::draw_geometry(const Shot& shot, TextureCache& textures, int width, int height) {
  geometry_map_.bind(width, height);
  glClearColor(0, 0, 0, 0);
  glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
  glEnable(GL_DEPTH_TEST);
  geometry_.use();
  geometry_.set("colour_map", colour_unit);
  geometry_.set("to_eye", eye_matrix(shot.camera));
  geometry_.set("to_clip", Mat4(clip_matrix(shot.camera, shot.aspect()) * eye_matrix(shot.camera)));
  for (size_t i = 0; i < shot.list.surfaces.size(); ++i) {
    const DrawSurface& surface = shot.list.surfaces[i];
    if (is_glass(surface) || surface.shading == Shading::hair) continue;
    set_holes(geometry_, surface, textures);
    set_culling(surface);
    shot.buffers[i]->draw_triangles();
  }
  glDisable(GL_DEPTH_TEST);
  glDisable(GL_CULL_FACE);
}

void LightPasses::draw_screen_light(const Shot& shot, int width, int height) {
  screen_light_.use();
  screen_light_.set("geometry", 0);
  screen_light_.set("shadow_map", shadow_unit);
  screen_light_.set("has_occlusion", shot.look.has_occlusion ? 1 : 0);
  set_shadows(screen_light_, shot, 0.0);
  glUniform2f(screen_light_.place("size"), static_cast<float>(width), static_cast<float>(height));
  const double half = std::tan(shot.camera.field_of_view * EIGEN_PI / 360.0);
  glUniform2f(screen_light_.place("scale"), static_cast<float>(half * shot.aspect()),
              static_cast<float>(half));
  screen_light_.set("radius", occlusion_radius);
  screen_light_.set("from_eye", Mat4(eye_matrix(shot.camera).inverse()));
  bind_texture(shadow_unit, GL_TEXTURE_2D, shadow_map_.depth());
  draw_over_surfaces(geometry_map_.colour(), raw_light_, width, height);
  blur_.use();
  blur_.set("light", 0);
  draw_over_surfaces(raw_light_.colour(), smooth_light_, width, height);
}

/// Makes `canvas` from `picture` where the geometry map shows a surface; the other pixels are open and lit.
void LightPasses::draw_over_surfaces(GLuint picture, Canvas& canvas, int width, int height) const {
  canvas.bind(width, height);
  canvas.use_depth_of(geometry_map_);
  bind_texture(0, GL_TEXTURE_2D, picture);
  glClearColor(1, 0, 1, 1);
  glClear(GL_COLOR_BUFFER_BIT);
  glEnable(GL_DEPTH_TEST);
  glDepthMask(GL_FALSE);
  glDepthFunc(GL_GREATER);
  glDepthRange(1.0, 1.0);
  screen_.draw();
  glDepthRange(0.0, 1.0);
  glDepthFunc(GL_LESS);
  glDepthMask(GL_TRUE);
  glDisable(GL_DEPTH_TEST);
}

void LightPasses::set_shadows(const Program& program, const Shot& shot, double turn) const {
  program.set("has_shadows", shot.look.has_shadows ? 1 : 0);
  program.set("key_size", shot.room.key_size);
  program.set("to_light", frame_.matrix);
  program.set("light_span", frame_.span);
  program.set("light_range", frame_.range);
  program.set("turn", turn);
}

void LightPasses::set(const Program& program, const Shot& shot, double turn) const {
  program.set("has_screen_map", has_light_passes(shot.look) ? 1 : 0);
  set_shadows(program, shot, turn);
  program.set("screen_scale", 1.0 / (screen_divisor(shot.look) * shot.enlargement));
  bind_texture(shadow_unit, GL_TEXTURE_2D, shadow_map_.depth());
  bind_texture(screen_unit, GL_TEXTURE_2D, smooth_light_.colour());
}

}  // namespace fascia::view
