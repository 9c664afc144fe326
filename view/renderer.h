#pragma once

#include <memory>
#include <string>
#include <vector>

#include "geometry/mesh.h"
#include "view/image.h"

namespace fascia::view {

/// A surface to draw. Normals are computed from the triangles.
struct DrawSurface {
  std::vector<Vec3> positions;
  std::vector<Triangle> triangles;
  Vec3 colour = Vec3(0.8, 0.8, 0.8);  ///< sRGB, 0..1
  std::vector<Vec3> vertex_colours;   ///< one a vertex, or none
  double opacity = 1.0;               ///< below 1 the surface is drawn last and blended
  double shine = 0.2;                 ///< strength of the highlight
  bool is_two_sided = true;           ///< else the back is not drawn
};

/// Polylines to draw.
struct DrawLines {
  std::vector<std::vector<Vec3>> lines;
  Vec3 colour = Vec3(0.7, 0.15, 0.15);
  double width = 2.0;  ///< pixels
};

struct DrawList {
  std::vector<DrawSurface> surfaces;
  std::vector<DrawLines> lines;
};

/// A perspective camera that looks at `target` from `distance` metres, turned by `yaw` about +Y (0: from
/// the front, 90: at the subject's left side) and `pitch` upward, in degrees.
struct Camera {
  Vec3 target = Vec3::Zero();
  double distance = 1.0;
  double yaw = 0.0, pitch = 0.0;
  double field_of_view = 22.0;  ///< vertical, degrees
};

/// The camera of a named view (front, side, right, three-quarter, back) that frames `box`; `fill` is the
/// share of the picture's height that the box takes. Throws fascia::Error for another name.
Camera named_camera(const std::string& view, const Bounds& box, double fill = 0.9);

/// An OpenGL renderer without a display: EGL's surfaceless platform, on the processor where there is no
/// graphics card. Everything is drawn four times oversampled.
class Renderer {
 public:
  /// Throws fascia::Error when there is no EGL or OpenGL 3.3 to be had.
  Renderer(int width, int height);
  ~Renderer();
  Renderer(const Renderer&) = delete;
  Renderer& operator=(const Renderer&) = delete;

  Image draw(const DrawList& list, const Camera& camera, Colour background = {38, 42, 48}) const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace fascia::view
