#include "builder/rigging/build_rig.h"

#include <chrono>
#include <cmath>

#include "builder/muscles/muscles.h"
#include "builder/rigging/find_landmarks.h"
#include "builder/rigging/stages.h"
#include "builder/skull/skull.h"
#include "builder/smas/smas.h"
#include "builder/tissue/build.h"
#include "geometry/error.h"

namespace fascia::rigging {

namespace {

/// Runs the stages one after the other and takes their times.
class Stages {
 public:
  Stages(const BuildOptions& options, BuildReport& report) : options_(options), report_(report) {}

  template <class Stage>
  auto run(const std::string& name, Stage stage) {
    if (options_.progress) options_.progress(name);
    const auto started = std::chrono::steady_clock::now();
    auto result = stage();
    report_.stages.push_back(
        {name, std::chrono::duration<double>(std::chrono::steady_clock::now() - started).count()});
    return result;
  }

 private:
  const BuildOptions& options_;
  BuildReport& report_;
};

Landmarks places(const std::map<std::string, landmarks::SkinLandmark>& all) {
  Landmarks points;
  for (const auto& [name, landmark] : all)
    points[name] = landmark.position;
  return points;
}

void report_landmarks(const std::map<std::string, landmarks::SkinLandmark>& all,
                      const anatomy::GenericAnatomy& anatomy, BuildReport& report) {
  for (const auto& [name, landmark] : all) {
    ++(landmark.is_given ? report.landmarks_given : report.landmarks_found);
    const anatomy::Landmark* known = anatomy.landmark(name);
    BuildReport::LandmarkFigures figures;
    figures.name = name;
    figures.given = landmark.is_given;
    figures.required = known && known->required;
    figures.confidence = landmark.confidence;
    report.landmarks.push_back(figures);
    if (known && known->required && landmark.confidence < 0.5) report.low_confidence.push_back(name);
  }
  for (const std::string& name : report.low_confidence)
    report.warnings.push_back("landmark '" + name +
                              "' was placed with low confidence; look at it with 'fascia export --part "
                              "landmarks' and give it in --landmarks");
}

void report_skull(const skull::FitResult& skull, BuildReport& report) {
  report.landmark_rms_mm = 1e3 * skull.landmark_rms;
  report.landmark_max_mm = 1e3 * skull.landmark_max;
  report.bone_outside_skin = skull.bone_outside_skin;
  report.bone_corrected = skull.corrected_vertices;
  report.bone_corrected_max_mm = 1e3 * skull.corrected_max;
  report.curve_points = skull.curve_points;
  report.curve_points_used = skull.curve_points_used;
  report.skull_uncovered_share = skull.uncovered_share;
  std::map<std::string, const skull::FittedLandmark*> fitted;
  for (const skull::FittedLandmark& landmark : skull.landmarks)
    fitted[landmark.name] = &landmark;
  for (BuildReport::LandmarkFigures& figures : report.landmarks) {
    const auto at = fitted.find(figures.name);
    figures.has_bone = at != fitted.end();
    if (!figures.has_bone) continue;
    figures.depth_mm = 1e3 * at->second->depth;
    figures.table_mm = 1e3 * at->second->table_depth;
    figures.deviation_mm = 1e3 * at->second->table_deviation;
    figures.residual_mm = 1e3 * at->second->residual;
  }
}

/// The landmarks that the user moved. Throws fascia::Error for one that is not known.
formats::LandmarkFile edited_landmarks(const Edits& edits, const anatomy::GenericAnatomy& anatomy) {
  for (const auto& [name, point] : edits.landmarks)
    if (!anatomy.landmark(name))
      throw Error("'" + edits.file + "': there is no landmark '" + name +
                  "'; 'fascia export --part landmarks' lists them");
  return {edits.units, edits.landmarks};
}

void report_parts(const prepare::PreparedHead& head, BuildReport& report) {
  for (const prepare::PreparedMesh& mesh : head.meshes) {
    std::map<prepare::Part, int> counts;
    for (prepare::Part part : mesh.parts)
      ++counts[part];
    for (const auto& [part, vertices] : counts)
      report.parts.push_back({mesh.name, prepare::part_name(part), vertices});
  }
  report.eye_left = head.eye_left;
  report.eye_right = head.eye_right;
}

}  // namespace

BuildResult build_rig(const formats::Scene& scene, const formats::LandmarkFile& given,
                      const anatomy::GenericAnatomy& generic, const BuildOptions& options) {
  const anatomy::GenericAnatomy anatomy = with_new_muscles(generic, options.edits);
  muscle_options(options.edits, anatomy, Mat4::Identity());  // wrong names are refused before the work begins
  const formats::LandmarkFile edited = edited_landmarks(options.edits, anatomy);
  BuildResult result;
  BuildReport& report = result.report;
  Stages stages(options, report);
  openings::check(options.openings);
  FoundLandmarks found = stages.run("landmarks", [&] {
    return find_landmarks_with_edits(scene, given, edited, anatomy, options.prepare, options.for_each);
  });
  prepare::PreparedHead& head = found.head;
  const SkinLandmarks& all_landmarks = found.landmarks;
  // One stage of three parts: the head's place tells units and parts, which tell where the landmarks are.
  report.stages = {
      {"head", found.seconds[0]}, {"prepare", found.seconds[1]}, {"landmarks", found.seconds[2]}};
  report.units = head.units;
  report.input_to_metres = head.input_to_metres;
  report.warnings = head.warnings;
  report.warnings.insert(report.warnings.end(), found.warnings.begin(), found.warnings.end());
  openings::OpenedHead opened =
      stages.run("openings", [&] { return open_head(scene, found, anatomy, options); });
  report_landmarks(all_landmarks, anatomy, report);
  const Landmarks points = places(all_landmarks);

  const skull::FitResult skull =
      stages.run("skull", [&] { return fit_skull(anatomy, found, options.tissue_scale); });
  report_skull(skull, report);
  close_openings(opened, head, skull, options, report);
  report_parts(head, report);
  report.warnings.insert(report.warnings.end(), skull.warnings.begin(), skull.warnings.end());

  const smas::Result smas = stages.run("smas", [&] {
    smas::Inputs inputs = smas::inputs_from(anatomy);
    inputs.skin = &head.skin;
    inputs.cranium = &skull.cranium;
    inputs.mandible = &skull.mandible;
    inputs.landmarks = points;
    return smas::build(inputs, options.smas);
  });
  report.smas_vertices = smas.mesh.vertex_count();
  report.smas_triangles = smas.mesh.triangle_count();
  report.smas_outside_layers = smas.outside_layers;
  report.smas_min_angle_deg = smas.quality.min_angle;

  result.rig.muscles = stages.run(
      "muscles", [&] { return build_muscles(anatomy, head, skull, smas, points, options.edits, report); });
  result.rig.skull = rig_skull(skull, head, all_landmarks);
  result.rig.smas = rig_smas(smas, skull, anatomy);
  result.rig.actuation = rig_actuation(anatomy, result.rig.muscles);
  result.rig.input_to_metres = head.input_to_metres.cast<float>();
  tissue::TissueInputs inputs =
      tissue_inputs(opened.scene, head, skull, smas, points, anatomy.mechanics, result.rig);
  inputs.has_muscles_by_hand = !options.edits.muscles.empty() || !options.edits.new_muscles.empty() ||
                               !options.edits.muscle_files.empty();
  result.rig.tissue =
      stages.run("tissue", [&] { return build_tissue(opened.scene, head, inputs, options, report); });
  if (opened.changed()) result.opened = std::move(opened.scene);
  return result;
}

}  // namespace fascia::rigging
