#pragma once

#include <map>
#include <string>

#include "geometry/mesh.h"

namespace fascia {

/// Landmarks of a face by their names (anatomy/data/landmarks.json), such as "exocanthion_left".
using Landmarks = std::map<std::string, Vec3>;

/// The landmark called `name`; null when it is not among them or no finite point.
inline const Vec3* find_landmark(const Landmarks& landmarks, const std::string& name) {
  const auto found = landmarks.find(name);
  return found == landmarks.end() || !found->second.allFinite() ? nullptr : &found->second;
}

}  // namespace fascia
