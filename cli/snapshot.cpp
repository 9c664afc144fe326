#include "cli/snapshot.h"

#include <memory>
#include <nlohmann/json.hpp>

#include "cli/check.h"
#include "cli/progress.h"
#include "cli/snapshot_report.h"
#include "formats/files.h"
#include "geometry/error.h"
#include "snapshot/compare.h"
#include "snapshot/file.h"
#include "snapshot/junit.h"
#include "snapshot/record.h"

namespace fascia::cli {

namespace {

using Json = nlohmann::ordered_json;
namespace fs = std::filesystem;

struct SnapshotRequest {
  std::string action;
  fs::path file, output, against, poses, report, junit;
  std::vector<fs::path> curves;
  std::string level, reason;
  double tolerance_mm = 0.0;  ///< 0: not given
};

std::string quoted(const fs::path& path) {
  return "'" + path.string() + "'";
}

std::string text_of(const fs::path& path) {
  const std::vector<uint8_t> bytes = formats::read_bytes(path);
  return {bytes.begin(), bytes.end()};
}

snapshot::Snapshot read_snapshot(const fs::path& path) {
  return snapshot::from_text(text_of(path), quoted(path));
}

/// How a snapshot names a file of curves: from its own folder, with forward slashes.
std::string beside(const fs::path& snapshot, const fs::path& file) {
  const fs::path folder = fs::absolute(snapshot).parent_path();
  return fs::absolute(file).lexically_normal().lexically_relative(folder.lexically_normal()).generic_string();
}

snapshot::TakeFile take_file(const fs::path& snapshot, const fs::path& file) {
  return {quoted(file), beside(snapshot, file), formats::read_bytes(file)};
}

/// The files of a snapshot's takes: those that were given, else where it says they are.
std::vector<fs::path> curves_of(const snapshot::Snapshot& snapshot, const fs::path& path,
                                const std::vector<fs::path>& given) {
  if (!given.empty()) return given;
  std::vector<fs::path> files;
  for (const snapshot::Take& take : snapshot.takes)
    files.push_back(path.parent_path() / take.path);
  return files;
}

std::function<void(size_t, size_t)> shown(const Common& common, std::unique_ptr<Progress>& progress) {
  return [&common, &progress](size_t, size_t all) {
    if (!progress) progress = std::make_unique<Progress>(common, "playing poses", all);
    progress->step();
  };
}

/// What an earlier snapshot of the same name had is recorded again, unless something else is asked for.
void take_over(const snapshot::Snapshot& old, const SnapshotRequest& wanted, snapshot::Request& request) {
  if (request.poses.empty()) request.poses = old.poses;
  if (request.level.empty()) request.level = old.level;
  request.kept_regions = old.regions;
  request.kept_meshes = old.meshes;
  if (wanted.tolerance_mm > 0.0)
    for (snapshot::Region& region : request.kept_regions)
      region.tolerance_mm = wanted.tolerance_mm;
  for (const fs::path& file : curves_of(old, wanted.output, wanted.curves))
    request.takes.push_back(take_file(wanted.output, file));
}

void record(const Common& common, const SnapshotRequest& wanted) {
  std::vector<fs::path> inputs = wanted.curves;
  inputs.insert(inputs.end(), {wanted.file, wanted.poses});
  check_output(wanted.output, inputs);
  snapshot::Request request;
  request.level = wanted.level;
  request.threads = common.threads;
  if (wanted.tolerance_mm > 0.0) request.region_options.tolerance_mm = wanted.tolerance_mm;
  if (!wanted.poses.empty()) snapshot::read_poses(text_of(wanted.poses), quoted(wanted.poses), request);
  std::vector<std::string> reasons;
  if (fs::exists(wanted.output)) {
    if (wanted.reason.empty())
      throw Error(
          quoted(wanted.output) +
          " is there already: say with --reason why it is recorded anew, or give another name with -o");
    const snapshot::Snapshot old = read_snapshot(wanted.output);
    reasons = old.reasons;
    take_over(old, wanted, request);
  } else {
    for (const fs::path& file : wanted.curves)
      request.takes.push_back(take_file(wanted.output, file));
  }
  reasons.push_back(wanted.reason.empty() ? "first recorded" : wanted.reason);
  std::unique_ptr<Progress> progress;
  request.progress = shown(common, progress);
  snapshot::Snapshot result =
      snapshot::record(formats::read_bytes(wanted.file), quoted(wanted.file), request);
  progress.reset();
  result.reasons = reasons;
  const std::string text = snapshot::to_text(result);
  formats::write_text(wanted.output, text);
  common.say("wrote " + wanted.output.string() + ": " + std::to_string(result.states.size()) +
             " poses and frames of " + std::to_string(result.regions.size()) + " regions, " +
             std::to_string(text.size() / 1024 + 1) + " KB");
  common.report({{"output", wanted.output.string()},
                 {"rig", result.rig},
                 {"level", result.level},
                 {"states", result.states.size()},
                 {"regions", result.regions.size()},
                 {"vertices", result.vertex_count()},
                 {"bytes", text.size()},
                 {"reasons", result.reasons}});
}

Json rows_of(const snapshot::Snapshot& then, const snapshot::Comparison& comparison) {
  Json rows = Json::array();
  for (const snapshot::Difference& difference : comparison.differences)
    if (!difference.ok)
      rows.push_back({{"state", then.states[difference.state].name},
                      {"region", then.regions[difference.region].name},
                      {"mean_mm", difference.mean_mm},
                      {"largest_mm", difference.largest_mm},
                      {"mesh", then.meshes[difference.vertex.mesh].mesh},
                      {"vertex", difference.vertex.vertex}});
  return rows;
}

/// Says what differs, and leaves with the exit code of a check that failed.
void finish(const Common& common, const snapshot::Snapshot& then, const snapshot::Comparison& comparison,
            double tolerance_mm, Json report) {
  constexpr size_t most_lines = 20;
  const auto worst = comparison.worst(std::min(comparison.failed, most_lines));
  for (const snapshot::Difference& difference : worst)
    common.say(then.states[difference.state].name + ", " +
               snapshot::sentence(then, difference, tolerance_mm));
  if (comparison.failed > worst.size())
    common.say("and " + std::to_string(comparison.failed - worst.size()) + " more");
  const auto most = comparison.worst(1);
  const double largest = most.empty() ? 0.0 : most[0].mean_mm;
  char text[96];
  std::snprintf(text, sizeof text, "; the largest is %.3f mm", largest);
  common.say(std::to_string(comparison.failed) + " of " + std::to_string(comparison.differences.size()) +
             " differences are above what is allowed" + text);
  report["states"] = then.states.size();
  report["failed"] = comparison.failed;
  report["same_rig"] = comparison.is_same_rig;
  report["largest_mean_mm"] = largest;
  report["differences"] = rows_of(then, comparison);
  common.report(report);
  if (comparison.failed > 0) throw Exit{exit_check};
}

/// Neither of a check's results may take the place of the other or of `inputs`.
void check_results(const SnapshotRequest& wanted, std::vector<fs::path> inputs) {
  inputs.insert(inputs.end(), {wanted.file, wanted.against});
  check_outputs({wanted.report, wanted.junit}, inputs);
}

void check_snapshot(const Common& common, const SnapshotRequest& wanted) {
  check_results(wanted, wanted.curves);
  const snapshot::Snapshot then = read_snapshot(wanted.against);
  SnapshotReport report = {wanted.file, curves_of(then, wanted.against, wanted.curves), wanted.tolerance_mm};
  check_results(wanted, report.curves);
  std::vector<snapshot::TakeFile> takes;
  for (const fs::path& file : report.curves)
    takes.push_back(take_file(wanted.against, file));
  std::unique_ptr<Progress> progress;
  const snapshot::Snapshot now = snapshot::replay(formats::read_bytes(wanted.file), quoted(wanted.file), then,
                                                  takes, common.threads, shown(common, progress));
  progress.reset();
  const snapshot::Comparison comparison = snapshot::compare(then, now, wanted.tolerance_mm);
  Json json = {{"against", wanted.against.string()}};
  if (!wanted.junit.empty()) {
    formats::write_text(
        wanted.junit, snapshot::junit(then, comparison, wanted.against.stem().string(), wanted.tolerance_mm));
    common.say("wrote " + wanted.junit.string());
    json["junit"] = wanted.junit.string();
  }
  if (!wanted.report.empty()) {
    formats::write_text(wanted.report, snapshot_page(report, then, now, comparison));
    common.say("wrote " + wanted.report.string());
    json["report"] = wanted.report.string();
  }
  finish(common, then, comparison, wanted.tolerance_mm, json);
}

void diff(const Common& common, const SnapshotRequest& wanted) {
  const snapshot::Snapshot then = read_snapshot(wanted.against), now = read_snapshot(wanted.file);
  finish(common, then, snapshot::compare(then, now, wanted.tolerance_mm), wanted.tolerance_mm,
         {{"against", wanted.against.string()}});
}

/// Options that go with the action and no others.
void check_usage(const SnapshotRequest& wanted) {
  const bool records = wanted.action == "record";
  if (records && wanted.output.empty()) throw UsageError("'fascia snapshot record' needs -o FILE");
  if (!records && wanted.against.empty())
    throw UsageError("'fascia snapshot " + wanted.action + "' needs --against FILE");
  for (const auto& [name, is_given, is_fitting] :
       {std::tuple{"--output", !wanted.output.empty(), records},
        std::tuple{"--against", !wanted.against.empty(), !records},
        std::tuple{"--poses", !wanted.poses.empty(), records},
        std::tuple{"--level", !wanted.level.empty(), records},
        std::tuple{"--reason", !wanted.reason.empty(), records},
        std::tuple{"--curves", !wanted.curves.empty(), wanted.action != "diff"},
        std::tuple{"--report", !wanted.report.empty(), wanted.action == "check"},
        std::tuple{"--junit", !wanted.junit.empty(), wanted.action == "check"}})
    if (is_given && !is_fitting)
      throw UsageError("'fascia snapshot " + wanted.action + "' takes no " + std::string(name));
}

void run(const Common& common, const SnapshotRequest& wanted) {
  check_usage(wanted);
  if (wanted.action == "record") return record(common, wanted);
  if (wanted.action == "check") return check_snapshot(common, wanted);
  diff(common, wanted);
}

}  // namespace

void add_snapshot(const Command& tool, Common& common) {
  auto request = std::make_shared<SnapshotRequest>();
  const Command command = tool.command("snapshot",
                                       "Record the displacements of a rig's skin (record), check them "
                                       "against a recording (check), or compare two "
                                       "recordings (diff); exits with 4 if they differ");
  command.positional("ACTION", &request->action, "What to do").required().one_of({"record", "check", "diff"});
  command.positional("FILE", &request->file, "Rig (.glb) to record or check, or snapshot to compare")
      .required();
  command.option("-o,--output", &request->output, "Snapshot to record; an existing one is updated")
      .default_text("none");
  command.option("--against", &request->against, "Snapshot to check or compare with").default_text("none");
  command.option("--poses", &request->poses, "Poses and regions to record (.json)")
      .default_text("every channel alone and every ARKit shape, regions by landmarks");
  command
      .option("--curves", &request->curves,
              "Curves to simulate as a take, may be repeated; when checking, in the snapshot's order")
      .default_text("none, or the files of the snapshot");
  command.option("--level", &request->level, "Level of detail to record: low, medium or high")
      .value("LEVEL")
      .default_text("the rig's finest");
  command
      .option("--tolerance", &request->tolerance_mm,
              "Allowed difference of a region, root mean square of its vertices, mm")
      .range(1e-3, 1e3)
      .default_text("0.02 when recording, otherwise as recorded");
  command.option("--reason", &request->reason, "Reason for updating an existing snapshot")
      .value("TEXT")
      .default_text("none");
  command.option("--report", &request->report, "Page with heat maps to write (.html)").default_text("none");
  command.option("--junit", &request->junit, "JUnit XML to write").default_text("none");
  command.run([request, &common] { run(common, *request); });
}

}  // namespace fascia::cli
