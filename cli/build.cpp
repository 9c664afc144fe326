#include <chrono>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>

#include "builder/rigging/build_rig.h"
#include "builder/rigging/gltf_source.h"
#include "cli/check.h"
#include "cli/common.h"
#include "cli/progress.h"
#include "cli/report.h"
#include "cli/rig_build.h"
#include "formats/scene.h"
#include "geometry/error.h"
#include "geometry/text.h"
#include "rig/write/write.h"

namespace fascia::cli {

namespace {

using Json = nlohmann::ordered_json;

std::string fixed(double value, int digits) {
  char text[48];
  std::snprintf(text, sizeof text, "%.*f", digits, value);
  return text;
}

/// Every part as built, and before its parts a muscle that has several, summed up.
Json muscles_json(const rigging::BuildReport& report) {
  Json list = Json::array();
  std::string last;
  for (size_t i = 0; i < report.muscles.size(); ++i) {
    const auto& muscle = report.muscles[i];
    if (muscle.whole != muscle.name && muscle.whole != last) {
      Json whole = {{"name", muscle.whole}, {"fibres", 0}, {"length_mm", 0.0}, {"parts", Json::array()}};
      int fibres = 0;
      double length = 0.0;
      for (const auto& part : report.muscles)
        if (part.whole == muscle.whole) {
          whole["parts"].push_back(part.name);
          fibres += part.fibres;
          length += part.fibres * part.length_mm;
        }
      whole["fibres"] = fibres;
      whole["length_mm"] = fibres ? length / fibres : 0.0;
      list.push_back(whole);
    }
    last = muscle.whole;
    list.push_back({{"name", muscle.name},
                    {"fibres", muscle.fibres},
                    {"length_mm", muscle.length_mm},
                    {"shortest_mm", muscle.shortest_mm},
                    {"longest_mm", muscle.longest_mm},
                    {"area_mm2", muscle.area_mm2},
                    {"thickness_mm", muscle.thickness_mm},
                    {"volume_mm3", muscle.volume_mm3},
                    {"strength_n", muscle.strength_n},
                    {"origin_distance_mm", muscle.origin_distance_mm},
                    {"insertion_distance_mm", muscle.insertion_distance_mm},
                    {"crossings", muscle.crossings}});
  }
  return list;
}

Json eye_json(const prepare::Eyeball& eye) {
  return {{"centre", {eye.centre[0], eye.centre[1], eye.centre[2]}},
          {"radius_mm", 1e3 * eye.radius},
          {"gaze", {eye.gaze[0], eye.gaze[1], eye.gaze[2]}}};
}

Json report_json(const rigging::BuildReport& report) {
  Json json;
  Json matrix = Json::array();
  for (int row = 0; row < 4; ++row) {
    Json line = Json::array();
    for (int column = 0; column < 4; ++column)
      line.push_back(report.input_to_metres(row, column));
    matrix.push_back(line);
  }
  json["anatomy"] = {{"corrected", report.corrected}};
  json["input"] = {{"units", report.units},
                   {"input_to_metres", matrix},
                   {"parts", Json::array()},
                   {"eyes", Json::object()}};
  for (const auto& part : report.parts)
    json["input"]["parts"].push_back({{"mesh", part.mesh}, {"part", part.part}, {"vertices", part.vertices}});
  for (const auto& [side, eye] : {std::pair("left", &report.eye_left), std::pair("right", &report.eye_right)})
    if (*eye) json["input"]["eyes"][side] = eye_json(**eye);
  json["openings"] = {
      {"parted", Json::array()}, {"appended_vertices", report.appended_vertices}, {"added", report.added}};
  for (const openings::Parted& parted : report.parted)
    json["openings"]["parted"].push_back({{"name", parted.name},
                                          {"vertices", parted.vertices},
                                          {"width_mm", parted.width_mm},
                                          {"clearness", parted.clearness}});
  json["stages"] = Json::array();
  for (const rigging::StageTime& stage : report.stages)
    json["stages"].push_back({{"name", stage.name}, {"seconds", stage.seconds}});
  json["landmarks"] = {{"found", report.landmarks_found},
                       {"given", report.landmarks_given},
                       {"low_confidence", report.low_confidence}};
  json["skull"] = {{"landmark_rms_mm", report.landmark_rms_mm},
                   {"landmark_max_mm", report.landmark_max_mm},
                   {"bone_outside_skin", report.bone_outside_skin},
                   {"uncovered_share", report.skull_uncovered_share}};
  json["smas"] = {{"vertices", report.smas_vertices},
                  {"triangles", report.smas_triangles},
                  {"min_angle_deg", report.smas_min_angle_deg},
                  {"outside_layers", report.smas_outside_layers}};
  json["muscles"] = muscles_json(report);
  json["modioli"] = Json::array();
  for (const auto& node : report.modioli)
    json["modioli"].push_back({{"name", node.name},
                               {"centre_m", {node.centre[0], node.centre[1], node.centre[2]}},
                               {"radius_mm", node.radius_mm},
                               {"muscles", node.muscles}});
  json["edits"] = {{"landmarks", report.edits.landmarks},
                   {"changed", report.edits.changed},
                   {"added", report.edits.added},
                   {"absent", report.edits.absent}};
  json["tissue"] = Json::object();
  for (const auto& level : report.tissue)
    json["tissue"][level.name] = {{"nodes", level.nodes}, {"springs", level.springs}};
  json["warnings"] = report.warnings;
  return json;
}

void say_report(const Common& common, const rigging::BuildReport& report,
                const std::filesystem::path& output) {
  for (const std::string& warning : report.warnings)
    common.warn(warning);
  double total = 0.0;
  std::string stages;
  for (const rigging::StageTime& stage : report.stages) {
    total += stage.seconds;
    stages += (stages.empty() ? "" : ", ") + stage.name + " " + fixed(stage.seconds, 2);
  }
  size_t fibres = 0;
  for (const auto& muscle : report.muscles)
    fibres += static_cast<size_t>(muscle.fibres);
  std::map<std::string, int> parts;
  for (const auto& part : report.parts)
    parts[part.part] += part.vertices;
  std::string known;
  for (const auto& [part, vertices] : parts)
    known += (known.empty() ? "" : ", ") + part + " " + std::to_string(vertices);
  common.say("parts (vertices): " + known);
  common.say("units " + report.units + "; " + std::to_string(report.landmarks_found) + " landmarks found, " +
             std::to_string(report.landmarks_given) + " given; skull fitted to " +
             fixed(report.landmark_rms_mm, 1) + " mm; SMAS of " + std::to_string(report.smas_triangles) +
             " triangles; " + std::to_string(report.muscles.size()) + " muscles, " + std::to_string(fibres) +
             " fibres");
  if (!report.corrected.empty()) {
    std::string files;
    for (const std::string& file : report.corrected)
      files += (files.empty() ? "" : ", ") + file;
    common.say("anatomy corrected: " + files);
  }
  common.say("built in " + fixed(total, 2) + " s (" + stages + ")");
  common.say("wrote " + output.string());
}

}  // namespace

anatomy::GenericAnatomy anatomy_for(const std::filesystem::path& directory) {
  return directory.empty() ? anatomy::load_generic() : anatomy::load_generic(directory);
}

void add_anatomy_option(const Command& command, std::filesystem::path& directory) {
  command
      .option("--anatomy", &directory,
              "Folder with corrected copies of files of anatomy/data; for missing ones the built-in files "
              "are used")
      .value("DIR")
      .default_text("all built in");
}

rigging::BuildReport build_file(const Common& common, const BuildRequest& request, int* failed_checks) {
  std::vector<std::filesystem::path> inputs = request.muscles;
  inputs.insert(inputs.end(), {request.head, request.landmarks, request.edits});
  check_output(request.output, inputs);
  formats::PartialGroup together;
  if (!request.report.empty()) {
    make_output_folder(request.report, &together);
    check_outputs({request.output, request.report / report_name}, inputs);
  }
  if (extension_of(request.output) != ".glb")
    throw Error("'" + request.output.string() + "': a rig is a .glb file; give -o NAME.glb");
  // Shares of a build at medium detail; where another stage takes longest, the time left follows as it is
  // seen.
  Progress progress(common, "build",
                    {{"reading", 0.05},
                     {"landmarks", 0.15},
                     {"openings", 0.05},
                     {"skull", 0.2},
                     {"smas", 0.1},
                     {"muscles", 0.05},
                     {"tissue", 1.4},
                     {"writing", 0.1},
                     {"check", 0.6},
                     {"report", request.report.empty() ? 0.0 : 2.0}});
  progress.begin("reading");
  const anatomy::GenericAnatomy anatomy = anatomy_for(request.anatomy);
  const formats::Scene scene = formats::read(request.head, reading_options(request.allow_outside));
  formats::LandmarkFile landmarks;
  if (!request.landmarks.empty()) landmarks = formats::read_landmarks(request.landmarks);
  rigging::BuildOptions options = request.options;
  if (!request.edits.empty()) options.edits = rigging::read_edits(request.edits);
  options.edits.muscle_files = request.muscles;
  for (const std::string& variant : request.variants)
    rigging::set_variant(options.edits, variant);
  if (request.fibre_spacing_mm) options.edits.fibre_spacing = 1e-3 * *request.fibre_spacing_mm;
  if (request.least_prevalence) options.edits.least_prevalence = *request.least_prevalence;
  if (request.smas_galea) options.smas.reach.galea = request.smas_galea;
  if (request.smas_neck_mm) options.smas.reach.neck = 1e-3 * *request.smas_neck_mm;
  options.progress = [&](const std::string& stage) { progress.begin(stage); };
  options.for_each = on_all_threads();
  rigging::BuildResult result = rigging::build_rig(scene, landmarks, anatomy, options);
  if (!request.anatomy.empty()) result.report.corrected = anatomy::corrected_files(request.anatomy);
  progress.begin("writing");
  const std::vector<uint8_t> bytes =
      rig::write(rigging::gltf_source(result.opened.value_or(scene), result.report.input_to_metres,
                                      &result.report.warnings),
                 result.rig);
  formats::write_bytes(request.output, bytes.data(), bytes.size());
  Mat4 to_origin = Mat4::Identity();
  to_origin.topRightCorner<3, 1>() = -scene.offset;
  result.report.input_to_metres = result.report.input_to_metres * to_origin;
  result.report.warnings.insert(result.report.warnings.begin(), scene.warnings.begin(), scene.warnings.end());
  progress.begin("check");
  const auto started = std::chrono::steady_clock::now();
  const std::vector<std::string> failures =
      quick_check(bytes, request.output.string(),
                  request.anatomy.empty() ? anatomy::load_checks() : anatomy::load_checks(request.anatomy));
  result.report.stages.push_back(
      {"check", std::chrono::duration<double>(std::chrono::steady_clock::now() - started).count()});
  result.report.warnings.insert(result.report.warnings.end(), failures.begin(), failures.end());
  if (failed_checks) *failed_checks = static_cast<int>(failures.size());
  if (!request.report.empty()) {
    progress.begin("report");
    write_report(request.report, request.head, request.output, result.report);
  }
  together.keep();
  return result.report;
}

namespace {

void add_detail_options(const Command& command, BuildRequest& request) {
  command
      .option("--smas-galea", &request.smas_galea,
              "Extent of the SMAS along the galea: 0 the hairline, 1 the vertex")
      .range(0.0, 1.0)
      .default_text("galea in the anatomy's smas_shape");
  command
      .option("--smas-neck", &request.smas_neck_mm,
              "Extent of the SMAS with the platysma below the angle of chin and neck, in mm of an adult")
      .range(0.0, 80.0)
      .default_text("neck in the anatomy's smas_shape");
  command.flag("--smas-nostrils", request.options.smas.reach.nostrils,
               "Whether the SMAS is open under the nose", true);
  command.option("--fibre-spacing", &request.fibre_spacing_mm, "Millimetres between fibres")
      .range(0.1, 20.0)
      .default_text("as the edits say, or 2");
  command.option("--least-prevalence", &request.least_prevalence, "Omit muscles of lower prevalence, 0 to 1")
      .range(0.0, 1.0)
      .default_text("as the edits say, or 0");
  command.option("--tissue-scale", &request.options.tissue_scale, "Scales every tissue depth")
      .range(0.2, 3.0);
}

void add_input_options(const Command& command, BuildRequest& request) {
  command.option("--landmarks", &request.landmarks, "Landmarks on the skin: .mrk.json or JSON")
      .default_text("found on the mesh");
  command
      .option("--units", &request.options.prepare.units,
              "Unit of the file: auto, m, cm, mm, or metres per unit")
      .value("UNIT");
  command.option("--up", &request.options.prepare.up, "Up axis of the file").one_of({"auto", "y", "z"});
  command.option("--skin", &request.options.prepare.skin, "Name of the mesh that is the skin")
      .default_text("found by its shape");
  add_anatomy_option(command, request.anatomy);
  add_outside_option(command, request.allow_outside);
}

void add_anatomy_options(const Command& command, BuildRequest& request) {
  command.option("--open", &request.options.openings.open, "Part lips and lids that are one closed surface")
      .one_of({"auto", "never"});
  command
      .option("--add", &request.options.openings.add,
              "Generic parts to add to a head without them, separated by commas; auto: behind lips cut open "
              "and lids")
      .one_of({"auto", "none", "mouth", "teeth", "tongue", "eyes"})
      .separated_by_commas()
      .value("PART,...");
  command
      .option("--edits", &request.edits,
              "Edits file with landmarks, regions, strengths and muscles (.json), for every rebuild")
      .default_text("none");
  command
      .option("--muscles", &request.muscles,
              "More muscles on the generic head: a file like anatomy/data/muscles.json")
      .default_text("none");
  command
      .option("--variant", &request.variants,
              "Anatomical variant of a muscle, such as risorius=absent; may be repeated")
      .value("MUSCLE=VARIANT")
      .default_text("the usual forms");
}

/// Builds, says what was built, and ends with exit_check when --strict finds a fault.
void run(const Common& common, const BuildRequest& request) {
  int failed_checks = 0;
  const rigging::BuildReport report = build_file(common, request, &failed_checks);
  if (common.json)
    common.report(report_json(report));
  else
    say_report(common, report, request.output);
  if (!request.report.empty()) common.say("wrote " + (request.report / report_name).string());
  if (request.is_strict && failed_checks > 0) throw Exit{exit_check};
}

}  // namespace

void add_build(const Command& tool, Common& common) {
  auto request = std::make_shared<BuildRequest>();
  const Command command = tool.command("build", "Build the rig of a head: skull, SMAS, muscles, tissue");
  command.positional("HEAD", &request->head, "Head mesh: GLB, glTF, OBJ, PLY or STL").required();
  command.option("-o,--output", &request->output, "Rig to write (.glb)").required();
  command.option("--detail", &request->options.detail, "Finest lattice").one_of({"low", "medium", "high"});
  add_input_options(command, *request);
  add_anatomy_options(command, *request);
  add_detail_options(command, *request);
  command
      .option("--report", &request->report,
              "Folder for report.html: one page with pictures and statistics of every stage")
      .value("DIR")
      .default_text("none");
  command.flag("--strict", request->is_strict,
               "Exit with 4 if the final check fails; the rig is still written");
  command.run([request, &common] { run(common, *request); });
}

}  // namespace fascia::cli
