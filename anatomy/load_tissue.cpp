#include "anatomy/fields.h"

namespace fascia::anatomy {
namespace {

/// `value_key` names the zone's value; `scale` turns it into SI.
std::vector<Zone> zones_of(const Fields& root, const char* list, const char* value_key, double scale) {
  std::vector<Zone> zones;
  for (const Fields& entry : root.list(list)) {
    for (const Side side : sides_of(entry)) {
      Zone zone;
      zone.name = with_side(entry.text("name"), side);
      zone.side = side;
      zone.polygon = entry.points_mm("polygon");
      if (zone.polygon.size() < 3) entry.fail("\"polygon\" needs three corners or more");
      if (side == Side::right) zone.polygon = mirrored(zone.polygon);
      zone.value = value_key ? entry.number(value_key) * scale : 0.0;
      zone.falloff = entry.number_or("falloff_mm", 0.0) * 1e-3;
      zone.note = entry.text_or("note", "");
      zones.push_back(zone);
    }
  }
  return zones;
}

void add_ligament(const Fields& entry, std::vector<RetainingLigament>& ligaments) {
  for (const Side side : sides_of(entry)) {
    RetainingLigament ligament;
    ligament.name = with_side(entry.text("name"), side);
    ligament.side = side;
    ligament.type = entry.text("type");
    ligament.from = entry.text("from");
    ligament.bone = entry.points_mm("bone");
    ligament.skin = entry.points_mm("skin");
    ligament.stiffness = entry.number("stiffness_n_m");
    ligament.source = entry.text("source");
    if (ligament.bone.empty() || ligament.bone.size() != ligament.skin.size())
      entry.fail("\"bone\" and \"skin\" must have the same number of points");
    if (side == Side::right) {
      ligament.bone = mirrored(ligament.bone);
      ligament.skin = mirrored(ligament.skin);
    }
    ligaments.push_back(ligament);
  }
}

}  // namespace

void load_tissue(const DataFiles& files, GenericAnatomy& anatomy) {
  const Json document = files.json("tissue.json");
  const Fields root(document, files.place("tissue.json"));
  Tissue& tissue = anatomy.tissue;
  root.allow_only(
      {"units", "frame", "smas_depths", "skin_attachments", "gliding_planes", "ligaments", "elsewhere"});
  const Fields elsewhere = root.object("elsewhere");
  tissue.skin_attachment = elsewhere.number("skin_attachment");
  tissue.glide = elsewhere.number("glide_mm") * 1e-3;
  for (const Fields& site : root.object("smas_depths").list("sites")) {
    tissue.smas_depths.push_back(
        {site.text("landmark"), site.number("fraction"), site.number("free_depth_mm") * 1e-3});
    const SmasDepth& depth = tissue.smas_depths.back();
    if (!(depth.fraction > 0.0 && depth.fraction < 1.0 && depth.free_depth > 0.0))
      site.fail("\"fraction\" lies between 0 and 1, \"free_depth_mm\" is positive");
  }
  tissue.skin_attachments = zones_of(root, "skin_attachments", "strength", 1.0);
  tissue.gliding_planes = zones_of(root, "gliding_planes", "travel_mm", 1e-3);
  for (const Fields& entry : root.list("ligaments"))
    add_ligament(entry, tissue.ligaments);
}

}  // namespace fascia::anatomy
