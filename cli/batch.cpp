#include "cli/batch.h"

#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <csignal>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <thread>

#include "batch/places.h"
#include "batch/run.h"
#include "batch/slurm.h"
#include "cli/batch_report.h"
#include "formats/content_hash.h"
#include "formats/files.h"
#include "formats/partial.h"
#include "geometry/error.h"

namespace fascia::cli {

namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr int exit_some_failed = 1, exit_interrupted = 130;

struct BatchRequest {
  std::string source, operand;
  fs::path output;
  size_t jobs = 0;
  double seconds = 300.0;
  size_t megabytes = 4096, attempts = 2, at_once = 0;
  int task_index = -1;
  size_t task_count = 0;
  bool has_checks = true, has_thumbnails = true, retries_failed = false, allow_outside = false,
       is_dry = false;
  std::string detail, time, partition;
};

std::atomic<bool> is_stopped = false;

/// The first time lets the heads be put away; the second leaves at once.
void on_interrupt(int) {
  if (is_stopped.exchange(true)) {
    formats::remove_partial_files();
    _exit(exit_interrupted);
  }
}

fs::path this_program() {
  std::error_code status;
  const fs::path path = fs::read_symlink("/proc/self/exe", status);
  if (status) throw Error("the tool cannot find itself (/proc/self/exe): " + status.message());
  return path;
}

size_t processors() {
  return std::max(1U, std::thread::hardware_concurrency());
}

void check_output_given(const BatchRequest& request) {
  if (request.output.empty()) throw UsageError("'fascia batch' needs -o DIR");
}

batch::Task task_of(const BatchRequest& request) {
  if (request.task_index < 0) return batch::task_of_environment(request.task_count);
  if (request.task_count == 0) throw UsageError("--task-index needs --task-count");
  const auto index = static_cast<size_t>(request.task_index);
  if (index >= request.task_count) throw UsageError("--task-index counts from 0 to --task-count less 1");
  return {index, request.task_count};
}

std::string line_of(const batch::Record& record, batch::Fate fate) {
  if (fate == batch::Fate::elsewhere) return record.id + ": another process is at it";
  if (!record.is_done)
    return record.id + ": " + record.message +
           (record.is_lasting ? "" : " (no fault of the head: the same command tries it again)");
  char seconds[32];
  std::snprintf(seconds, sizeof seconds, "%.1f s", record.seconds);
  std::string text = record.id + ": " + seconds;
  if (!record.failed_checks.empty())
    text += ", " + std::to_string(record.failed_checks.size()) + " of its checks fail";
  return text;
}

/// The request's own options of `fascia build`; a head's, from its manifest, take their place.
std::vector<batch::Head> heads_of(const BatchRequest& request, const std::string& source) {
  std::vector<batch::Head> heads = batch::read_heads(source);
  for (batch::Head& head : heads) {
    std::vector<std::string>& words = head.options;
    if (!request.detail.empty() && std::find(words.begin(), words.end(), "--detail") == words.end())
      words.insert(words.end(), {"--detail", request.detail});
    if (request.allow_outside) words.push_back("--allow-outside");
  }
  return heads;
}

void run_heads(const Common& common, const BatchRequest& request) {
  check_output_given(request);
  const std::vector<batch::Head> all = heads_of(request, request.source);
  const batch::Task task = task_of(request);
  const std::vector<batch::Head> heads = batch::share(all, task.index, task.count);
  batch::check_inputs(all, request.output);
  batch::check_results(heads, request.output);
  make_output_folder(request.output);
  batch::Options options;
  options.tool = this_program();
  options.version = formats::content_hash(formats::read_bytes(options.tool));
  options.output = fs::absolute(request.output);
  options.threads = common.threads > 0 ? static_cast<size_t>(common.threads) : 1;
  options.jobs = request.jobs > 0 ? request.jobs : std::max<size_t>(processors() / options.threads, 1);
  options.limits = {request.seconds, request.megabytes};
  options.attempts = static_cast<int>(request.attempts);
  options.has_checks = request.has_checks;
  options.has_thumbnails = request.has_thumbnails;
  options.retries_failed = request.retries_failed;
  for (const int number : {SIGINT, SIGTERM, SIGHUP})
    std::signal(number, on_interrupt);
  const auto started = std::chrono::steady_clock::now();
  size_t ended = 0;
  std::map<batch::Fate, size_t> counts;
  const batch::Report report =
      batch::run_all(heads, options, is_stopped, [&](size_t, const batch::Record& record, batch::Fate fate) {
        ++ended;
        if (fate != batch::Fate::kept)
          common.say("[" + std::to_string(ended) + "/" + std::to_string(heads.size()) + "] " +
                     line_of(record, fate));
      });
  if (is_stopped) {
    std::fprintf(stderr, "fascia: interrupted; the same command resumes the batch\n");
    throw Exit{exit_interrupted};
  }
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - started).count();
  // Each head once: one that failed before and was not tried again is failed, not kept.
  size_t failed = 0, kept = 0;
  for (size_t h = 0; h < heads.size(); ++h) {
    const batch::Fate fate = report.fates[h];
    const bool is_done = report.records[h].is_done;
    ++counts[fate];
    failed += fate != batch::Fate::elsewhere && !is_done;
    kept += fate == batch::Fate::kept && is_done;
  }
  const size_t built = counts[batch::Fate::done] + counts[batch::Fate::failed];
  char rate[64];
  std::snprintf(rate, sizeof rate, "%.1f s, %.1f heads a minute", seconds,
                seconds > 0.0 ? 60.0 * static_cast<double>(built) / seconds : 0.0);
  common.say(std::to_string(counts[batch::Fate::done]) + " built, " + std::to_string(kept) + " kept, " +
             std::to_string(failed) + " failed, " + std::to_string(counts[batch::Fate::elsewhere]) +
             " elsewhere; " + rate);
  Json json = {{"output", request.output.string()},
               {"task", {{"index", task.index}, {"count", task.count}}},
               {"built", counts[batch::Fate::done]},
               {"kept", kept},
               {"elsewhere", counts[batch::Fate::elsewhere]},
               {"failed", failed},
               {"seconds", seconds},
               {"failures", Json::array()}};
  for (const batch::Record& record : report.records)
    if (!record.is_done && record.attempts > 0)
      json["failures"].push_back({{"id", record.id}, {"cause", record.cause}, {"message", record.message}});
  common.report(json);
  if (failed > 0) throw Exit{exit_some_failed};
}

void submit(const Common& common, const BatchRequest& request) {
  check_output_given(request);
  if (request.operand.empty())
    throw UsageError("'fascia batch submit' needs a manifest or a folder of heads");
  const std::vector<batch::Head> all = heads_of(request, request.operand);
  batch::check_inputs(all, request.output);
  batch::check_results(all, request.output);
  const size_t heads = all.size();
  make_output_folder(request.output);
  fs::create_directories(request.output / ".logs");
  batch::SlurmJob job;
  job.tool = this_program();
  job.source = fs::absolute(request.operand);
  job.output = fs::absolute(request.output);
  constexpr size_t heads_a_task = 100, most_tasks = 1000;  // Slurm's MaxArraySize is 1001 unless it is raised
  job.tasks = request.task_count > 0 ? request.task_count
                                     : std::min(most_tasks, (heads + heads_a_task - 1) / heads_a_task);
  job.most_at_once = request.at_once;
  job.jobs = std::max<size_t>(request.jobs, 1);
  job.megabytes = request.megabytes;
  const size_t heads_of_one = (heads + job.tasks - 1) / job.tasks,
               turns = (heads_of_one + job.jobs - 1) / job.jobs;
  const int steps = 1 + (request.has_checks ? 1 : 0) + (request.has_thumbnails ? 1 : 0);
  job.time = !request.time.empty()
                 ? request.time
                 : batch::slurm_time(static_cast<double>(turns * request.attempts) * steps * request.seconds);
  job.partition = request.partition;
  char seconds[32];
  std::snprintf(seconds, sizeof seconds, "%g", request.seconds);
  job.options = {"--time", seconds, "--attempts", std::to_string(request.attempts)};
  if (!request.has_checks) job.options.push_back("--no-check");
  if (!request.has_thumbnails) job.options.push_back("--no-thumbnail");
  if (request.retries_failed) job.options.push_back("--retry-failed");
  if (request.allow_outside) job.options.push_back("--allow-outside");
  if (!request.detail.empty()) job.options.insert(job.options.end(), {"--detail", request.detail});
  const fs::path script = job.output / "batch.sbatch";
  formats::write_text(script, batch::slurm_script(job));
  common.say("wrote " + script.string() + ": " + std::to_string(heads) + " heads in " +
             std::to_string(job.tasks) + " tasks");
  Json json = {{"script", script.string()}, {"heads", heads}, {"tasks", job.tasks}, {"job", nullptr}};
  if (!request.is_dry) {
    const batch::Outcome outcome = batch::run({"/usr/bin/env", "sbatch", "--parsable", script.string()},
                                              {60.0, 0}, job.output, is_stopped);
    if (outcome.exit_code == 127)
      throw Error("Slurm's 'sbatch' is not on the path: '" + script.string() +
                  "' is written; submit it where it is");
    if (outcome.exit_code != 0)
      throw Error("'sbatch " + script.string() +
                  "' failed: " + outcome.err.substr(0, outcome.err.find('\n')));
    const std::string id = outcome.out.substr(0, outcome.out.find_first_of(";\n"));
    common.say("submitted as job " + id);
    json["job"] = id;
  }
  common.report(json);
}

void report(const Common& common, const BatchRequest& request) {
  const fs::path folder = request.operand.empty() ? request.output : fs::path(request.operand);
  if (folder.empty()) throw UsageError("'fascia batch report' needs the batch's folder");
  const std::vector<batch::Record> records = batch::all_records(folder);
  if (records.empty())
    throw Error("'" + folder.string() +
                "' holds no results of 'fascia batch'; name the folder that -o named");
  const fs::path page = folder / "report.html";
  formats::write_text(page, batch_page("Heads in " + folder.filename().string(), records));
  Json json = batch_figures(records);
  common.say("wrote " + page.string() + ": " + std::to_string(records.size()) + " heads, " +
             std::to_string(json["failed"].get<size_t>()) + " failed");
  json["report"] = page.string();
  common.report(json);
}

void run(const Common& common, const BatchRequest& request) {
  if (request.source == "submit") return submit(common, request);
  if (request.source == "report") return report(common, request);
  if (!request.operand.empty())
    throw UsageError("'fascia batch' takes one manifest or folder, not '" + request.operand + "' as well");
  run_heads(common, request);
}

}  // namespace

void add_batch(const Command& tool, Common& common) {
  auto request = std::make_shared<BatchRequest>();
  const Command command = tool.command(
      "batch",
      "Build many heads in parallel, each in a process of its own with limits; completed heads are "
      "not built again. "
      "'submit' queues them on a Slurm cluster, 'report' writes a summary page");
  command
      .positional("SOURCE", &request->source,
                  "Manifest (one JSON object per line: {\"head\": FILE, ...}) or folder of heads; or submit, "
                  "or report")
      .required();
  command.positional("OF", &request->operand, "Manifest or folder to submit; the batch's folder to report on")
      .default_text("none");
  command.option("-o,--output", &request->output, "Output folder, with one folder per head")
      .value("DIR")
      .default_text("none");
  command.option("--jobs", &request->jobs, "Heads at a time")
      .range(1, 4096)
      .default_text("as many as processors");
  command.option("--time", &request->seconds, "Time limit of each step of a head, seconds; 0: none")
      .range(0, 1e6);
  command.option("--memory", &request->megabytes, "Memory limit of each head, address space in MB; 0: none")
      .range(0, 1e7);
  command.option("--attempts", &request->attempts, "Attempts for a head whose process crashes").range(1, 10);
  command.flag("--retry-failed", request->retries_failed, "Try heads again that failed before");
  command.option("--detail", &request->detail, "Finest lattice of heads whose manifest names none")
      .one_of({"low", "medium", "high"})
      .default_text("the build's");
  add_outside_option(command, request->allow_outside);
  command.flag("--check", request->has_checks, "Check each rig", true);
  command.flag("--thumbnail", request->has_thumbnails, "Draw each head", true);
  command.option("--task-index", &request->task_index, "Index of this task, from 0")
      .range(0, 1e9)
      .default_text("from Slurm, AWS Batch or GNU parallel, else 0");
  command.option("--task-count", &request->task_count, "Number of tasks that share the heads")
      .range(1, 1e9)
      .default_text("from Slurm or AWS Batch, else 1; for submit one per 100 heads");
  command.option("--at-once", &request->at_once, "submit: maximum number of simultaneous tasks; 0: unlimited")
      .range(0, 1e6);
  command.option("--slurm-time", &request->time, "submit: time limit of a task, in Slurm's format")
      .value("TIME")
      .default_text("from the limits of its heads, 10 minutes to 4 hours");
  command.option("--partition", &request->partition, "submit: Slurm's partition")
      .default_text("the cluster's own");
  command.flag("--dry-run", request->is_dry, "submit: write the script only");
  command.run([request, &common] { run(common, *request); });
}

}  // namespace fascia::cli
