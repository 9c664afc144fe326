#pragma once

#include <array>
#include <string>
#include <vector>

#include "geometry/mesh.h"

namespace fascia::view {

/// A soft box: a bright disc in the environment.
struct SoftBox {
  Vec3 direction;  ///< unit, toward it, in the scene's axes
  Vec3 radiance;   ///< linear
  double inner,
      outer;  ///< cosines of the angles from its middle within which it is whole and beyond which gone
};

/// A studio environment: graded walls, soft boxes, and one light that casts shadows.
struct Environment {
  Vec3 ceiling, wall, floor;  ///< radiance of the room itself, linear
  std::vector<SoftBox> boxes;
  Vec3 key_direction;      ///< unit, toward the light
  Vec3 key_irradiance;     ///< on a surface that faces it, over pi
  double key_size = 0.12;  ///< half width of its penumbra's cone: tangent of its half angle

  /// Radiance of the room from a direction (unit).
  Vec3 radiance(const Vec3& direction) const;
};

/// studio, soft, dramatic, outdoor or flat. Throws fascia::Error for another name.
Environment environment(const std::string& name);

/// Coefficients of the irradiance over pi in the first nine real spherical harmonics: Ramamoorthi &
/// Hanrahan 2001, An efficient representation for irradiance environment maps.
std::array<Vec3, 9> irradiance(const Environment& environment);

/// The room prefiltered for reflections of the given roughness: one face of a cube map in OpenGL's order,
/// `size` x `size`, RGB. Karis 2013, Real shading in Unreal Engine 4.
std::vector<float> reflection_face(const Environment& environment, int face, int size, double roughness);

}  // namespace fascia::view
