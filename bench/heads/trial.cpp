#include "bench/heads/trial.h"

#include <sys/wait.h>

#include <chrono>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>

#include "tests/paths/paths.h"

namespace fascia::bench {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

struct Run {
  int code = -1;  // as a shell has it: above 128 a signal
  Json answer;
  double seconds = 0.0;
};

std::string quoted(const fs::path& path) {
  std::string out = "'";
  for (const char c : path.string())
    out += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return out + "'";
}

Run run_tool(const std::string& arguments, const fs::path& folder, int limit) {
  const fs::path out = folder / "answer.json";
  const auto started = std::chrono::steady_clock::now();
  const int status =
      std::system(("timeout -s KILL " + std::to_string(limit) + " " + quoted(test::tool()) + " " + arguments +
                   " --json --quiet >" + quoted(out) + " 2>/dev/null </dev/null")
                      .c_str());
  Run run;
  run.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - started).count();
  run.code = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  std::ifstream file(out);
  run.answer = Json::parse(std::string(std::istreambuf_iterator<char>(file), {}), nullptr, false);
  return run;
}

std::string failure_of(const Run& run) {
  if (run.code == 137) return "timed out";
  return run.code == 0 || run.code == 4 ? "built" : run.code > 128 || run.code == 3 ? "crashed" : "refused";
}

}  // namespace

Trial try_head(const std::string& name, const std::string& kind, const fs::path& head,
               const std::string& detail, const fs::path& folder, const fs::path& sheet, int limit) {
  Trial trial;
  trial.name = name;
  trial.kind = kind;
  const fs::path rig = folder / (name + ".glb");
  const Run build =
      run_tool("build " + quoted(head) + " -o " + quoted(rig) + " --detail " + detail, folder, limit);
  trial.seconds = build.seconds;
  trial.outcome = failure_of(build);
  if (trial.outcome != "built") {
    if (build.answer.is_object()) trial.reason = build.answer.value("error", "");
    return trial;
  }
  trial.megabytes = static_cast<double>(fs::file_size(rig)) / 1e6;
  if (build.answer.is_object() && build.answer.contains("warnings"))
    trial.warnings = static_cast<int>(build.answer["warnings"].size());
  const Run check =
      run_tool("check " + quoted(rig) + (sheet.empty() ? "" : " --sheet " + quoted(sheet)), folder, limit);
  if (failure_of(check) != "built") {
    trial.outcome = "check " + failure_of(check);
    if (check.answer.is_object()) trial.reason = check.answer.value("error", "");
  } else if (check.answer.is_object()) {
    for (const Json& row : check.answer["rows"]) {
      ++trial.rows;
      if (!row["ok"].get<bool>()) trial.failing.push_back(row["name"]);
    }
  }
  fs::remove(rig);
  return trial;
}

}  // namespace fascia::bench
