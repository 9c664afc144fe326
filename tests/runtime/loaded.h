#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "fascia/fascia.h"
#include "tests/rig/tiny_rig.h"

// A loaded rig, a face of it and what tests ask of them, through the C interface.
namespace fascia::test {

inline constexpr uint32_t side = 17;

struct Loaded {
  explicit Loaded(const std::vector<uint8_t>& bytes = tiny_rig_file()) {
    EXPECT_EQ(fascia_asset_load(bytes.data(), bytes.size(), &asset), FASCIA_OK) << fascia_last_message();
  }
  ~Loaded() { fascia_asset_release(asset); }
  Loaded(const Loaded&) = delete;
  Loaded& operator=(const Loaded&) = delete;
  fascia_asset* asset = nullptr;
};

struct Face {
  explicit Face(fascia_asset* asset, fascia_space space = FASCIA_SPACE_METRES) {
    fascia_face_options options = fascia_default_face_options();
    options.space = space;
    EXPECT_EQ(fascia_face_create(asset, &options, &face), FASCIA_OK) << fascia_last_message();
  }
  ~Face() { fascia_face_release(face); }
  Face(const Face&) = delete;
  Face& operator=(const Face&) = delete;

  std::vector<float> positions() const {
    fascia_vectors vectors = {};
    vectors.struct_size = sizeof vectors;
    EXPECT_EQ(fascia_face_positions(face, 0, &vectors), FASCIA_OK) << fascia_last_message();
    return {vectors.data, vectors.data + 3 * vectors.count};
  }
  std::vector<float> normals() const {
    fascia_vectors vectors = {};
    vectors.struct_size = sizeof vectors;
    EXPECT_EQ(fascia_face_normals(face, 0, &vectors), FASCIA_OK) << fascia_last_message();
    return {vectors.data, vectors.data + 3 * vectors.count};
  }
  fascia_face* face = nullptr;
};

inline double largest_motion(const std::vector<float>& a, const std::vector<float>& b) {
  double most = 0;
  for (std::size_t i = 0; i < a.size(); ++i)
    most = std::max(most, std::abs(static_cast<double>(a[i]) - b[i]));
  return most;
}

/// Coordinate `axis` of the vertex where the left strap inserts, 2 columns left of the middle.
inline float left_corner(const std::vector<float>& positions, int axis, int direction = 1) {
  const int vertex = (side / 2) * static_cast<int>(side) + side / 2 + direction * 2;
  return positions[static_cast<std::size_t>(3 * vertex + axis)];
}

}  // namespace fascia::test
