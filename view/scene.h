#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "geometry/mesh.h"
#include "view/image.h"

/// A scene to draw: surfaces with materials, lines, lights. Plain data, no OpenGL.
namespace fascia::view {

/// An RGBA picture on a surface, rows from the top, wrapped around at its edges. Renderers keep their copy of
/// it as long as it lives, so share one object among the frames of a film.
struct Texture {
  int width = 0, height = 0;
  std::vector<uint8_t> pixels;  ///< width * height * 4
  bool is_srgb = true;          ///< colours are; normals and roughness are linear
};

/// Shading models.
enum class Shading {
  plain,   ///< standard rough or metallic material
  skin,    ///< subsurface scattering at shadow edges and thin parts, oily specular layer
  mucosa,  ///< skin under saliva
  tooth,   ///< enamel under saliva
  eye,     ///< an eyeball; without a colour map, iris and pupil are drawn after `eye_coordinates`
  hair,    ///< lashes, brows, hair
  bone,
  muscle,
  xray,  ///< transparent, most opaque at grazing angles
  data,  ///< heat maps: colours are preserved, with weak shading
};

/// A surface to draw.
struct DrawSurface {
  std::vector<Vec3> positions;
  std::vector<Triangle> triangles;
  Vec3 colour = Vec3(0.8, 0.8, 0.8);  ///< sRGB, 0..1; multiplies the colour map
  std::vector<Vec3> vertex_colours;   ///< one a vertex in place of `colour`, or none
  double opacity = 1.0;               ///< below 1 the surface is drawn last and blended
  double shine = 0.2;                 ///< strength of the highlight of plain surfaces
  bool is_two_sided = true;           ///< else the back is not drawn
  bool is_fine = false;  ///< finer than a pixel: left out below four samples, where it would be dots

  Shading shading = Shading::plain;
  double roughness = -1.0;  ///< 0 mirror .. 1 chalk; below 0: what is usual for `shading`
  double metalness = 0.0;
  Vec3 glow = Vec3::Zero();  ///< light given off, sRGB
  std::vector<Vec2> uvs;     ///< one a vertex, (0, 0) the map's top left corner; none: no maps
  std::shared_ptr<const Texture> colour_map, normal_map;
  std::shared_ptr<const Texture> surface_map;  ///< green roughness, blue metalness (glTF's order)
  double normal_strength = 1.0;
  double alpha_cutoff = -1.0;  ///< 0 or more: alpha threshold of cut-outs
  bool is_blended = false;     ///< the colour map's transparency is blended

  /// Unit normals, one a vertex; none: from the triangles, smooth across `seams`.
  std::vector<Vec3> normals;
  /// For each vertex the first that lies at its place at rest (see `seams_of`); none: found by place.
  std::shared_ptr<const std::vector<int>> seams;
  /// Eyes: each vertex's direction from the eyeball's centre at rest, in a frame whose third axis is the
  /// gaze.
  std::vector<Vec3> eye_coordinates;
  /// Half space that is left out: what has n.p > d of (n, d), metres.
  std::optional<Eigen::Vector4d> cut;
};

/// Polylines to draw.
struct DrawLines {
  std::vector<std::vector<Vec3>> lines;
  Vec3 colour = Vec3(0.7, 0.15, 0.15);
  double width = 2.0;      ///< pixels
  bool is_on_top = false;  ///< drawn over everything
};

struct DrawList {
  std::vector<DrawSurface> surfaces;
  std::vector<DrawLines> lines;
};

/// Lighting and post-processing of a picture.
struct Look {
  Colour background = {38, 42, 48};
  bool has_backdrop = false;     ///< the background darkens toward its corners
  std::string light = "studio";  ///< studio, soft, dramatic, outdoor or flat (see environment.h)
  bool has_shadows = true;
  bool has_occlusion = true;  ///< ambient occlusion
  bool has_mirrors = true;    ///< what is wet inside a mouth mirrors only what it can see
  /// A pixel: 1; 2, drawn at one and a half times the size, half as dear as 4 (films); or more in steps of
  /// four.
  int samples = 8;
  double exposure = 1.0;
  /// Below 1, and with one sample a pixel: surfaces are drawn with fewer pixels each way, and enlarged.
  double resolution = 1.0;
};

}  // namespace fascia::view
