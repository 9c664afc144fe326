#include "builder/skull/from_anatomy.h"

#include "geometry/error.h"

namespace fascia::skull {
namespace {

TriangleMesh mesh_of(const anatomy::MeshObject* object) {
  return object ? object->mesh : TriangleMesh{};
}

// Centre of a condyle: midway between its poles, at the height of its axis.
Vec3 condyle(const anatomy::GenericAnatomy& anatomy, const std::string& side) {
  const anatomy::Landmark* lateral = anatomy.landmark("condylion_laterale_" + side);
  const anatomy::Landmark* medial = anatomy.landmark("condylion_mediale_" + side);
  if (!lateral || !medial || !lateral->bone || !medial->bone)
    throw Error("anatomy: the poles of the " + side + " condyle are missing among the landmarks");
  return 0.5 * (*lateral->bone + *medial->bone);
}

}  // namespace

Generic from_anatomy(const anatomy::GenericAnatomy& anatomy, const std::string& depth_table) {
  Generic out;
  out.cranium = mesh_of(anatomy.skull_object("cranium"));
  out.mandible = mesh_of(anatomy.skull_object("mandible"));
  out.teeth_upper = mesh_of(anatomy.skull_object("teeth_upper"));
  out.teeth_lower = mesh_of(anatomy.skull_object("teeth_lower"));
  out.skin = mesh_of(anatomy.head_object("skin"));
  if (out.cranium.empty() || out.mandible.empty())
    throw Error("anatomy: the generic skull lacks a cranium or a mandible");
  if (anatomy.depth_tables.empty()) throw Error("anatomy: there is no table of tissue depths");
  const anatomy::TissueDepthTable* table =
      depth_table.empty() ? &anatomy.depth_tables.front() : anatomy.depth_table(depth_table);
  if (!table) {
    std::string known;
    for (const auto& other : anatomy.depth_tables)
      known += (known.empty() ? "" : ", ") + other.name;
    throw Error("there is no tissue depth table '" + depth_table + "'; known are " + known);
  }
  for (const anatomy::Landmark& landmark : anatomy.landmarks) {
    if (!landmark.skin) continue;
    GenericLandmark entry;
    entry.name = landmark.name;
    entry.skin = *landmark.skin;
    entry.has_bone = landmark.bone.has_value();
    if (entry.has_bone) {
      entry.bone = *landmark.bone;
      entry.depth = (entry.skin - entry.bone).norm();
      if (const anatomy::TissueDepth* depth = table->find(landmark.depth)) {
        entry.depth = depth->mean;
        if (depth->deviation > 0) entry.depth_sd = depth->deviation;
      }
    }
    out.landmarks.push_back(std::move(entry));
  }
  for (const anatomy::Curve& curve : anatomy.curves)
    if (curve.on == "cranium" || curve.on == "mandible")
      out.curves.push_back({curve.name, curve.closed, curve.points});
  out.condyle_left = condyle(anatomy, "left");
  out.condyle_right = condyle(anatomy, "right");
  out.jaw = anatomy.mechanics.jaw;
  return out;
}

}  // namespace fascia::skull
