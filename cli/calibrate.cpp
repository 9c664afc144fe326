#include "cli/calibrate.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <nlohmann/json.hpp>

#include "cli/calibrate_depth.h"
#include "cli/fit_match.h"
#include "cli/fit_scan.h"
#include "cli/fit_target.h"
#include "cli/posing.h"
#include "fit/calibration.h"
#include "formats/scene.h"
#include "geometry/error.h"
#include "geometry/text.h"
#include "rig/write/write.h"

namespace fascia::cli {

namespace {

using Json = nlohmann::ordered_json;

struct CalibrateRequest {
  std::filesystem::path rig, scans, output;
  std::string level = "low", adjust = "all";
  bool allow_outside = false;
  fit::CalibrationOptions options;
};

/// The rig's tables by any spelling of an expression's name.
class Tables {
 public:
  Tables(const std::filesystem::path& rig, const fit::Subject& subject) : face_(rig, {}), subject_(subject) {}

  /// What the tables give the channels for "arkit:jawOpen" or "jawOpen", or for both sides of a name without
  /// one
  /// ("mouthSmile"). Empty when no table knows it.
  std::vector<float> row(const std::string& name) const {
    std::vector<float> values;
    for (const rig::Channel& channel : subject_.channels())
      values.push_back(channel.rest);
    const std::string sided = with_side(name);
    if (add(name, values) || (sided != name && add(sided, values)) ||
        (add(name + "Left", values) && add(name + "Right", values)))
      return values;
    return {};
  }

 private:
  /// "mouthSmile_L" as "mouthSmileLeft".
  static std::string with_side(const std::string& name) {
    if (name.size() < 3 || std::string("_.-").find(name[name.size() - 2]) == std::string::npos) return name;
    const std::string stem = name.substr(0, name.size() - 2);
    switch (name.back()) {
      case 'L':
      case 'l':
        return stem + "Left";
      case 'R':
      case 'r':
        return stem + "Right";
      default:
        return name;
    }
  }

  bool add(const std::string& name, std::vector<float>& values) const {
    uint32_t at = 0, member = 0;
    if (fascia_asset_find_member(face_.asset(), name.c_str(), &at, &member) != FASCIA_OK) return false;
    const rig::NamedSet& set = subject_.file().rig.actuation.sets[at];
    for (size_t e = 0; e < set.weights.size(); ++e)
      if (set.member_indices[e] == member) values[set.channel_indices[e]] += set.weights[e];
    return true;
  }

  Face face_;
  const fit::Subject& subject_;
};

bool is_mesh_file(const std::filesystem::path& path) {
  const std::string extension = extension_of(path);
  return extension == ".obj" || extension == ".ply" || extension == ".glb" || extension == ".gltf" ||
         extension == ".stl";
}

/// One expression a file, by its name.
void add_scans(const Common& common, const CalibrateRequest& request, fit::Subject& subject,
               const Tables& tables, std::vector<fit::CalibrationCase>& cases,
               std::vector<std::string>& unknown) {
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::directory_iterator(request.scans))
    if (entry.is_regular_file() && is_mesh_file(entry.path())) files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  if (files.empty())
    throw Error("'" + request.scans.string() + "' holds no meshes: name each scan by its expression");
  for (const std::filesystem::path& path : files) {
    const std::string name = path.stem().string();
    std::vector<float> row = tables.row(name);
    if (row.empty()) {
      unknown.push_back(name);
      continue;
    }
    common.progress("reading " + name);
    const formats::Scene scene = formats::read(path, reading_options(request.allow_outside));
    if (has_rig_topology(subject, scene)) {
      FitTargetOptions options;
      options.as = "mesh";
      options.allow_outside = request.allow_outside;
      cases.push_back({name, open_fit_targets(common, path, subject, options).target(0), std::move(row)});
      continue;
    }
    common.progress("matching " + name);
    const PlacedScan placed = place_scan(subject, scene, true);
    for (const std::string& warning : placed.warnings)
      common.warn(name + ": " + warning);
    fit::Target target = fit::fit_scan(subject, placed.mesh).target;
    cases.push_back({name, std::move(target), std::move(row)});
  }
}

/// One expression a morph target.
void add_shapes(const Common& common, const CalibrateRequest& request, const fit::Subject& subject,
                const Tables& tables, std::vector<fit::CalibrationCase>& cases,
                std::vector<std::string>& unknown) {
  FitTargetOptions options;
  options.as = "shapes";
  options.allow_outside = request.allow_outside;
  const FitTargets shapes = open_fit_targets(common, request.scans, subject, options);
  for (size_t i = 0; i < shapes.names.size(); ++i) {
    std::vector<float> row = tables.row(shapes.names[i]);
    // Alone it draws the lips through each other: it is made to be added to an open jaw.
    if (lower_case(shapes.names[i]).find("mouthclose") != std::string::npos) row.clear();
    fit::Target target = row.empty() ? fit::Target{} : shapes.target(i);
    if (row.empty() || !(target.displacements.squaredNorm() > 0.0))
      unknown.push_back(shapes.names[i]);
    else
      cases.push_back({shapes.names[i], std::move(target), std::move(row)});
  }
}

/// The subject with another physique; null, and a fault in `rebuilt`, where its anatomy cannot be had.
std::unique_ptr<fit::Subject> with_physique(const fit::Subject& subject, const fit::Physique& physique,
                                            RebuiltRig& rebuilt) {
  rig::RigFile file = subject.file();
  if (physique.takes_build()) {
    const rig::Rig* other = rebuilt.at(physique, subject.level_name());
    if (other == nullptr) return nullptr;
    file.rig = *other;
  }
  file.rig = fit::with_physique(std::move(file.rig), physique);
  return std::make_unique<fit::Subject>(std::move(file), subject.level_name());
}

/// The rig with every table's weights times the gains, within the channels' ranges.
rig::Rig calibrated(rig::Rig rig, const std::vector<double>& gains) {
  for (rig::NamedSet& set : rig.actuation.sets)
    for (size_t e = 0; e < set.weights.size(); ++e) {
      const rig::Channel& channel = rig.actuation.channels[set.channel_indices[e]];
      const float scaled = set.weights[e] * static_cast<float>(gains[set.channel_indices[e]]);
      set.weights[e] = std::clamp(scaled, std::min(channel.minimum, set.weights[e]),
                                  std::max(channel.maximum, set.weights[e]));
    }
  return rig;
}

Json physique_json(const fit::Physique& physique) {
  return {{"tissue_depth", physique.depth},
          {"stiffness", physique.stiffness},
          {"peak_shortening_upper_face", physique.shortening[0]},
          {"peak_shortening_middle_face", physique.shortening[1]},
          {"peak_shortening_lower_face", physique.shortening[2]},
          {"muscle_breadth_upper_face", physique.breadth[0]},
          {"muscle_breadth_middle_face", physique.breadth[1]},
          {"muscle_breadth_lower_face", physique.breadth[2]}};
}

Json cases_json(const fit::Calibration& calibration) {
  Json list = Json::array();
  for (const fit::CaseFigures& one : calibration.cases)
    list.push_back({{"name", one.name},
                    {"before_share", one.before_share},
                    {"after_share", one.after_share},
                    {"left_out_share", one.left_out_share},
                    {"before_mm", one.before_mm},
                    {"after_mm", one.after_mm},
                    {"left_out_mm", one.left_out_mm}});
  return list;
}

Json gains_json(const fit::Subject& subject, const std::vector<double>& gains) {
  Json list = Json::object();
  for (size_t c = 0; c < gains.size(); ++c)
    if (std::abs(gains[c] - 1.0) > 0.005) list[subject.channels()[c].name] = std::round(1e4 * gains[c]) / 1e4;
  return list;
}

void say_table(const Common& common, const fit::Calibration& calibration) {
  char line[240];
  for (const fit::CaseFigures& one : calibration.cases) {
    std::snprintf(line, sizeof line, "%-28s share %6.3f -> %6.3f, left out %6.3f; rms %5.2f -> %5.2f mm",
                  one.name.c_str(), one.before_share, one.after_share, one.left_out_share, one.before_mm,
                  one.after_mm);
    common.say(line);
  }
  std::snprintf(line, sizeof line, "all: share %.3f -> %.3f; expressions left out of the calibration %.3f",
                calibration.before_share, calibration.after_share, calibration.left_out_share);
  common.say(line);
  const fit::Physique& own = calibration.physique;
  std::snprintf(
      line, sizeof line,
      "times as built: tissue depth %.2f, stiffness %.2f; upper, middle and lower face: peak shortening "
      "%.2f, %.2f, %.2f, breadth of muscles %.2f, %.2f, %.2f",
      own.depth, own.stiffness, own.shortening[0], own.shortening[1], own.shortening[2], own.breadth[0],
      own.breadth[1], own.breadth[2]);
  common.say(line);
}

void run(const Common& common, const CalibrateRequest& request) {
  check_output(request.output, {request.rig, request.scans});
  if (extension_of(request.output) != ".glb")
    throw Error("'" + request.output.string() + "': a rig is written as .glb");
  const std::vector<uint8_t> bytes = formats::read_bytes(request.rig);
  fit::Subject subject(rig::read(bytes, request.rig.string()), request.level);
  const Tables tables(request.rig, subject);
  std::vector<fit::CalibrationCase> cases;
  std::vector<std::string> unknown;
  if (std::filesystem::is_directory(request.scans))
    add_scans(common, request, subject, tables, cases, unknown);
  else
    add_shapes(common, request, subject, tables, cases, unknown);
  if (!unknown.empty()) {
    std::string names;
    for (const std::string& name : unknown)
      names += (names.empty() ? "" : ", ") + name;
    common.warn("ignored, because no table of the rig names them or they do not move: " + names);
  }
  if (cases.empty())
    throw Error("'" + request.scans.string() +
                "': none of its expressions is known: name scans as 'fascia info --names' lists them, such "
                "as jawOpen.obj");
  common.progress("calibrating by " + std::to_string(cases.size()) + " expressions");
  RebuiltRig rebuilt(bytes, subject.file());
  fit::Remake remake;
  if (request.adjust == "all")
    remake = [&](const fit::Physique& physique) { return with_physique(subject, physique, rebuilt); };
  const fit::Calibration calibration = fit::calibrate(subject, cases, request.options, remake);
  if (!rebuilt.fault().empty())
    common.warn("not all tissue depths and breadths of muscles could be tried: " + rebuilt.fault());
  rig::Rig own = subject.file().rig;
  if (calibration.physique.takes_build()) {
    common.progress("building with its own tissue depths and muscles");
    const rig::Rig* other = rebuilt.at(calibration.physique, own.tissue.levels.back().name);
    if (other == nullptr)
      throw Error("'" + request.rig.string() + "': " + rebuilt.fault() + "; use --adjust gains");
    own = *other;
  }
  const std::vector<uint8_t> out =
      rig::write(rig::original(rig::glb_source(bytes, request.rig.string())),
                 calibrated(fit::with_physique(std::move(own), calibration.physique), calibration.gains));
  formats::write_bytes(request.output, out.data(), out.size());
  say_table(common, calibration);
  if (calibration.gains_kept < 1.0)
    common.warn(
        calibration.gains_kept > 0.0
            ? "gains are kept in part: whole, they made expressions left out worse"
            : "gains stay at 1: others made expressions left out worse; more scans may tell them better");
  common.say("wrote " + request.output.string());
  common.report({{"output", request.output.string()},
                 {"level", subject.level_name()},
                 {"before_share", calibration.before_share},
                 {"after_share", calibration.after_share},
                 {"left_out_share", calibration.left_out_share},
                 {"gains_kept", calibration.gains_kept},
                 {"physique", physique_json(calibration.physique)},
                 {"gains", gains_json(subject, calibration.gains)},
                 {"expressions", cases_json(calibration)},
                 {"unknown", unknown}});
}

}  // namespace

void add_calibrate(const Command& tool, Common& common) {
  auto request = std::make_shared<CalibrateRequest>();
  const Command command = tool.command("calibrate",
                                       "Calibrate a rig to one person's expressions: muscle gains, peak "
                                       "shortening, breadth, stiffness, tissue depth");
  add_rig_argument(command, request->rig);
  command
      .option("--scans", &request->scans,
              "Folder of meshes or scans named by their expression (jawOpen.obj, mouthSmile.ply), or a file "
              "whose morph "
              "targets are named so")
      .required();
  command.option("-o,--output", &request->output, "Rig to write (.glb)").required();
  command.option("--level", &request->level, "Level of detail to calibrate at")
      .one_of({"low", "medium", "high"});
  command
      .option(
          "--adjust", &request->adjust,
          "What to identify: muscle gains only, or also the depth and stiffness of tissue and, by thirds of "
          "the face, peak shortening and the breadth of attachment regions")
      .one_of({"all", "gains"});
  command
      .option("--prior", &request->options.prior,
              "Penalty for a gain different from 1, relative to the expressions' squared motion; as given "
              "where it is, otherwise scaled by cross-validation")
      .range(1e-6, 1e3);
  add_outside_option(command, request->allow_outside);
  command.run([request, &common] {
    request->options.scales_prior = request->options.prior == fit::CalibrationOptions().prior;
    run(common, *request);
  });
}

}  // namespace fascia::cli
