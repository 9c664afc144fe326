#pragma once

#include <string>
#include <vector>

#include "anatomy/anatomy.h"
#include "builder/openings/line.h"
#include "builder/prepare/prepare.h"
#include "formats/extend.h"
#include "formats/scene.h"
#include "geometry/landmarks.h"

/// Cutting open heads whose lips or lids are one closed surface, as in most scans, and adding linings, teeth
/// and eyeballs.
namespace fascia::openings {

struct OpeningOptions {
  std::string open = "auto";                ///< auto: closed lips and lids are cut open; never
  std::vector<std::string> add = {"auto"};  ///< auto, none, or any of mouth, teeth, tongue, eyes
};

/// Throws fascia::Error naming an unknown word in `options`.
void check(const OpeningOptions& options);

/// Changes made at one opening.
struct Parted {
  std::string name;  ///< mouth, eye_left or eye_right
  int vertices = 0;  ///< appended along the cut and for its lining
  double width_mm = 0.0, clearness = 0.0;
};

/// Changes made to a head, and the data to rewrite its file.
struct OpenedHead {
  formats::Scene scene;                            ///< with what was appended; its document not yet
  std::vector<formats::MeshExtension> extensions;  ///< one for each mesh of the scene that came
  std::vector<Parted> parted;
  std::vector<std::string> added;  ///< mouth, eye_left, teeth_upper, ...
  int lining_vertices = 0;         ///< appended for an inside of the mouth that was only a hole
  std::vector<std::string> warnings;
  bool changed() const { return !parted.empty() || !added.empty(); }
};

/// Cuts open closed lips and lids of `head`, adds linings, and adds eyeballs behind lids that were closed or
/// as requested by `options`; the meshes, skin and eyes of `head` are updated.
///
/// `scene` is the file that `head` was prepared from, `landmarks` lie on its skin (metres, rig frame).
/// `is_inside_out`: the file's triangles face inward and those of `head` were turned. The vertices that were
/// there keep their order and places; new ones follow. Cuts follow from the face's own shape and axes, not
/// from its pose or the order of its vertices.
OpenedHead open_head(const formats::Scene& scene, prepare::PreparedHead& head, const Landmarks& landmarks,
                     const anatomy::GenericAnatomy& anatomy, bool is_inside_out,
                     const OpeningOptions& options);

/// Whether a part is to be added: asked for by name, or by `auto` and wanted there.
bool wants(const OpeningOptions& options, const std::string& part, bool by_auto);

/// Adds `mesh` (metres, rig frame) to scene and head as `part`.
void add_mesh(OpenedHead& opened, prepare::PreparedHead& head, formats::SceneMesh mesh, prepare::Part part);

}  // namespace fascia::openings
