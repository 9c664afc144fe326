#pragma once

#include <map>
#include <string>
#include <vector>

#include "formats/scene.h"
#include "geometry/landmarks.h"
#include "geometry/mesh.h"

/// Heads whose landmarks are known, and what people's meshes do to them. Lengths are in the head file's
/// units.
namespace fascia::testing {

struct MeasuredHead {
  std::string name;
  formats::Scene scene;
  Landmarks truth;           ///< landmarks defined by shape, file coordinates
  double millimetres = 1e3;  ///< of one file unit
};

/// Where the measured data lie; empty path when they are not on this machine.
std::filesystem::path measured_data();

/// Vertices of the mean ICT head's `head` mesh that bear the shape-defined ones of its 68 landmarks. The same
/// in every person.
std::map<std::string, int> ict_landmark_vertices();

/// The same in the vertex order of the face model itself.
std::map<std::string, int> ict_model_vertices();

/// Where the same points are on the generic head beside its own landmarks of the name: the chin and the tip
/// of the nose are 2 mm off by definition. Metres, rig frame.
Vec3 offset_of_definition(const std::string& landmark, const Vec3& generic);

/// "neutral" or "person_0" .. "person_5".
MeasuredHead ict_head(const std::string& name);

/// MakeHuman's body; its landmarks were placed by hand on the eyes' and mouth's vertices.
MeasuredHead makehuman();

MeasuredHead moved(MeasuredHead head, const Mat3& rotation, const Vec3& shift = Vec3::Zero());
MeasuredHead in_units(MeasuredHead head, double units_per_metre);
MeasuredHead noisy(MeasuredHead head, double millimetres, unsigned seed);
MeasuredHead decimated(MeasuredHead head, int triangles);
MeasuredHead subdivided(MeasuredHead head,
                        int rounds);        ///< every triangle in four, so often, of the `head` mesh
MeasuredHead skin_only(MeasuredHead head);  ///< the `head` mesh alone, with the lining of mouth and sockets
MeasuredHead without_lining(MeasuredHead head);  ///< the `head` mesh alone; mouth and eyes are holes
MeasuredHead face_alone(MeasuredHead head,
                        double radius_mm);  ///< the `head` mesh without lining, cut by a ball about the face
MeasuredHead cut_above_brows(
    MeasuredHead head);  ///< the `head` mesh without lining, cut by a plane as scans of the lower face are
MeasuredHead with_holes(MeasuredHead head, double radius_mm, int count, unsigned seed);

}  // namespace fascia::testing
