#include "cli/face.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <nlohmann/json.hpp>

#include "builder/reconstruction/reconstruction.h"
#include "cli/progress.h"
#include "cli/reconstructed_head.h"
#include "cli/rig_build.h"
#include "formats/landmark_file.h"
#include "formats/scene.h"
#include "geometry/error.h"
#include "geometry/text.h"

namespace fascia::cli {

namespace {

using Json = nlohmann::ordered_json;

struct FaceRequest {
  std::filesystem::path skull, output, landmarks, landmarks_out, sheet, rig, anatomy;
  std::string depths, units = "auto";
  reconstruction::Person person;
  double tissue_scale = 1.0;
  bool allow_outside = false;
};

double unit_of(const std::string& text) {
  for (const auto& [name, metres] : {std::pair{"m", 1.0}, {"cm", 0.01}, {"mm", 0.001}})
    if (text == name) return metres;
  size_t used = 0;
  double metres = 0.0;
  try {
    metres = std::stod(text, &used);
  } catch (const std::exception&) {
    used = 0;
  }
  if (used != text.size() || !(metres > 0.0) || !std::isfinite(metres))
    throw Error("--units " + text + ": say auto, m, cm, mm or the metres of one unit");
  return metres;
}

TriangleMesh skull_of(const formats::Scene& scene) {
  TriangleMesh all;
  for (const formats::SceneMesh& mesh : scene.meshes) {
    const int first = all.vertex_count();
    all.vertices.insert(all.vertices.end(), mesh.positions.begin(), mesh.positions.end());
    for (const Triangle& t : mesh.triangles)
      all.triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
  }
  return all;
}

/// The given landmarks in the coordinates of the scene's meshes.
Landmarks bone_landmarks(const FaceRequest& request, const formats::Scene& scene, double metres) {
  if (request.landmarks.empty()) return {};
  const formats::LandmarkFile file =
      formats::read_landmarks(request.landmarks, formats::LandmarkSurface::bone);
  const double scale = file.units.empty() ? 1.0 : unit_of(file.units) / metres;
  Landmarks points;
  for (const auto& [name, point] : file.points)
    points[name] = scale * point - scene.offset;
  return points;
}

std::string depth_table(const FaceRequest& request, anatomy::GenericAnatomy& anatomy,
                        std::vector<std::string>& warnings) {
  if (request.depths.empty()) return reconstruction::nearest_table(anatomy, request.person, warnings);
  if (anatomy.depth_table(request.depths) || extension_of(request.depths) != ".json") return request.depths;
  const std::vector<std::string> added = anatomy::add_depth_tables(anatomy, request.depths);
  std::erase_if(anatomy.depth_tables, [&](const anatomy::TissueDepthTable& table) {
    return std::find(added.begin(), added.end(), table.name) == added.end();
  });
  return reconstruction::nearest_table(anatomy, request.person, warnings);
}

Json landmarks_json(const reconstruction::Result& result) {
  Json list = Json::object();
  for (const reconstruction::SkinOverBone& landmark : result.landmarks)
    list[landmark.name] = {{"depth_mm", 1e3 * landmark.depth},
                           {"deviation_mm", 1e3 * landmark.deviation},
                           {"given", landmark.given},
                           {"bone_found", std::isfinite(landmark.residual)}};
  return list;
}

void check_face_outputs(const FaceRequest& request) {
  check_outputs({request.output, request.landmarks_out, request.sheet, request.rig},
                {request.skull, request.landmarks, request.depths});
  if (!request.sheet.empty() && extension_of(request.sheet) != ".png")
    throw Error("'" + request.sheet.string() + "': a sheet is written as .png");
  if (!request.landmarks_out.empty() && extension_of(request.landmarks_out) != ".json")
    throw Error("'" + request.landmarks_out.string() + "': landmarks are written as .json");
}

void run(const Common& common, const FaceRequest& request) {
  check_face_outputs(request);
  anatomy::GenericAnatomy anatomy = anatomy_for(request.anatomy);
  std::vector<std::string> warnings;
  reconstruction::Options options;
  options.table = depth_table(request, anatomy, warnings);
  options.tissue_scale = request.tissue_scale;
  Progress progress(common, "face", {{"skull", 1.0}, {"skin", 2.0}});
  progress.begin("skull");
  const formats::Scene scene = formats::read(request.skull, reading_options(request.allow_outside));
  const TriangleMesh skull = skull_of(scene);
  const auto of_skull = [&](const Error& error) {
    return Error("'" + request.skull.string() + "': " + error.what());
  };
  reconstruction::Result result;
  try {
    options.metres = request.units == "auto" ? reconstruction::guess_unit(skull) : unit_of(request.units);
    options.bone = bone_landmarks(request, scene, options.metres);
    progress.begin("skin");
    result = reconstruction::reconstruct(anatomy, skull, options);
  } catch (const Error& error) {
    throw of_skull(error);
  }
  warnings.insert(warnings.end(), scene.warnings.begin(), scene.warnings.end());
  warnings.insert(warnings.end(), result.warnings.begin(), result.warnings.end());
  write_reconstructed_head(request.output, anatomy, result, scene.offset);
  if (!request.landmarks_out.empty())
    write_reconstructed_landmarks(request.landmarks_out, request.output, anatomy, result, scene.offset);
  if (!request.sheet.empty()) view::write_png(request.sheet, reconstruction_sheet(anatomy, result, skull));
  for (const std::string& warning : warnings)
    common.warn(warning);
  if (!request.rig.empty()) {
    BuildRequest build;
    build.head = request.output;
    build.output = request.rig;
    build.anatomy = request.anatomy;
    build.options.tissue_scale = request.tissue_scale;
    build_file(common, build);
    common.say("wrote " + request.rig.string());
  }
  common.say("bone within " + std::to_string(1e3 * result.bone_residual).substr(0, 4) +
             " mm of the generic skull's; depths of '" + options.table + "'");
  common.say("wrote " + request.output.string());
  common.report({{"output", request.output.string()},
                 {"units_in_metres", result.metres},
                 {"depths", options.table},
                 {"bone_residual_mm", 1e3 * result.bone_residual},
                 {"covered_share", result.covered_share},
                 {"landmarks", landmarks_json(result)},
                 {"warnings", warnings}});
}

}  // namespace

void add_face(const Command& tool, Common& common) {
  auto request = std::make_shared<FaceRequest>();
  const Command command = tool.command(
      "face", "Reconstruct a face from a skull by soft-tissue depths (craniofacial approximation)");
  command.positional("SKULL", &request->skull, "Skull mesh: GLB, glTF, OBJ, PLY or STL, in any pose")
      .required();
  command
      .option("-o,--output", &request->output,
              "Head to write: .glb (metres, with the uncertainty band as morph targets) or .obj (the skull's "
              "own axes "
              "and units)")
      .required();
  command
      .option("--landmarks", &request->landmarks, "Craniometric landmarks on the bone (.mrk.json or .json)")
      .default_text("none: the skull is found");
  command
      .option("--depths", &request->depths,
              "Tissue depth table: a name of the anatomy's, or a .json file like tissue_depths.json")
      .default_text("the closest population");
  command.option("--sex", &request->person.sex, "Chooses the table")
      .one_of({"female", "male"})
      .default_text("not known");
  command.option("--age", &request->person.age, "Chooses the table: adult, or a word of your table's")
      .default_text("not known");
  command.option("--ancestry", &request->person.ancestry, "Chooses the table, in the words of a table")
      .default_text("not known");
  command.option("--units", &request->units, "auto, m, cm, mm, or metres per unit");
  command.option("--tissue-scale", &request->tissue_scale, "Scales every depth");
  command.option("--landmarks-out", &request->landmarks_out, "Landmarks on skin and bone (.json)")
      .default_text("none");
  command
      .option("--sheet", &request->sheet, "Picture of the head, the head over the skull and the band (.png)")
      .default_text("none");
  command.option("--rig", &request->rig, "Also build the head's rig (.glb)").default_text("none");
  add_outside_option(command, request->allow_outside);
  add_anatomy_option(command, request->anatomy);
  command.run([request, &common] { run(common, *request); });
}

}  // namespace fascia::cli
