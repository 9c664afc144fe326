#pragma once

#include <array>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "geometry/landmarks.h"
#include "geometry/mesh.h"

namespace fascia::check {

/// One piece of the user's head at rest: a primitive of the file, or what of a primitive is an eyeball.
struct Part {
  std::string name;                 ///< skin, eye_left, teeth_lower, hair, ... as rig::Binding::part
  TriangleMesh mesh;                ///< metres, rig frame, in the file's order of vertices
  std::vector<bool> is_still = {};  ///< #vertices: nothing moves it, as the eye of a scan; empty: not known
};

/// An eyeball as the rig has it.
struct Eye {
  Vec3 centre = Vec3::Zero();
  double radius = 0.0;  ///< metres
  Vec3 gaze = Vec3::UnitZ();
};

/// A head at rest: its meshes and what is known of it. Metres, +Y up, facing +Z, +X to the subject's left.
struct Head {
  std::vector<Part> parts;
  Landmarks landmarks;                     ///< on the skin, by full name
  std::array<std::optional<Eye>, 2> eyes;  ///< left, right
};

/// The vertices of every part in one pose, in the order of Head::parts.
using Shape = std::vector<std::vector<Vec3>>;

/// ARKit coefficients by name, such as {"jawOpen", 1}.
using Weights = std::vector<std::pair<std::string, double>>;

/// Plays a pose on a head: a rig's simulation, or a set of sculpted shapes. Returns nothing when it has no
/// shape for one of the names.
using Player = std::function<std::optional<Shape>(const Weights&)>;

/// The head's shape at rest.
Shape rest_shape(const Head& head);

}  // namespace fascia::check
