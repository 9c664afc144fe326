#include "cli/fit.h"

#include <algorithm>
#include <chrono>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>

#include "cli/common.h"
#include "cli/fit_landmarks.h"
#include "cli/fit_match.h"
#include "cli/fit_output.h"
#include "cli/fit_pictures.h"
#include "cli/fit_scan.h"
#include "cli/fit_target.h"
#include "cli/progress.h"
#include "fit/fit.h"
#include "formats/scene.h"
#include "geometry/error.h"
#include "geometry/text.h"

namespace fascia::cli {

namespace {

struct FitRequest {
  std::filesystem::path rig, target, neutral, output, report;
  std::string level, shape, camera;
  FitTargetOptions reading;
  fit::FitOptions fitting;
};

/// Only the shape asked for, as one mesh.
void choose_shape(const FitRequest& request, FitTargets& targets) {
  if (request.shape.empty()) return;
  const auto at = std::find(targets.names.begin(), targets.names.end(), request.shape);
  if (targets.kind != FitTargets::Kind::shapes || at == targets.names.end())
    throw Error("'" + request.target.string() + "' has no morph target '" + request.shape + "' to fit");
  const auto index = static_cast<size_t>(at - targets.names.begin());
  targets.target = [all = targets.target, index](size_t) { return all(index); };
  targets.names = {request.shape};
  targets.kind = FitTargets::Kind::mesh;
}

nlohmann::ordered_json figures(const fit::Subject& subject, const fit::FitResult& result) {
  nlohmann::ordered_json entry = {
      {"share", result.share},           {"error_mm", result.error_mm},
      {"rms_mm", result.rms_mm},         {"activations", fitted_activations(subject, result)},
      {"iterations", result.iterations}, {"converged", result.converged}};
  add_certainty(subject, result, entry);
  return entry;
}

/// Share and mean error over all targets, by how much each moves; converged when all are.
nlohmann::ordered_json summary(const std::vector<fit::FitResult>& results,
                               const std::vector<double>& motion) {
  double left = 0.0, whole = 0.0, error = 0.0;
  int iterations = 0;
  bool converged = true;
  for (size_t i = 0; i < results.size(); ++i) {
    left += (1.0 - results[i].share) * motion[i];
    whole += motion[i];
    error += results[i].error_mm / static_cast<double>(results.size());
    iterations += results[i].iterations;
    converged = converged && results[i].converged;
  }
  return {{"share", whole > 0.0 ? 1.0 - left / whole : 1.0},
          {"error_mm", error},
          {"iterations", iterations},
          {"converged", converged}};
}

bool is_landmark_file(const std::filesystem::path& path) {
  return extension_of(path) == ".json";
}

/// The target where it is a scan: one mesh of another topology than the rig's, or one that is said to be a
/// scan.
std::optional<formats::Scene> scan_of(const FitRequest& request, const fit::Subject& subject) {
  const std::filesystem::path& path = request.target;
  const std::string& as = request.reading.as;
  const std::string extension = extension_of(path);
  const bool may_be = as == "auto" && !std::filesystem::is_directory(path) && extension != ".pc2" &&
                      extension != ".mdd" && !is_landmark_file(path);
  if (as != "scan" && !may_be) return {};
  formats::Scene scene = formats::read(path, reading_options(request.reading.allow_outside));
  if (as != "scan" && has_rig_topology(subject, scene)) return {};
  return scene;
}

void fit_one_scan(const Common& common, const FitRequest& request, const formats::Scene& scene,
                  fit::Subject& subject, FitTargets& targets, std::vector<fit::FitResult>& results,
                  std::vector<double>& motion, nlohmann::ordered_json& figures) {
  targets.names = {request.target.filename().string()};
  check_fit_output(request.output, targets);
  const bool may_move = request.reading.head_pose != "fixed";
  const PlacedScan scan = place_scan(subject, scene, may_move);
  for (const std::string& warning : scan.warnings)
    common.warn(warning);
  common.progress("fit " + targets.names.front());
  fit::ScanOptions options;
  options.moves_head = may_move;
  const fit::ScanFit fitted = fit::fit_scan(subject, scan.mesh, request.fitting, options);
  targets.target = [target = fitted.target](size_t) { return target; };
  results = {fitted.result};
  motion = {1.0};
  figures = {{"matched_share", fitted.matched_share}};
}

void fit_all_pictures(const Common& common, const FitRequest& request, fit::Subject& subject,
                      FitTargets& targets, std::vector<fit::FitResult>& results,
                      std::vector<double>& motion) {
  if (!is_landmark_file(request.target))
    throw Error("--camera is for landmarks in pictures (.json), not for '" + request.target.string() + "'");
  PictureFit fitted = fit_pictures(common, request.target, request.neutral, camera_of(request.camera),
                                   subject, request.fitting);
  targets = std::move(fitted.targets);
  check_fit_output(request.output, targets);
  results = std::move(fitted.results);
  motion = std::move(fitted.motion);
}

void fit_targets(const Common& common, const FitRequest& request, fit::Subject& subject, FitTargets& targets,
                 std::vector<fit::FitResult>& results, std::vector<double>& motion) {
  targets = is_landmark_file(request.target)
                ? landmark_targets(common, request.target, request.neutral, subject, request.reading)
                : open_fit_targets(common, request.target, subject, request.reading);
  choose_shape(request, targets);
  check_fit_output(request.output, targets);
  fit::Fitter fitter(subject, request.fitting);
  Progress progress(common, "fit", targets.names.size());
  for (size_t i = 0; i < targets.names.size(); ++i) {
    progress.step();
    const fit::Target target = targets.target(i);
    motion.push_back(target.displacements.squaredNorm());
    results.push_back(targets.kind == FitTargets::Kind::take ? fitter.follow(target) : fitter.fit(target));
    if (!results.back().converged)
      common.warn(targets.names[i] + ": still falling after " + std::to_string(results.back().iterations) +
                  " steps; what is found so far is written");
  }
}

void run(const Common& common, const FitRequest& request) {
  const auto started = std::chrono::steady_clock::now();
  const std::vector<std::filesystem::path> inputs = {request.rig, request.target, request.neutral};
  check_output(request.output, inputs);
  formats::PartialGroup together;
  if (!request.report.empty()) {
    make_output_folder(request.report, &together);
    std::vector<std::filesystem::path> outputs = fit_report_files(request.report);
    outputs.push_back(request.output);
    check_outputs(outputs, inputs);
  }
  fit::Subject subject(rig::read(formats::read_bytes(request.rig), request.rig.string()), request.level);
  FitTargets targets;
  std::vector<fit::FitResult> results;
  std::vector<double> motion;
  nlohmann::ordered_json scan_figures;
  if (!request.camera.empty())
    fit_all_pictures(common, request, subject, targets, results, motion);
  else if (const auto scan = scan_of(request, subject))
    fit_one_scan(common, request, *scan, subject, targets, results, motion, scan_figures);
  else
    fit_targets(common, request, subject, targets, results, motion);
  write_fit(request.output, subject, targets, results, request.reading.fps);
  if (!request.report.empty()) write_fit_report(request.report, subject, targets, results);
  together.keep();
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - started).count();
  nlohmann::ordered_json report = {{"output", request.output.string()}, {"level", subject.level_name()}};
  if (!scan_figures.is_null()) report.update(scan_figures);
  if (results.size() == 1) {
    report.update(figures(subject, results[0]));
  } else {
    report.update(summary(results, motion));
    for (size_t i = 0; i < results.size(); ++i) {
      nlohmann::ordered_json entry = {{"name", targets.names[i]}};
      entry.update(figures(subject, results[i]));
      report["targets"].push_back(entry);
    }
  }
  report["seconds"] = seconds;
  char line[200];
  std::snprintf(line, sizeof line, "%zu fitted: share %.3f, error %.3f mm, %.2f s", results.size(),
                report["share"].get<double>(), report["error_mm"].get<double>(), seconds);
  common.say(line);
  common.say("wrote " + request.output.string());
  common.report(report);
}

}  // namespace

void add_fit(const Command& tool, Common& common) {
  auto request = std::make_shared<FitRequest>();
  const Command command =
      tool.command("fit", "Fit activations to a posed mesh, a scan, shapes, landmarks or a take");
  add_rig_argument(command, request->rig);
  command
      .option(
          "--target", &request->target,
          "Mesh of the rig's topology (.glb, .gltf, .obj, .ply, .stl), its morph targets or their animation, "
          "a cache (.pc2, .mdd), a folder of meshes (one per frame), a scan of any topology, or landmarks "
          "(.json)")
      .required();
  command
      .option("-o,--output", &request->output,
              "Activations (.json), a folder of them for several shapes, or curves (.csv, .json)")
      .required();
  command.option("--report", &request->report, "Folder for residual.png, residual.ply and report.md")
      .value("DIR")
      .default_text("none");
  add_level_option(command, request->level);
  command.option("--shape", &request->shape, "Fit one morph target only").default_text("all");
  command.option("--as", &request->reading.as, "What to fit of a file with morph targets")
      .one_of({"auto", "mesh", "shapes", "take", "scan"});
  command
      .option("--neutral", &request->neutral,
              "Landmarks of the face at rest by the same detector, for a target of landmarks (.json)")
      .default_text("the rig's own landmarks");
  command
      .option("--camera", &request->camera,
              "For landmarks in pictures, points of two numbers in pixels: focal length of the camera and "
              "centre of its picture, pixels")
      .value("FOCAL,X,Y")
      .default_text("none: points are places");
  command
      .option("--head-pose", &request->reading.head_pose,
              "auto: remove the head's rigid motion if parts that no muscle moves have moved")
      .one_of({"auto", "fixed"});
  add_outside_option(command, request->reading.allow_outside);
  command.option("--fps", &request->reading.fps, "Frames a second of what holds no times").range(1.0, 1000.0);
  command
      .option("--ridge", &request->fitting.ridge, "Cost of squared activations, mm^2 of mean squared error")
      .range(0.0, 1e3);
  command.option("--sparsity", &request->fitting.sparsity, "Cost of activations' sizes, mm^2")
      .range(0.0, 1e3);
  command.option("--smoothness", &request->fitting.smoothness, "Cost of squared changes between frames, mm^2")
      .range(0.0, 1e3);
  command.run([request, &common] { run(common, *request); });
}

}  // namespace fascia::cli
