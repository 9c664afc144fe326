#include "view/environment.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "geometry/error.h"

namespace fascia::view {

namespace {

double smooth_step(double low, double high, double x) {
  const double t = std::clamp((x - low) / (high - low), 0.0, 1.0);
  return t * t * (3.0 - 2.0 * t);
}

Vec3 toward(double yaw, double pitch) {
  const double y = yaw * EIGEN_PI / 180.0, p = pitch * EIGEN_PI / 180.0;
  return {std::sin(y) * std::cos(p), std::sin(p), std::cos(y) * std::cos(p)};
}

/// Seen under `half_angle` (radians), its edge a fifth of that soft.
SoftBox soft_box(const Vec3& direction, const Vec3& radiance, double half_angle) {
  return {direction, radiance, std::cos(0.8 * half_angle), std::cos(1.12 * half_angle)};
}

Vec3 cube_direction(int face, double s, double t) {
  switch (face) {
    case 0:
      return Vec3(1, -t, -s).normalized();
    case 1:
      return Vec3(-1, -t, s).normalized();
    case 2:
      return Vec3(s, 1, t).normalized();
    case 3:
      return Vec3(s, -1, -t).normalized();
    case 4:
      return Vec3(s, -t, 1).normalized();
    default:
      return Vec3(-s, -t, -1).normalized();
  }
}

std::array<double, 9> harmonics(const Vec3& d) {
  return {0.282095,
          0.488603 * d[1],
          0.488603 * d[2],
          0.488603 * d[0],
          1.092548 * d[0] * d[1],
          1.092548 * d[1] * d[2],
          0.315392 * (3 * d[2] * d[2] - 1),
          1.092548 * d[0] * d[2],
          0.546274 * (d[0] * d[0] - d[1] * d[1])};
}

double reversed_bits(unsigned bits) {
  double value = 0.0, digit = 0.5;
  for (; bits; bits >>= 1, digit *= 0.5)
    value += digit * (bits & 1U);
  return value;
}

}  // namespace

Vec3 Environment::radiance(const Vec3& direction) const {
  const double up = direction[1];
  Vec3 light = up > 0 ? Vec3(wall + (ceiling - wall) * smooth_step(0, 0.9, up))
                      : Vec3(wall + (floor - wall) * smooth_step(0, 0.7, -up));
  for (const SoftBox& box : boxes) {
    const double cosine = direction.dot(box.direction);
    if (cosine > box.outer) light += box.radiance * smooth_step(box.outer, box.inner, cosine);
  }
  return light;
}

Environment environment(const std::string& name) {
  Environment room;
  if (name == "studio") {
    // A large key from the picture's upper left, a broad cool fill, two strips from behind for the outline.
    room.ceiling = Vec3(0.30, 0.31, 0.33);
    room.wall = Vec3(0.155, 0.16, 0.175);
    room.floor = Vec3(0.10, 0.085, 0.08);
    room.key_direction = toward(-38, 36);
    room.key_irradiance = Vec3(1.00, 0.94, 0.86) * 1.30;
    room.key_size = 0.16;
    room.boxes = {soft_box(toward(-38, 36), Vec3(1.0, 0.95, 0.88) * 7.0, 0.22),
                  soft_box(toward(55, 8), Vec3(0.80, 0.90, 1.0) * 0.9, 0.62),
                  soft_box(toward(140, 22), Vec3(0.86, 0.93, 1.0) * 5.0, 0.34),
                  soft_box(toward(-138, 28), Vec3(1.0, 0.95, 0.90) * 4.0, 0.30)};
  } else if (name == "soft") {
    room.ceiling = Vec3(0.60, 0.60, 0.60);
    room.wall = Vec3(0.42, 0.42, 0.43);
    room.floor = Vec3(0.26, 0.24, 0.23);
    room.key_direction = toward(-20, 40);
    room.key_irradiance = Vec3(1.0, 0.97, 0.93) * 0.85;
    room.key_size = 0.30;
    room.boxes = {soft_box(toward(-20, 40), Vec3(1.0, 0.98, 0.95) * 2.5, 0.5),
                  soft_box(toward(150, 25), Vec3(1, 1, 1) * 2.0, 0.4)};
  } else if (name == "dramatic") {
    room.ceiling = Vec3(0.05, 0.05, 0.06);
    room.wall = Vec3(0.035, 0.04, 0.05);
    room.floor = Vec3(0.02, 0.02, 0.02);
    room.key_direction = toward(-68, 32);
    room.key_irradiance = Vec3(1.0, 0.91, 0.80) * 2.3;
    room.key_size = 0.10;
    room.boxes = {soft_box(toward(-68, 32), Vec3(1.0, 0.92, 0.82) * 9.0, 0.20),
                  soft_box(toward(128, 15), Vec3(0.55, 0.75, 1.0) * 8.0, 0.34)};
  } else if (name == "outdoor") {
    room.ceiling = Vec3(0.52, 0.68, 0.95);
    room.wall = Vec3(0.55, 0.60, 0.68);
    room.floor = Vec3(0.20, 0.18, 0.14);
    room.key_direction = toward(35, 50);
    room.key_irradiance = Vec3(1.0, 0.93, 0.80) * 1.9;
    room.key_size = 0.05;
    room.boxes = {soft_box(toward(35, 50), Vec3(1.0, 0.95, 0.85) * 20.0, 0.09)};
  } else if (name == "flat") {
    room.ceiling = room.wall = room.floor = Vec3::Constant(0.62);
    room.key_direction = toward(0, 20);
    room.key_irradiance = Vec3::Constant(0.35);
    room.key_size = 0.3;
  } else {
    throw Error("light '" + name + "' is unknown: use studio, soft, dramatic, outdoor or flat");
  }
  return room;
}

std::array<Vec3, 9> irradiance(const Environment& environment) {
  std::array<Vec3, 9> sums;
  sums.fill(Vec3::Zero());
  const int size = 48;
  double total = 0.0;
  for (int face = 0; face < 6; ++face)
    for (int y = 0; y < size; ++y)
      for (int x = 0; x < size; ++x) {
        const double s = 2.0 * (x + 0.5) / size - 1.0, t = 2.0 * (y + 0.5) / size - 1.0;
        const double weight = std::pow(1.0 + s * s + t * t, -1.5);  // the texel's solid angle
        const Vec3 d = cube_direction(face, s, t), light = environment.radiance(d);
        const std::array<double, 9> basis = harmonics(d);
        for (size_t k = 0; k < 9; ++k)
          sums[k] += weight * basis[k] * light;
        total += weight;
      }
  // Convolution with the clamped cosine, over pi: 1, 2/3, 1/4 by band; and the basis functions' constants,
  // so that the shader multiplies by plain polynomials of the normal.
  const double band[9] = {1, 2.0 / 3, 2.0 / 3, 2.0 / 3, 0.25, 0.25, 0.25, 0.25, 0.25};
  const double constant[9] = {0.282095, 0.488603, 0.488603, 0.488603, 1.092548,
                              1.092548, 0.315392, 1.092548, 0.546274};
  for (size_t k = 0; k < 9; ++k)
    sums[k] *= 4.0 * EIGEN_PI / total * band[k] * constant[k];
  return sums;
}

std::vector<float> reflection_face(const Environment& environment, int face, int size, double roughness) {
  std::vector<float> pixels;
  pixels.reserve(static_cast<size_t>(size) * static_cast<size_t>(size) * 3);
  const unsigned count = roughness < 0.02 ? 1 : 64;
  const double alpha = roughness * roughness;
  for (int y = 0; y < size; ++y)
    for (int x = 0; x < size; ++x) {
      const Vec3 n = cube_direction(face, 2.0 * (x + 0.5) / size - 1.0, 2.0 * (y + 0.5) / size - 1.0);
      const Vec3 across = n.unitOrthogonal(), along = n.cross(across);
      Vec3 sum = Vec3::Zero();
      double weights = 0.0;
      for (unsigned i = 0; i < count; ++i) {
        // Hammersley's points, spread over the half vectors of the GGX lobe.
        const double turn = 2.0 * EIGEN_PI * (i + 0.5) / count, share = count == 1 ? 0.0 : reversed_bits(i);
        const double cosine = std::sqrt((1.0 - share) / (1.0 + (alpha * alpha - 1.0) * share));
        const double sine = std::sqrt(std::max(0.0, 1.0 - cosine * cosine));
        const Vec3 half = sine * std::cos(turn) * across + sine * std::sin(turn) * along + cosine * n;
        const Vec3 d = 2.0 * n.dot(half) * half - n;
        const double weight = n.dot(d);
        if (weight <= 0.0) continue;
        sum += weight * environment.radiance(d);
        weights += weight;
      }
      for (int k = 0; k < 3; ++k)
        pixels.push_back(static_cast<float>(sum[k] / std::max(weights, 1e-9)));
    }
  return pixels;
}

}  // namespace fascia::view
