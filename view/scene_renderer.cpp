#include "view/scene_renderer.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "geometry/error.h"
#include "view/environment.h"
#include "view/gl_objects.h"
#include "view/light_passes.h"
#include "view/picture_region.h"
#include "view/shaders.h"
#include "view/surface_buffers.h"

namespace fascia::view {

namespace {

constexpr int reflection_size = 64, reflection_levels = 6;  // pixels; smaller versions, each rougher

double usual_roughness(const DrawSurface& surface) {
  if (surface.roughness >= 0.0) return surface.roughness;
  switch (surface.shading) {
    case Shading::skin:
      return 0.50;
    case Shading::mucosa:
      return 0.42;
    case Shading::tooth:
      return 0.30;
    case Shading::bone:
      return 0.58;
    case Shading::muscle:
      return 0.42;
    case Shading::hair:
      return 0.5;
    default:
      return surface.colour_map || surface.surface_map ? 1.0 : 0.75 - 0.5 * std::min(1.0, surface.shine);
  }
}

/// Whether pixels of it are left out.
bool has_holes(const DrawSurface& surface) {
  return surface.cut || surface.alpha_cutoff >= 0.0;
}

}  // namespace

struct SceneRenderer::State {
  int most_samples = 0;
  Program lines{surface_vertex_shader(), line_fragment_shader()};
  Program backdrop{screen_vertex_shader(), backdrop_fragment_shader()};
  Program copy{screen_vertex_shader(), copy_fragment_shader()};
  std::map<std::pair<Shading, bool>, std::unique_ptr<Program>> surfaces;  // by shading and holes
  LightPasses light_passes;
  Screen screen;
  std::unique_ptr<Canvas> drawn;  // several samples a pixel
  Canvas behind{GL_RGBA8, Canvas::Depth::none, 0};
  Canvas enlarged{GL_RGBA8, Canvas::Depth::buffer, 0, GL_LINEAR};
  Canvas resolved{GL_RGBA8, Canvas::Depth::none, 0}, gathered{GL_RGBA16F, Canvas::Depth::none, 0};
  std::vector<std::unique_ptr<VertexBuffers>> surface_buffers, line_buffers;
  TextureCache textures;
  GLuint reflections = 0;
  std::string light;
  Environment room;
  std::array<Vec3, 9> harmonics;

  State();
  ~State();
  void upload(const DrawList& list);
  void use_light(const std::string& name);
  const Program& program(const DrawSurface& surface);
  void set_surface(const Program& program, const DrawSurface& surface);
  void set_frame(const Program& program, const Shot& shot, double turn);
  void draw_round(const Shot& shot, const Mat4& to_clip, double turn);
  void draw_backdrop(const Shot& shot);
  void resolve(int width, int height);
  void gather(int width, int height, double share);
  void draw_behind(const Shot& shot);
  void copy_to(const Target& target, GLuint picture, const Shot& shot);
  GLuint draw_enlarged(const Shot& shot);
  GLuint draw_multisampled(const Shot& shot);
};

SceneRenderer::State::State() {
  glGetIntegerv(GL_MAX_SAMPLES, &most_samples);
  glGenTextures(1, &reflections);
}

SceneRenderer::State::~State() {
  glDeleteTextures(1, &reflections);
}

void SceneRenderer::State::upload(const DrawList& list) {
  while (surface_buffers.size() < list.surfaces.size())
    surface_buffers.push_back(std::make_unique<VertexBuffers>());
  while (line_buffers.size() < list.lines.size())
    line_buffers.push_back(std::make_unique<VertexBuffers>());
  for (size_t i = 0; i < list.surfaces.size(); ++i)
    surface_buffers[i]->upload(list.surfaces[i]);
  for (size_t i = 0; i < list.lines.size(); ++i)
    line_buffers[i]->upload(list.lines[i]);
}

void SceneRenderer::State::use_light(const std::string& name) {
  if (name == light) return;
  room = environment(name);
  harmonics = irradiance(room);
  bind_texture(reflection_unit, GL_TEXTURE_CUBE_MAP, reflections);
  glPixelStorei(GL_UNPACK_ALIGNMENT, 4);
  for (int level = 0; level < reflection_levels; ++level)
    for (int face = 0; face < 6; ++face) {
      const int size = reflection_size >> level;
      const std::vector<float> pixels =
          reflection_face(room, face, size, static_cast<double>(level) / (reflection_levels - 1));
      glTexImage2D(GL_TEXTURE_CUBE_MAP_POSITIVE_X + static_cast<GLenum>(face), level, GL_RGB32F, size, size,
                   0, GL_RGB, GL_FLOAT, pixels.data());
    }
  glTexParameteri(GL_TEXTURE_CUBE_MAP, GL_TEXTURE_MAX_LEVEL, reflection_levels - 1);
  glTexParameteri(GL_TEXTURE_CUBE_MAP, GL_TEXTURE_MIN_FILTER, GL_LINEAR_MIPMAP_LINEAR);
  glTexParameteri(GL_TEXTURE_CUBE_MAP, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
  light = name;
}

const Program& SceneRenderer::State::program(const DrawSurface& surface) {
  const bool is_cut = has_holes(surface);
  std::unique_ptr<Program>& made = surfaces[{surface.shading, is_cut}];
  if (!made) {
    made =
        std::make_unique<Program>(surface_vertex_shader(), surface_fragment_shader(surface.shading, is_cut));
    made->use();
    const std::pair<const char*, int> units[] = {
        {"colour_map", colour_unit},      {"normal_map", normal_unit}, {"surface_map", surface_unit},
        {"reflections", reflection_unit}, {"shadow_map", shadow_unit}, {"screen_map", screen_unit}};
    for (const auto& [name, unit] : units)
      made->set(name, unit);
  }
  return *made;
}

void SceneRenderer::State::set_frame(const Program& p, const Shot& shot, double turn) {
  p.set("camera", eye_of(shot.camera));
  p.set("view_direction", (shot.camera.target - eye_of(shot.camera)).normalized());
  p.set("key_direction", room.key_direction);
  p.set("key_irradiance", room.key_irradiance);
  p.set("exposure", shot.look.exposure);
  p.set("reflection_levels", static_cast<double>(reflection_levels - 1));
  float flat[27];
  for (size_t k = 0; k < 27; ++k)
    flat[k] = static_cast<float>(harmonics[k / 3][static_cast<Eigen::Index>(k % 3)]);
  glUniform3fv(p.place("harmonics"), 9, flat);
  bind_texture(reflection_unit, GL_TEXTURE_CUBE_MAP, reflections);
  light_passes.set(p, shot, turn);
}

void SceneRenderer::State::set_surface(const Program& p, const DrawSurface& surface) {
  const bool has_uvs = !surface.uvs.empty();
  // Copies are made before any is bound: making one binds it to the first unit.
  for (const auto& texture : {surface.colour_map, surface.normal_map, surface.surface_map})
    if (has_uvs) textures.name(texture);
  const auto map = [&](const char* name, int unit, const std::shared_ptr<const Texture>& texture) {
    const bool is_used = has_uvs && texture;
    p.set(name, is_used ? 1 : 0);
    if (is_used) bind_texture(unit, GL_TEXTURE_2D, textures.name(texture));
  };
  map("has_colour_map", colour_unit, surface.colour_map);
  map("has_normal_map", normal_unit, surface.normal_map);
  map("has_surface_map", surface_unit, surface.surface_map);
  p.set("opacity", surface.opacity);
  p.set("roughness", usual_roughness(surface));
  p.set("metalness", surface.metalness);
  p.set("specular",
        surface.shading == Shading::plain && !surface.colour_map ? std::min(1.0, 3.0 * surface.shine) : 1.0);
  p.set("normal_strength", surface.normal_strength);
  p.set("cutoff", has_uvs && surface.colour_map ? surface.alpha_cutoff : -1.0);
  p.set("is_blended", surface.is_blended ? 1 : 0);
  p.set("is_drawn_eye", !surface.eye_coordinates.empty() && !(has_uvs && surface.colour_map) ? 1 : 0);
  p.set("glow", surface.glow);
  set_cut(p, surface);
  set_culling(surface);
}

void SceneRenderer::State::draw_backdrop(const Shot& shot) {
  const Look& look = shot.look;
  backdrop.use();
  glUniform3f(backdrop.place("background"), look.background[0] / 255.0F, look.background[1] / 255.0F,
              look.background[2] / 255.0F);
  backdrop.set("aspect", shot.aspect());
  glDisable(GL_DEPTH_TEST);
  screen.draw();
}

void SceneRenderer::State::draw_round(const Shot& shot, const Mat4& to_clip, double turn) {
  const DrawList& list = shot.list;
  const Look& look = shot.look;
  glClearColor(look.background[0] / 255.0F, look.background[1] / 255.0F, look.background[2] / 255.0F, 1.0F);
  glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
  glDisable(GL_BLEND);
  if (look.has_backdrop) draw_backdrop(shot);
  glEnable(GL_DEPTH_TEST);
  glDepthFunc(GL_LESS);
  const auto prepare = [&](size_t i) {
    const Program& p = program(list.surfaces[i]);
    p.use();
    p.set("to_clip", to_clip);
    set_surface(p, list.surfaces[i]);
    set_frame(p, shot, turn);
  };
  for (size_t i = 0; i < list.surfaces.size(); ++i) {
    if (is_glass(list.surfaces[i])) continue;
    prepare(i);
    surface_buffers[i]->draw_triangles();
  }
  const auto draw_lines = [&](bool on_top) {
    lines.use();
    lines.set("to_clip", to_clip);
    for (size_t i = 0; i < list.lines.size(); ++i) {
      if (list.lines[i].is_on_top != on_top) continue;
      glLineWidth(static_cast<float>(list.lines[i].width * shot.enlargement));
      line_buffers[i]->draw_lines();
    }
  };
  draw_lines(false);
  // Glass last: its depth first, so that only its nearest side is blended. Cards of hair keep theirs to
  // themselves: one may show through the holes of another.
  glBlendFunc(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA);
  for (size_t i = 0; i < list.surfaces.size(); ++i) {
    const DrawSurface& surface = list.surfaces[i];
    if (!is_glass(surface)) continue;
    prepare(i);
    if (!surface.is_blended) {
      glColorMask(GL_FALSE, GL_FALSE, GL_FALSE, GL_FALSE);
      surface_buffers[i]->draw_triangles();
      glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
    }
    glEnable(GL_BLEND);
    glDepthFunc(GL_LEQUAL);
    glDepthMask(surface.is_blended ? GL_FALSE : GL_TRUE);
    surface_buffers[i]->draw_triangles();
    glDepthMask(GL_TRUE);
    glDepthFunc(GL_LESS);
    glDisable(GL_BLEND);
  }
  glDisable(GL_DEPTH_TEST);
  draw_lines(true);
}

SceneRenderer::SceneRenderer() : state_(std::make_unique<State>()) {}
SceneRenderer::~SceneRenderer() = default;

/// The round's samples, one colour a pixel.
void SceneRenderer::State::resolve(int width, int height) {
  resolved.bind(width, height);
  glBindFramebuffer(GL_READ_FRAMEBUFFER, drawn->framebuffer());
  glBlitFramebuffer(0, 0, width, height, 0, 0, width, height, GL_COLOR_BUFFER_BIT, GL_NEAREST);
}

/// Puts the round's picture over those before it, by its share of their mean.
void SceneRenderer::State::gather(int width, int height, double share) {
  gathered.bind(width, height);
  copy.use();
  copy.set("grain", 0.0);
  glUniform2f(copy.place("spread"), 0.0F, 0.0F);
  copy.set("picture", 0);
  bind_texture(0, GL_TEXTURE_2D, resolved.colour());
  glEnable(GL_BLEND);
  glBlendColor(0, 0, 0, static_cast<float>(share));
  glBlendFunc(GL_CONSTANT_ALPHA, GL_ONE_MINUS_CONSTANT_ALPHA);
  screen.draw();
  glDisable(GL_BLEND);
}

/// The picture without its surfaces.
void SceneRenderer::State::draw_behind(const Shot& shot) {
  const Colour& colour = shot.look.background;
  behind.bind(shot.width, shot.height);
  glClearColor(colour[0] / 255.0F, colour[1] / 255.0F, colour[2] / 255.0F, 1.0F);
  glClear(GL_COLOR_BUFFER_BIT);
  if (shot.look.has_backdrop) draw_backdrop(shot);
}

/// Puts a finished picture into the target, scaled down where it is larger.
void SceneRenderer::State::copy_to(const Target& target, GLuint picture, const Shot& shot) {
  glBindFramebuffer(GL_FRAMEBUFFER, target.framebuffer);
  glViewport(target.x, target.y, shot.width, shot.height);
  copy.use();
  copy.set("grain", shot.look.has_backdrop ? 1.0 : 0.0);
  copy.set("picture", 0);
  const float spread = picture == enlarged.colour() && shot.enlargement > 1.0 ? 0.25F : 0.0F;
  glUniform2f(copy.place("spread"), spread / static_cast<float>(shot.width),
              spread / static_cast<float>(shot.height));
  bind_texture(0, GL_TEXTURE_2D, picture);
  screen.draw();
}

/// One sample a pixel of a picture as large as asked for, or larger; the texture it is in.
GLuint SceneRenderer::State::draw_enlarged(const Shot& shot) {
  enlarged.bind(static_cast<int>(std::lround(shot.width * shot.enlargement)),
                static_cast<int>(std::lround(shot.height * shot.enlargement)));
  draw_round(shot, clip_matrix(shot.camera, shot.aspect()) * eye_matrix(shot.camera), 0.0);
  return enlarged.colour();
}

/// Rounds of several samples a pixel; the texture that holds their mean.
GLuint SceneRenderer::State::draw_multisampled(const Shot& shot) {
  const int samples = std::min(4, most_samples),
            rounds = std::max(1, shot.look.samples / std::max(1, samples));
  if (!drawn) drawn = std::make_unique<Canvas>(GL_RGBA8, Canvas::Depth::buffer, samples);
  for (int r = 0; r < rounds; ++r) {
    // Rounds are set a fraction of a pixel apart, along a sequence that fills the pixel evenly (R2, Roberts
    // 2018).
    Mat4 nudge = Mat4::Identity();
    if (rounds > 1) {
      nudge(0, 3) = (std::fmod(0.5 + 0.7548776662 * r, 1.0) - 0.5) * 1.0 / shot.width;
      nudge(1, 3) = (std::fmod(0.5 + 0.5698402910 * r, 1.0) - 0.5) * 1.0 / shot.height;
    }
    drawn->bind(shot.width, shot.height);
    draw_round(shot, nudge * clip_matrix(shot.camera, shot.aspect()) * eye_matrix(shot.camera),
               static_cast<double>(r) / rounds);
    resolve(shot.width, shot.height);
    if (rounds > 1) gather(shot.width, shot.height, 1.0 / (r + 1));
  }
  return rounds == 1 ? resolved.colour() : gathered.colour();
}

void SceneRenderer::draw(const DrawList& list, const Camera& camera, const Target& target, const Look& look) {
  const auto is_fine = [](const DrawSurface& surface) { return surface.is_fine; };
  if (look.samples < 4 && std::any_of(list.surfaces.begin(), list.surfaces.end(), is_fine)) {
    DrawList coarse = list;
    std::erase_if(coarse.surfaces, is_fine);
    return draw(coarse, camera, target, look);
  }
  State& s = *state_;
  const int width = target.width, height = target.height;
  if (width < 1 || height < 1) return;
  glDisable(GL_SCISSOR_TEST);
  glDisable(GL_BLEND);
  glEnable(GL_TEXTURE_CUBE_MAP_SEAMLESS);
  s.textures.tidy();
  s.upload(list);
  s.use_light(look.light);
  const double enlargement = look.samples == 1                        ? look.resolution
                             : look.samples == 2 || look.samples == 3 ? 1.5
                                                                      : 1.0;
  const Shot shot{list, s.surface_buffers, s.room, camera, look, width, height, enlargement};
  s.light_passes.draw(shot, s.textures);

  // What no surface covers needs no more than one sample.
  const Rectangle inside = covered(shot);
  s.draw_behind(shot);
  s.copy_to(target, s.behind.colour(), shot);
  keep_inside(inside, enlargement, 0, 0, enlargement != 1.0 ? 3 : 0);
  const GLuint picture = look.samples < 4 ? s.draw_enlarged(shot) : s.draw_multisampled(shot);
  keep_inside(inside, 1.0, target.x, target.y);
  s.copy_to(target, picture, shot);
  glDisable(GL_SCISSOR_TEST);
  glDisable(GL_CULL_FACE);
}

}  // namespace fascia::view
