#include <Eigen/Geometry>

#include "builder/rigging/stages.h"
#include "geometry/error.h"

namespace fascia::rigging {

namespace {

TriangleMesh object(const anatomy::GenericAnatomy& anatomy, const char* name) {
  const anatomy::MeshObject* found = anatomy.skull_object(name);
  return found ? found->mesh : TriangleMesh{};
}

/// Middle between the lateral and medial poles of a condyle.
Vec3 condyle_centre(const anatomy::GenericAnatomy& anatomy, const std::string& side) {
  Vec3 sum = Vec3::Zero();
  for (const char* pole : {"condylion_laterale_", "condylion_mediale_"}) {
    const anatomy::Landmark* landmark = anatomy.landmark(pole + side);
    if (!landmark || !landmark->bone) throw Error("the anatomy has no bone point '" + (pole + side) + "', on which the jaw turns");
    sum += *landmark->bone;
  }
  return 0.5 * sum;
}

skull::Generic generic_skull(const anatomy::GenericAnatomy& anatomy) {
  skull::Generic generic;
  generic.cranium = object(anatomy, "cranium");
  generic.mandible = object(anatomy, "mandible");
  generic.teeth_upper = object(anatomy, "teeth_upper");
  generic.teeth_lower = object(anatomy, "teeth_lower");
  if (const anatomy::MeshObject* skin = anatomy.head_object("skin")) generic.skin = skin->mesh;
  const anatomy::TissueDepthTable& depths = anatomy.depth_tables.front();
  for (const anatomy::Landmark& landmark : anatomy.landmarks) {
    if (!landmark.skin) continue;
    skull::GenericLandmark entry;
    entry.name = landmark.name;
    entry.skin = *landmark.skin;
    const anatomy::TissueDepth* depth = landmark.depth.empty() ? nullptr : depths.find(landmark.depth);
    entry.has_bone = landmark.bone.has_value() && depth;
    if (entry.has_bone) {
      entry.bone = *landmark.bone;
      entry.depth = depth->mean;
      entry.depth_sd = depth->deviation > 0 ? depth->deviation : 0.003;
    }
    generic.landmarks.push_back(entry);
  }
  generic.condyle_left = condyle_centre(anatomy, "left");
  generic.condyle_right = condyle_centre(anatomy, "right");
  return generic;
}

/// The head's own meshes of one part, joined.
TriangleMesh part_mesh(const prepare::PreparedHead& head, prepare::Part part) {
  TriangleMesh all;
  for (const prepare::PreparedMesh& mesh : head.meshes) {
    const int base = all.vertex_count();
    std::vector<Triangle> kept;
    for (const Triangle& t : mesh.triangles)
      if (mesh.parts[static_cast<size_t>(t[0])] == part) kept.push_back({t[0] + base, t[1] + base, t[2] + base});
    if (kept.empty()) continue;
    all.vertices.insert(all.vertices.end(), mesh.positions.begin(), mesh.positions.end());
    all.triangles.insert(all.triangles.end(), kept.begin(), kept.end());
  }
  // Only the part's own vertices may count, the rest would pull bounds and centres away.
  TriangleMesh compact;
  std::vector<int> map(all.vertices.size(), -1);
  for (Triangle t : all.triangles) {
    for (int& corner : t) {
      int& target = map[static_cast<size_t>(corner)];
      if (target < 0) {
        target = compact.vertex_count();
        compact.vertices.push_back(all.vertices[static_cast<size_t>(corner)]);
      }
      corner = target;
    }
    compact.triangles.push_back(t);
  }
  return compact;
}

rig::Eye rig_eye(const std::optional<prepare::Eyeball>& eye) {
  rig::Eye out;
  if (!eye) return out;
  out.centre = eye->centre.cast<float>();
  out.radius = static_cast<float>(eye->radius);
  out.gaze = eye->gaze.cast<float>();
  return out;
}

}  // namespace

rig::Surface rig_surface(const TriangleMesh& mesh) {
  rig::Surface surface;
  for (const Vec3& p : mesh.vertices) surface.positions.push_back(p.cast<float>());
  for (const Triangle& t : mesh.triangles)
    surface.triangles.push_back({static_cast<uint32_t>(t[0]), static_cast<uint32_t>(t[1]), static_cast<uint32_t>(t[2])});
  return surface;
}

skull::FitResult fit_skull(const anatomy::GenericAnatomy& anatomy, const prepare::PreparedHead& head,
                           const SkinLandmarks& landmarks, double tissue_scale) {
  std::map<std::string, skull::TargetLandmark> targets;
  for (const auto& [name, landmark] : landmarks) targets[name] = {landmark.position, landmark.confidence};
  skull::FitOptions options;
  options.tissue_scale = tissue_scale;
  const TriangleMesh upper = part_mesh(head, prepare::Part::teeth_upper), lower = part_mesh(head, prepare::Part::teeth_lower);
  if (!upper.empty()) options.teeth_upper = &upper;
  if (!lower.empty()) options.teeth_lower = &lower;
  return skull::fit(generic_skull(anatomy), head.skin, targets, options);
}

rig::Skull rig_skull(const skull::FitResult& skull, const prepare::PreparedHead& head, const SkinLandmarks& landmarks) {
  rig::Skull out;
  out.cranium = rig_surface(skull.cranium);
  out.mandible = rig_surface(skull.mandible);
  out.teeth_upper = rig_surface(skull.teeth_upper);
  out.teeth_lower = rig_surface(skull.teeth_lower);
  std::map<std::string, const skull::FittedLandmark*> fitted;
  for (const skull::FittedLandmark& landmark : skull.landmarks) fitted[landmark.name] = &landmark;
  for (const auto& [name, landmark] : landmarks) {
    rig::Landmark entry;
    entry.name = name;
    entry.skin = landmark.position.cast<float>();
    entry.bone = entry.skin;
    entry.confidence = static_cast<float>(landmark.confidence);
    if (const auto at = fitted.find(name); at != fitted.end()) {
      entry.bone = at->second->bone.cast<float>();
      entry.depth = static_cast<float>(at->second->depth);
    }
    out.landmarks.push_back(entry);
  }
  const Vec3 lateral = skull.jaw.hinge.normalized();
  const Vec3 forward = (skull.jaw.forward - skull.jaw.forward.dot(lateral) * lateral).normalized();
  out.jaw.origin = skull.jaw.origin.cast<float>();
  out.jaw.lateral = lateral.cast<float>();
  out.jaw.forward = forward.cast<float>();
  out.jaw.up = forward.cross(lateral).cast<float>();
  out.eye_left = rig_eye(head.eye_left);
  out.eye_right = rig_eye(head.eye_right);
  return out;
}

}  // namespace fascia::rigging
