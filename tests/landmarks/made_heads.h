#pragma once

#include <array>
#include <functional>
#include <map>
#include <string>

#include "anatomy/anatomy.h"
#include "formats/scene.h"
#include "geometry/landmarks.h"
#include "geometry/mesh.h"

/// Heads of our own making, with landmarks that are known: the embedded head with other proportions, dressed,
/// cut and in other triangles. Metres, +Y up, +Z front, until they are moved.
namespace fascia::testing {

struct MadeHead {
  std::string name;
  formats::Scene scene;
  Landmarks truth;           ///< landmarks of the face, file coordinates
  double millimetres = 1e3;  ///< of one file unit
};

using Bend = std::function<Vec3(const Vec3&)>;

/// Proportions by formula: stand-ins for people and characters, not measured ones.
Vec3 as_child(const Vec3& p);  ///< the face small under a large vault, the whole smaller
Vec3 with_large_eyes(const Vec3& p);
Vec3 as_elder(const Vec3& p);     ///< long nose and ears, sagging, in folds
Vec3 as_anime(const Vec3& p);     ///< eyes drawn large, hardly a nose, a pointed chin
Vec3 as_toon(const Vec3& p);      ///< broad, with a bulb of a nose and a small vault
Vec3 as_creature(const Vec3& p);  ///< a muzzle, heavy brows, a broad jaw

/// The embedded head, its skin first and then its other parts, every vertex and landmark where `bend` puts
/// it. Its meshes' names tell nothing.
MadeHead made_head(const anatomy::GenericAnatomy& anatomy, const std::string& name, const Bend& bend);

MadeHead moved(MadeHead head, const Mat3& rotation, double scale, const Vec3& shift);

/// Reflected in x; left landmarks become right ones.
MadeHead mirrored(MadeHead head);

/// Vertices and triangles in another order.
MadeHead reordered(MadeHead head, unsigned seed);

/// Every triangle in four.
MadeHead subdivided(MadeHead head);

/// The skin alone, in about so many triangles.
MadeHead coarse(MadeHead head, int triangles);

/// The skin in front of the ears alone, without what lies inside: an open mask.
MadeHead mask(MadeHead head);

/// On a body, in clothes, with hair over brows and ears; `names` are those of body, clothes and hair.
MadeHead dressed(MadeHead head, const std::array<std::string, 3>& names);

}  // namespace fascia::testing
