#include <algorithm>

#include "builder/openings/openings.h"
#include "builder/rigging/stages.h"

namespace fascia::rigging {

namespace {

bool has_part(const prepare::PreparedHead& head, std::initializer_list<prepare::Part> parts) {
  for (const prepare::PreparedMesh& mesh : head.meshes)
    for (const prepare::Part part : mesh.parts)
      if (std::find(parts.begin(), parts.end(), part) != parts.end()) return true;
  return false;
}

bool was_parted(const openings::OpenedHead& opened, const std::string& name) {
  return std::any_of(opened.parted.begin(), opened.parted.end(),
                     [&](const openings::Parted& parted) { return parted.name == name; });
}

formats::SceneMesh tooth_row(const std::string& name, const TriangleMesh& mesh) {
  formats::SceneMesh row;
  row.name = name;
  row.material = name;
  row.positions = mesh.vertices;
  row.triangles = mesh.triangles;
  row.colours.assign(mesh.vertices.size(), Vec3(0.90, 0.87, 0.78));
  return row;
}

std::string joined(const std::vector<std::string>& words) {
  std::string text;
  for (size_t i = 0; i < words.size(); ++i)
    text += (i == 0 ? "" : i + 1 == words.size() ? " and " : ", ") + words[i];
  return text;
}

}  // namespace

openings::OpenedHead open_head(const formats::Scene& scene, FoundLandmarks& found,
                               const anatomy::GenericAnatomy& anatomy, const BuildOptions& options) {
  Landmarks points;
  for (const auto& [name, landmark] : found.landmarks)
    points[name] = landmark.position;
  return openings::open_head(scene, found.head, points, anatomy, found.is_inside_out, options.openings);
}

void close_openings(openings::OpenedHead& opened, prepare::PreparedHead& head, const skull::FitResult& skull,
                    const BuildOptions& options, BuildReport& report) {
  const bool has_teeth =
      has_part(head, {prepare::Part::teeth_upper, prepare::Part::teeth_lower, prepare::Part::mouth_interior});
  if (!has_teeth && openings::wants(options.openings, "teeth", was_parted(opened, "mouth"))) {
    if (!skull.teeth_upper.empty())
      add_mesh(opened, head, tooth_row("teeth_upper", skull.teeth_upper), prepare::Part::teeth_upper);
    if (!skull.teeth_lower.empty())
      add_mesh(opened, head, tooth_row("teeth_lower", skull.teeth_lower), prepare::Part::teeth_lower);
  }
  for (const char* part : {"tongue"})
    if (std::count(options.openings.add.begin(), options.openings.add.end(), part))
      opened.warnings.push_back(std::string("there is no generic ") + part +
                                " to add; give the head one of its own in the file");
  report.parted = opened.parted;
  report.added = opened.added;
  report.warnings.insert(report.warnings.end(), opened.warnings.begin(), opened.warnings.end());
  report.appended_vertices = opened.lining_vertices;
  std::vector<std::string> names;
  for (const openings::Parted& parted : opened.parted) {
    names.push_back(parted.name);
    report.appended_vertices += parted.vertices;
  }
  if (!names.empty())
    report.warnings.push_back("the head's " + joined(names) + " came closed and " +
                              (names.size() > 1 ? "were" : "was") +
                              " parted: " + std::to_string(report.appended_vertices) +
                              " vertices follow the input's own; --open never leaves it closed");
  if (!opened.added.empty())
    report.warnings.push_back("generic " + joined(opened.added) +
                              " were fitted to this head and added to it; --add none leaves them out");
  if (opened.changed()) formats::rewrite(opened.scene, opened.extensions);
}

}  // namespace fascia::rigging
