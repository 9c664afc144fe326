#include <cmath>

#include "builder/rigging/stages.h"
#include "builder/rigging/zones.h"

namespace fascia::rigging {

rig::Smas rig_smas(const smas::Result& smas, const skull::FitResult& skull,
                   const anatomy::GenericAnatomy& anatomy) {
  rig::Smas out;
  out.surface = rig_surface(smas.mesh);
  const anatomy::Tissue& tissue = anatomy.tissue;
  const ZoneField to_skin(tissue.skin_attachments, tissue.skin_attachment, skull.warp);
  const ZoneField glide(tissue.gliding_planes, tissue.glide, skull.warp);
  const double free_travel = anatomy.mechanics.attachment.free_travel;
  for (size_t v = 0; v < smas.mesh.vertices.size(); ++v) {
    out.depth_to_skin.push_back(static_cast<float>(smas.skin_distance[v]));
    out.depth_to_bone.push_back(
        std::isfinite(smas.bone_distance[v]) ? static_cast<float>(smas.bone_distance[v]) : -1.0F);
    out.skin_attachment.push_back(static_cast<float>(std::clamp(to_skin(smas.mesh.vertices[v]), 0.0, 1.0)));
    out.bone_attachment.push_back(
        static_cast<float>(std::clamp(1.0 - glide(smas.mesh.vertices[v]) / free_travel, 0.0, 1.0)));
  }
  for (const anatomy::RetainingLigament& ligament : tissue.ligaments)
    for (size_t i = 0; i < ligament.bone.size() && i < ligament.skin.size(); ++i)
      out.ligaments.push_back(
          {ligament.name, skull.warp(ligament.bone[i]).cast<float>(),
           skull.warp(ligament.skin[i]).cast<float>(),
           static_cast<float>(ligament.stiffness / static_cast<double>(ligament.bone.size()))});
  return out;
}

}  // namespace fascia::rigging
