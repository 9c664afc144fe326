#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "formats/scene.h"

namespace fascia::bench {

/// A measured face model that random people are drawn from: base + sum of c_i id_i, c_i standard normal, cut
/// at 2.2. Metres, +Y up, +Z front. (ICT-FaceKit: Li et al., Learning formation of physically-based face
/// attributes, 2020.)
class FaceModel {
 public:
  /// Reads ict_model.npz of the measured data. Throws fascia::Error when it is not there.
  FaceModel();

  /// Vertices of the person drawn with `seed`; the same for the same seed. Seed 0 is the mean head.
  std::vector<Vec3> vertices(uint32_t seed) const;

  /// The person as a file would bring it: `head`, `gums_tongue`, `teeth`, `eye_left`, `eye_right`, `lids`
  /// (tear lines and what else lies on them), `lashes`; the head's vertices come first, in the model's order.
  formats::Scene scene(uint32_t seed) const;

 private:
  std::vector<Vec3> base_;
  std::vector<double> modes_, scales_;
  std::vector<Triangle> triangles_;
};

}  // namespace fascia::bench
