#include <algorithm>
#include <cmath>
#include <optional>

#include "builder/spatial/surface_query.h"
#include "builder/tissue/elements.h"

namespace fascia::tissue {
namespace {

struct Patch {
  Vec3 centre;
  double radius, bone, skin;
};

/// The face's planes and firm places by landmarks: wide gliding at forehead, prezygomatic space and buccal
/// cheek; firm at the bridge of the nose, the parotid region, temple line and the mandibular ligament
/// (Mendelson & Wong 2012; Keller's attachment strengths after Rohrich & Pessa 2007).
std::vector<Patch> patches_of(const TissueInputs& inputs) {
  const Vec3 glabella = landmark(inputs, "glabella"), nose = landmark(inputs, "subnasale"),
             tip = landmark(inputs, "pronasale");
  const double third = glabella.y() - nose.y();
  std::vector<Patch> patches;
  patches.push_back({glabella + Vec3(0, 0.55, -0.1) * third, 0.6 * third, 0.30, 0.8});
  patches.push_back({0.5 * (landmark(inputs, "sellion") + tip), 0.22 * third, 3.0, 1.3});
  patches.push_back({landmark(inputs, "gnathion") + Vec3(0, 0.15, 0.05) * third, 0.3 * third, 1.2, 2.0});
  for (const char* side : {"_left", "_right"}) {
    const std::string s = side;
    const Vec3 outer = landmark(inputs, "exocanthion" + s), corner = landmark(inputs, "cheilion" + s);
    const Vec3 ear = landmark(inputs, "tragion" + s), inner = landmark(inputs, "endocanthion" + s);
    patches.push_back(
        {glabella + Vec3(outer.x() * 0.8, 0.45 * third, -0.25 * third), 0.45 * third, 0.35, 0.8});
    patches.push_back(
        {0.5 * (0.5 * (inner + outer) + corner) + 0.2 * (ear - corner), 0.3 * third, 0.45, 0.7});
    patches.push_back({ear + 0.15 * (corner - ear), 0.45 * third, 3.0, 1.2});
    patches.push_back({0.5 * (ear + outer) + Vec3(0, 0.15 * third, 0), 0.25 * third, 1.6, 0.8});
    patches.push_back({corner + Vec3(0.1 * corner.x(), -0.45 * third, -0.2 * third), 0.18 * third, 1.5, 1.0});
    patches.push_back({corner + 0.12 * (ear - corner), 0.25 * third, 0.6, 2.5});  // modiolus
    patches.push_back({0.5 * (corner + nose), 0.2 * third, 0.9, 2.0});            // nasolabial line
    patches.push_back(
        {glabella + Vec3(0.6 * outer.x(), 0.05 * third, -0.1 * third), 0.3 * third, 0.6, 2.5});  // brow
    patches.push_back({0.5 * (corner + ear) + Vec3(0, -0.05 * third, 0), 0.3 * third, 0.6, 0.7});
  }
  return patches;
}

/// What cartilage, frenula and the mentalis hold to the skull beyond their surroundings: nose, lips, chin.
struct Hold {
  Vec3 centre;
  double radius, factor;
};

std::vector<Hold> holds_of(const TissueInputs& inputs) {
  const Vec3 glabella = landmark(inputs, "glabella"), nose = landmark(inputs, "subnasale"),
             tip = landmark(inputs, "pronasale");
  const Vec3 chin = landmark(inputs, "gnathion"), sellion = landmark(inputs, "sellion");
  const Vec3 mouth = 0.5 * (landmark(inputs, "cheilion_left") + landmark(inputs, "cheilion_right"));
  const double third = glabella.y() - nose.y();
  const Vec3 upper_lip(nose.x(), nose.y() + 0.45 * (mouth.y() - nose.y()), nose.z());
  const Vec3 lower_lip(chin.x(), 0.6 * mouth.y() + 0.4 * chin.y(), 0.5 * (chin.z() + nose.z()));
  return {{tip, 0.4 * third, 3.9},
          {0.5 * (sellion + tip), 0.4 * third, 2.9},
          {upper_lip, 0.28 * third, 5.0},
          {lower_lip, 0.3 * third, 6.0},
          {chin + Vec3(0, 0.1, 0) * third, 0.45 * third, 1.4}};
}

double smoothstep(double low, double high, double x) {
  const double t = std::clamp((x - low) / (high - low), 0.0, 1.0);
  return t * t * (3.0 - 2.0 * t);
}

}  // namespace

Attachments attachments_of(const TissueInputs& inputs, const Columns& c) {
  const auto n = static_cast<size_t>(c.count());
  Attachments a;
  a.bone.assign(n, 1.0);
  a.skin.assign(n, 1.0);
  a.normal.assign(n, 1.0);
  const std::vector<Patch> patches = patches_of(inputs);
  const std::vector<Hold> holds = holds_of(inputs);
  const Vestibule vestibule(inputs);
  std::optional<spatial::SurfaceQuery> smas;
  const bool measured =
      !inputs.smas.empty() && inputs.smas_bone_attachment.size() == inputs.smas.vertices.size();
  if (measured) smas.emplace(inputs.smas);
  for (size_t v = 0; v < n; ++v) {
    double bone = 0.0, skin = 0.0, sum = 0.0;  // mean of logarithms where patches overlap
    for (const Patch& patch : patches) {
      const double r = (c.mesh.vertices[v] - patch.centre).norm() / patch.radius, weight = std::exp(-r * r);
      bone += weight * std::log(patch.bone);
      skin += weight * std::log(patch.skin);
      sum += weight;
    }
    bone /= std::max(1.0, sum);
    skin /= std::max(1.0, sum);
    a.bone[v] = std::exp(bone);
    a.skin[v] = std::exp(skin);
    if (measured) {
      const SurfacePoint p = smas->closest(c.smas[v]).surface;
      double firm = 0.0;
      for (int k = 0; k < 3; ++k)
        firm += p.barycentric[k] *
                static_cast<double>(inputs.smas_bone_attachment[static_cast<size_t>(
                    inputs.smas.triangles[static_cast<size_t>(p.triangle)][static_cast<size_t>(k)])]);
      a.bone[v] = std::exp(0.5 * (bone + std::log(0.25 * std::pow(12.0, std::clamp(firm, 0.0, 1.0)))));
    }
    // Lips hang on no bone nearer than 15 mm; lids are held by their plates, not by tethers.
    const double lips = smoothstep(0.005, 0.016, c.opening_distance[static_cast<size_t>(Opening::mouth)][v]);
    const double lids = smoothstep(0.005, 0.012,
                                   std::min(c.opening_distance[static_cast<size_t>(Opening::eye_left)][v],
                                            c.opening_distance[static_cast<size_t>(Opening::eye_right)][v]));
    const double near = 0.08 + 0.92 * lids * (0.08 + 0.92 * lips);
    a.bone[v] *= near;
    a.normal[v] = near;
    // Mucosa behind, and air: also where a mesh has no lining there.
    const double air =
        c.bone[v] ? vestibule.share(c.mesh.vertices[v]) * smoothstep(0.006, 0.010, c.inner_depth[v]) : 1.0;
    a.bone[v] *= 1.0 - 0.65 * air;
    a.normal[v] *= 1.0 - 0.9 * air;
    double hold = 1.0;
    for (const Hold& h : holds) {
      const double r = (c.mesh.vertices[v] - h.centre).norm() / h.radius;
      hold = std::max(hold, 1.0 + (h.factor - 1.0) * std::exp(-r * r));
    }
    a.bone[v] *= hold;
    a.normal[v] *= hold;
  }
  return a;
}

}  // namespace fascia::tissue
