#include <algorithm>
#include <cmath>
#include <optional>

#include "builder/spatial/surface_query.h"
#include "builder/tissue/elements.h"

namespace fascia::tissue {
namespace {

/// A place of this face, and over how many metres its effect falls to 1/e.
struct Spot {
  Vec3 centre;
  double radius;
  double weight(const Vec3& point) const {
    const double r = (point - centre).norm() / radius;
    return std::exp(-r * r);
  }
};

Spot spot_of(const TissueInputs& inputs, const anatomy::FacePlace& place) {
  const double third = face_third(inputs);
  Vec3 centre = third * place.offset;
  for (const anatomy::FacePlace::Part& part : place.parts)
    centre += part.share.cwiseProduct(landmark(inputs, part.landmark));
  return {centre, place.radius * third};
}

/// Factors of the hold of bone on the SMAS and of the SMAS on the skin, from the face's gliding and firm
/// places.
class Regions {
 public:
  explicit Regions(const TissueInputs& inputs) : regions_(inputs.mechanics.attachment_regions) {
    for (const anatomy::AttachmentRegion& region : regions_)
      spots_.push_back(spot_of(inputs, region.place));
  }
  /// Logarithms of both factors at `point`: the mean of those of the places that overlap there.
  Vec2 at(const Vec3& point) const {
    Vec2 sum = Vec2::Zero();
    double weights = 0.0;
    for (size_t i = 0; i < spots_.size(); ++i) {
      const double weight = spots_[i].weight(point);
      sum += weight * Vec2(std::log(regions_[i].bone), std::log(regions_[i].skin));
      weights += weight;
    }
    return sum / std::max(1.0, weights);
  }

 private:
  const std::vector<anatomy::AttachmentRegion>& regions_;
  std::vector<Spot> spots_;
};

/// What the holds of nose, lips and chin make of the hold of bone.
class Holds {
 public:
  explicit Holds(const TissueInputs& inputs) : holds_(inputs.mechanics.holds) {
    for (const anatomy::Hold& hold : holds_)
      spots_.push_back(spot_of(inputs, hold.place));
  }
  double at(const Vec3& point) const {
    double strongest = 1.0;
    for (size_t i = 0; i < spots_.size(); ++i)
      strongest = std::max(strongest, 1.0 + (holds_[i].factor - 1.0) * spots_[i].weight(point));
    return strongest;
  }

 private:
  const std::vector<anatomy::Hold>& holds_;
  std::vector<Spot> spots_;
};

/// The zones of the SMAS: how firmly it is attached to bone.
class Zones {
 public:
  explicit Zones(const TissueInputs& inputs) : inputs_(inputs) {
    if (!inputs.smas.empty() && inputs.smas_bone_attachment.size() == inputs.smas.vertices.size())
      query_.emplace(inputs.smas);
  }
  bool known() const { return query_.has_value(); }
  /// 0 gliding .. 1 firm.
  double firmness(const Vec3& point) const {
    const SurfacePoint p = query_->closest(point).surface;
    double firm = 0.0;
    for (int k = 0; k < 3; ++k)
      firm += p.barycentric[k] *
              static_cast<double>(inputs_.smas_bone_attachment[static_cast<size_t>(
                  inputs_.smas.triangles[static_cast<size_t>(p.triangle)][static_cast<size_t>(k)])]);
    return std::clamp(firm, 0.0, 1.0);
  }

 private:
  const TissueInputs& inputs_;
  std::optional<spatial::SurfaceQuery> query_;
};

}  // namespace

Attachments attachments_of(const TissueInputs& inputs, const Columns& c) {
  const anatomy::mechanics::Attachment& m = inputs.mechanics.attachment;
  const auto n = static_cast<size_t>(c.count());
  Attachments a;
  a.bone.assign(n, 1.0);
  a.skin.assign(n, 1.0);
  a.normal.assign(n, 1.0);
  const Regions regions(inputs);
  const Holds holds(inputs);
  const Zones zones(inputs);
  const Vestibule vestibule(inputs);
  for (size_t v = 0; v < n; ++v) {
    const Vec3& p = c.mesh.vertices[v];
    const Vec2 factors = regions.at(p);
    double bone = factors[0];
    if (zones.known()) {
      const double zone =
          std::log(m.free_factor * std::pow(m.firm_factor / m.free_factor, zones.firmness(c.smas[v])));
      bone = (1.0 - m.zone_share) * bone + m.zone_share * zone;
    }
    // Lips hang on no bone near their edge; lids are held by their plates, not by tethers.
    const double lips = m.lip_fade.rise(c.opening_distance[static_cast<size_t>(Opening::mouth)][v]);
    const double lids =
        m.lid_fade.rise(std::min(c.opening_distance[static_cast<size_t>(Opening::eye_left)][v],
                                 c.opening_distance[static_cast<size_t>(Opening::eye_right)][v]));
    const double near = m.lid_share + (1.0 - m.lid_share) * lids * (m.lip_share + (1.0 - m.lip_share) * lips);
    // Mucosa behind, and air: also where a mesh has no lining there.
    const double air = c.bone[v] ? vestibule.share(p) * m.air_depth.rise(c.inner_depth[v]) : 1.0;
    const double hold = holds.at(p);
    a.skin[v] = std::exp(factors[1]);
    a.bone[v] = std::exp(bone) * near * (1.0 - m.air_shear_loss * air) * hold;
    a.normal[v] = near * (1.0 - m.air_normal_loss * air) * hold;
  }
  return a;
}

}  // namespace fascia::tissue
