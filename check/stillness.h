#pragma once

#include <string>
#include <vector>

#include "check/head.h"

namespace fascia::check {

/// Displacement of parts that must not move.
struct Stillness {
  std::string name;   ///< hair, glasses, clothes, neck
  double most = 0.0;  ///< metres
  Vec3 place = Vec3::Zero();
};

/// Glasses and clothes whole, hair above the ears, and the skin of the neck more than `below` metres under
/// the chin. Only what the head has is in the list.
std::vector<Stillness> stillness(const Head& head, const Shape& shape, double below);

}  // namespace fascia::check
