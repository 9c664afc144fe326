#include "bench/muscles/face.h"

#include "builder/smas/smas.h"
#include "geometry/connectivity.h"

namespace fascia::bench {

std::unique_ptr<Face> embedded_face(double edge_length) {
  auto face = std::make_unique<Face>();
  face->anatomy = anatomy::load_generic();
  const TriangleMesh skin = weld(face->anatomy.head_object("skin")->mesh, 1e-6, nullptr);
  smas::Inputs inputs = smas::inputs_from(face->anatomy);
  inputs.skin = &skin;
  inputs.cranium = &face->anatomy.skull_object("cranium")->mesh;
  inputs.mandible = &face->anatomy.skull_object("mandible")->mesh;
  for (const auto& landmark : face->anatomy.landmarks)
    if (landmark.skin) inputs.landmarks[landmark.name] = *landmark.skin;
  smas::Options options;
  options.edge_length = edge_length;
  face->smas = smas::build(inputs, options).mesh;
  face->skin = std::make_unique<spatial::SurfaceQuery>(skin);
  face->cranium = std::make_unique<spatial::SurfaceQuery>(*inputs.cranium);
  face->mandible = std::make_unique<spatial::SurfaceQuery>(*inputs.mandible);
  TriangleMesh teeth;
  for (const char* name : {"teeth_upper", "teeth_lower"})
    if (const anatomy::MeshObject* row = face->anatomy.skull_object(name)) {
      const int first = teeth.vertex_count();
      teeth.vertices.insert(teeth.vertices.end(), row->mesh.vertices.begin(), row->mesh.vertices.end());
      for (const Triangle& t : row->mesh.triangles)
        teeth.triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
    }
  if (!teeth.empty()) face->teeth = std::make_unique<spatial::SurfaceQuery>(teeth);
  face->inputs.smas = &face->smas;
  face->inputs.skin = face->skin.get();
  face->inputs.cranium = face->cranium.get();
  face->inputs.mandible = face->mandible.get();
  face->inputs.teeth = face->teeth.get();
  face->inputs.landmarks = inputs.landmarks;
  face->inputs.muscles = face->anatomy.muscles;
  face->inputs.constants = face->anatomy.mechanics.muscles;
  return face;
}

}  // namespace fascia::bench
