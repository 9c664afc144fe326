#include "view/scene_renderer.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "geometry/error.h"
#include "view/environment.h"
#include "view/gl_objects.h"
#include "view/shaders.h"
#include "view/surface_buffers.h"

namespace fascia::view {

namespace {

constexpr int reflection_size = 64, reflection_levels = 6;  // pixels; smaller versions, each rougher
constexpr double occlusion_radius = 0.030;                  // m: across a mouth's corner or an eye's
enum Unit { colour_unit, normal_unit, surface_unit, reflection_unit, shadow_unit, screen_unit };

void set_matrix(const Program& program, const char* name, const Mat4& matrix) {
  const Eigen::Matrix4f single = matrix.cast<float>();
  glUniformMatrix4fv(program.place(name), 1, GL_FALSE, single.data());
}

void set_vector(const Program& program, const char* name, const Vec3& v) {
  glUniform3f(program.place(name), static_cast<float>(v[0]), static_cast<float>(v[1]),
              static_cast<float>(v[2]));
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

bool is_glass(const DrawSurface& surface) {
  return surface.opacity < 1.0 || surface.is_blended || surface.shading == Shading::xray;
}

/// Shadows and occlusion fall from what is solid; a hair card's holes let light through.
bool is_solid(const DrawSurface& surface) {
  return surface.opacity >= 1.0 && surface.shading != Shading::xray;
}

/// The picture's pixels to one of shadows and occlusion, each way: films make do with half their size.
int screen_divisor(const Look& look) {
  return look.samples > 4 ? 1 : 2;
}

/// From the scene to the light's clip space, and the box's width and depth there in metres.
struct LightFrame {
  Mat4 matrix = Mat4::Identity();
  double span = 1.0, range = 1.0;
};

LightFrame light_frame(const Vec3& direction, const DrawList& list) {
  const Vec3 back = direction.normalized(), right = Vec3::UnitY().cross(back).normalized();
  Mat3 turn;
  turn.row(0) = right;
  turn.row(1) = back.cross(right);
  turn.row(2) = back;
  Bounds box;
  for (const DrawSurface& surface : list.surfaces)
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

}  // namespace

struct SceneRenderer::State {
  int most_samples = 0;
  Program depth{surface_vertex_shader(), depth_fragment_shader()};
  Program geometry{surface_vertex_shader(), geometry_fragment_shader()};
  Program lines{surface_vertex_shader(), line_fragment_shader()};
  Program screen_light{screen_vertex_shader(), screen_light_fragment_shader()};
  Program blur{screen_vertex_shader(), screen_blur_fragment_shader()};
  Program backdrop{screen_vertex_shader(), backdrop_fragment_shader()};
  Program copy{screen_vertex_shader(), copy_fragment_shader()};
  std::map<std::pair<Shading, bool>, std::unique_ptr<Program>> surfaces;  // by shading and holes
  Canvas shadow_map{0, Canvas::Depth::texture, 0};
  Canvas geometry_map{GL_RGBA16F, Canvas::Depth::buffer, 0};
  Canvas raw_light{GL_RGBA16F, Canvas::Depth::none, 0}, smooth_light{GL_RGBA16F, Canvas::Depth::none, 0};
  std::unique_ptr<Canvas> drawn;
  Canvas resolved{GL_RGBA8, Canvas::Depth::none, 0}, gathered{GL_RGBA16F, Canvas::Depth::none, 0};
  std::vector<std::unique_ptr<VertexBuffers>> surface_buffers, line_buffers;
  TextureCache textures;
  GLuint reflections = 0, screen_array = 0;
  std::string light;
  Environment room;
  std::array<Vec3, 9> harmonics;

  State();
  ~State();
  void upload(const DrawList& list);
  void use_light(const std::string& name);
  const Program& program(const DrawSurface& surface);
  void draw_screen() const;
  void draw_shadows(const DrawList& list, const LightFrame& frame, int size);
  void draw_geometry(const DrawList& list, const Camera& camera, double aspect, int width, int height);
  void draw_screen_light(const Camera& camera, const LightFrame& frame, const Look& look, double aspect,
                         int width, int height);
  void set_holes(const Program& program, const DrawSurface& surface);
  void set_shadows(const Program& program, const LightFrame& frame, const Look& look, double turn);
  void set_surface(const Program& program, const DrawSurface& surface);
  void set_frame(const Program& program, const Camera& camera, const LightFrame& frame, const Look& look,
                 double turn);
  void draw_round(const DrawList& list, const Camera& camera, const LightFrame& frame, const Look& look,
                  int width, int height, const Mat4& to_clip, double turn);
  void draw_backdrop(const Look& look, int width, int height);
};

SceneRenderer::State::State() {
  glGetIntegerv(GL_MAX_SAMPLES, &most_samples);
  glGenVertexArrays(1, &screen_array);
  glGenTextures(1, &reflections);
}

SceneRenderer::State::~State() {
  glDeleteVertexArrays(1, &screen_array);
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
  const bool has_holes = surface.cut || surface.alpha_cutoff >= 0.0;
  std::unique_ptr<Program>& made = surfaces[{surface.shading, has_holes}];
  if (!made) {
    made = std::make_unique<Program>(surface_vertex_shader(),
                                     surface_fragment_shader(surface.shading, has_holes));
    made->use();
    const std::pair<const char*, int> units[] = {
        {"colour_map", colour_unit},      {"normal_map", normal_unit}, {"surface_map", surface_unit},
        {"reflections", reflection_unit}, {"shadow_map", shadow_unit}, {"screen_map", screen_unit}};
    for (const auto& [name, unit] : units)
      made->set(name, unit);
  }
  return *made;
}

void SceneRenderer::State::draw_screen() const {
  glBindVertexArray(screen_array);
  glDrawArrays(GL_TRIANGLES, 0, 3);
}

void SceneRenderer::State::draw_shadows(const DrawList& list, const LightFrame& frame, int size) {
  shadow_map.bind(size, size);
  glClear(GL_DEPTH_BUFFER_BIT);
  glEnable(GL_DEPTH_TEST);
  glDisable(GL_CULL_FACE);
  depth.use();
  set_matrix(depth, "to_clip", frame.matrix);
  depth.set("colour_map", colour_unit);
  for (size_t i = 0; i < list.surfaces.size(); ++i) {
    const DrawSurface& surface = list.surfaces[i];
    if (!is_solid(surface)) continue;
    set_holes(depth, surface);
    surface_buffers[i]->draw_triangles();
  }
}

void SceneRenderer::State::set_holes(const Program& p, const DrawSurface& surface) {
  const bool has_holes = surface.colour_map && (surface.alpha_cutoff >= 0.0 || surface.is_blended);
  p.set("has_holes", has_holes ? 1 : 0);
  p.set("cutoff", surface.alpha_cutoff >= 0.0 ? surface.alpha_cutoff : 0.5);
  set_cut(p, surface);
  if (has_holes) bind_texture(colour_unit, GL_TEXTURE_2D, textures.name(surface.colour_map));
}

void SceneRenderer::State::set_shadows(const Program& p, const LightFrame& frame, const Look& look,
                                       double turn) {
  p.set("has_shadows", look.has_shadows ? 1 : 0);
  p.set("key_size", room.key_size);
  set_matrix(p, "to_light", frame.matrix);
  p.set("light_span", frame.span);
  p.set("light_range", frame.range);
  p.set("turn", turn);
}

void SceneRenderer::State::draw_geometry(const DrawList& list, const Camera& camera, double aspect, int width,
                                         int height) {
  geometry_map.bind(width, height);
  glClearColor(0, 0, 0, 0);
  glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
  glEnable(GL_DEPTH_TEST);
  geometry.use();
  geometry.set("colour_map", colour_unit);
  set_matrix(geometry, "to_eye", eye_matrix(camera));
  set_matrix(geometry, "to_clip", clip_matrix(camera, aspect) * eye_matrix(camera));
  for (size_t i = 0; i < list.surfaces.size(); ++i) {
    const DrawSurface& surface = list.surfaces[i];
    if (is_glass(surface) || surface.shading == Shading::hair) continue;
    set_holes(geometry, surface);
    set_culling(surface);
    surface_buffers[i]->draw_triangles();
  }
  glDisable(GL_DEPTH_TEST);
  glDisable(GL_CULL_FACE);
}

void SceneRenderer::State::draw_screen_light(const Camera& camera, const LightFrame& frame, const Look& look,
                                             double aspect, int width, int height) {
  raw_light.bind(width, height);
  const Program& p = screen_light;
  p.use();
  p.set("geometry", 0);
  p.set("shadow_map", shadow_unit);
  p.set("has_occlusion", look.has_occlusion ? 1 : 0);
  set_shadows(p, frame, look, 0.0);
  glUniform2f(p.place("size"), static_cast<float>(width), static_cast<float>(height));
  const double half = std::tan(camera.field_of_view * EIGEN_PI / 360.0);
  glUniform2f(p.place("scale"), static_cast<float>(half * aspect), static_cast<float>(half));
  p.set("radius", occlusion_radius);
  set_matrix(p, "from_eye", eye_matrix(camera).inverse());
  bind_texture(shadow_unit, GL_TEXTURE_2D, shadow_map.depth());
  bind_texture(0, GL_TEXTURE_2D, geometry_map.colour());
  draw_screen();
  smooth_light.bind(width, height);
  blur.use();
  blur.set("light", 0);
  bind_texture(0, GL_TEXTURE_2D, raw_light.colour());
  draw_screen();
}

void SceneRenderer::State::set_frame(const Program& p, const Camera& camera, const LightFrame& frame,
                                     const Look& look, double turn) {
  set_vector(p, "camera", eye_of(camera));
  set_vector(p, "view_direction", (camera.target - eye_of(camera)).normalized());
  set_vector(p, "key_direction", room.key_direction);
  set_vector(p, "key_irradiance", room.key_irradiance);
  p.set("exposure", look.exposure);
  p.set("reflection_levels", static_cast<double>(reflection_levels - 1));
  float flat[27];
  for (size_t k = 0; k < 27; ++k)
    flat[k] = static_cast<float>(harmonics[k / 3][static_cast<Eigen::Index>(k % 3)]);
  glUniform3fv(p.place("harmonics"), 9, flat);
  set_shadows(p, frame, look, turn);
  p.set("screen_scale", 1.0 / screen_divisor(look));
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
  set_vector(p, "glow", surface.glow);
  set_cut(p, surface);
  set_culling(surface);
}

void SceneRenderer::State::draw_backdrop(const Look& look, int width, int height) {
  backdrop.use();
  glUniform3f(backdrop.place("background"), look.background[0] / 255.0F, look.background[1] / 255.0F,
              look.background[2] / 255.0F);
  backdrop.set("aspect", static_cast<double>(width) / height);
  glDisable(GL_DEPTH_TEST);
  draw_screen();
}

void SceneRenderer::State::draw_round(const DrawList& list, const Camera& camera, const LightFrame& frame,
                                      const Look& look, int width, int height, const Mat4& to_clip,
                                      double turn) {
  glClearColor(look.background[0] / 255.0F, look.background[1] / 255.0F, look.background[2] / 255.0F, 1.0F);
  glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
  glDisable(GL_BLEND);
  if (look.has_backdrop) draw_backdrop(look, width, height);
  glEnable(GL_DEPTH_TEST);
  glDepthFunc(GL_LESS);
  const auto prepare = [&](size_t i) {
    const Program& p = program(list.surfaces[i]);
    p.use();
    set_matrix(p, "to_clip", to_clip);
    set_frame(p, camera, frame, look, turn);
    set_surface(p, list.surfaces[i]);
    bind_texture(reflection_unit, GL_TEXTURE_CUBE_MAP, reflections);
    bind_texture(shadow_unit, GL_TEXTURE_2D, shadow_map.depth());
    bind_texture(screen_unit, GL_TEXTURE_2D, smooth_light.colour());
  };
  for (size_t i = 0; i < list.surfaces.size(); ++i) {
    if (is_glass(list.surfaces[i])) continue;
    prepare(i);
    surface_buffers[i]->draw_triangles();
  }
  const auto draw_lines = [&](bool on_top) {
    lines.use();
    set_matrix(lines, "to_clip", to_clip);
    for (size_t i = 0; i < list.lines.size(); ++i) {
      if (list.lines[i].is_on_top != on_top) continue;
      glLineWidth(static_cast<float>(list.lines[i].width));
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

void SceneRenderer::draw(const DrawList& list, const Camera& camera, const Target& target, const Look& look) {
  State& s = *state_;
  const int width = target.width, height = target.height;
  if (width < 1 || height < 1) return;
  glDisable(GL_SCISSOR_TEST);
  glDisable(GL_BLEND);
  glEnable(GL_TEXTURE_CUBE_MAP_SEAMLESS);
  s.textures.tidy();
  s.upload(list);
  s.use_light(look.light);
  const LightFrame frame = light_frame(s.room.key_direction, list);
  if (look.has_shadows) s.draw_shadows(list, frame, width * height > 700 * 700 ? 2048 : 1024);
  const double aspect = static_cast<double>(width) / height;
  const int divisor = screen_divisor(look), w = (width + divisor - 1) / divisor,
            h = (height + divisor - 1) / divisor;
  s.draw_geometry(list, camera, aspect, w, h);
  s.draw_screen_light(camera, frame, look, aspect, w, h);

  const int samples = std::min({4, s.most_samples, std::max(1, look.samples)});
  const int rounds = std::max(1, look.samples / std::max(1, samples));
  if (!s.drawn) s.drawn = std::make_unique<Canvas>(GL_RGBA8, Canvas::Depth::buffer, samples);
  for (int r = 0; r < rounds; ++r) {
    // Rounds are set a fraction of a pixel apart, along a sequence that fills the pixel evenly (R2, Roberts
    // 2018).
    const double share = static_cast<double>(r) / rounds;
    Mat4 nudge = Mat4::Identity();
    if (rounds > 1) {
      nudge(0, 3) = (std::fmod(0.5 + 0.7548776662 * r, 1.0) - 0.5) * 1.0 / width;
      nudge(1, 3) = (std::fmod(0.5 + 0.5698402910 * r, 1.0) - 0.5) * 1.0 / height;
    }
    const Mat4 eye = eye_matrix(camera);
    s.drawn->bind(width, height);
    s.draw_round(list, camera, frame, look, width, height, nudge * clip_matrix(camera, aspect) * eye, share);
    s.resolved.bind(width, height);
    glBindFramebuffer(GL_READ_FRAMEBUFFER, s.drawn->framebuffer());
    glBlitFramebuffer(0, 0, width, height, 0, 0, width, height, GL_COLOR_BUFFER_BIT, GL_NEAREST);
    if (rounds == 1) break;
    s.gathered.bind(width, height);
    s.copy.use();
    s.copy.set("grain", 0.0);
    s.copy.set("picture", 0);
    bind_texture(0, GL_TEXTURE_2D, s.resolved.colour());
    glEnable(GL_BLEND);
    glBlendColor(0, 0, 0, 1.0F / static_cast<float>(r + 1));
    glBlendFunc(GL_CONSTANT_ALPHA, GL_ONE_MINUS_CONSTANT_ALPHA);
    s.draw_screen();
    glDisable(GL_BLEND);
  }
  glBindFramebuffer(GL_FRAMEBUFFER, target.framebuffer);
  glViewport(target.x, target.y, width, height);
  s.copy.use();
  s.copy.set("grain", look.has_backdrop ? 1.0 : 0.0);
  s.copy.set("picture", 0);
  bind_texture(0, GL_TEXTURE_2D, rounds == 1 ? s.resolved.colour() : s.gathered.colour());
  s.draw_screen();
  glDisable(GL_CULL_FACE);
}

}  // namespace fascia::view
