// Every head, built and checked as a user would: heads as people have them (data/wild), random people of a
// measured face model and variants of the embedded head. Prints a table; each head runs in processes of its
// own.
//
//   bench_heads [--kind wild|people|own] [--only TEXT] [--detail LEVEL] [--csv FILE] [--json FILE] [--sheets
//   DIR] bench_heads --reference      sculpted and measured shapes, measured by the same rows
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>

#include "bench/heads/reference.h"
#include "bench/heads/trial.h"
#include "bench/heads/variants.h"
#include "tests/paths/paths.h"

namespace {

namespace fs = std::filesystem;
using fascia::bench::Trial;

struct Request {
  std::string kind, only;  // empty: all
  std::string detail = "medium";
  fs::path csv, json, sheets;
};

std::string joined(const std::vector<std::string>& words) {
  std::string out;
  for (const std::string& word : words)
    out += (out.empty() ? "" : " ") + word;
  return out;
}

/// The mesh files in a folder of the measured data whose names begin with `start`.
std::vector<std::pair<std::string, fs::path>> heads_in(const std::string& folder,
                                                       const std::string& start = "") {
  std::vector<std::pair<std::string, fs::path>> files;
  const fs::path data = fascia::test::measured_data() / "data" / folder;
  if (!fs::exists(data)) return files;
  for (const auto& entry : fs::directory_iterator(data)) {
    const std::string kind = entry.path().extension(), name = entry.path().stem();
    if (name.rfind(start, 0) == 0 && (kind == ".obj" || kind == ".glb" || kind == ".vrm" || kind == ".ply"))
      files.emplace_back(name, entry.path());
  }
  std::sort(files.begin(), files.end());
  return files;
}

void print(const Trial& trial) {
  std::printf("%-26s %-7s %-10s %3d of %2d rows %6.1f s %6.1f MB  %s\n", trial.name.c_str(),
              trial.kind.c_str(), trial.outcome.c_str(), static_cast<int>(trial.failing.size()), trial.rows,
              trial.seconds, trial.megabytes,
              (trial.reason.empty() ? joined(trial.failing) : trial.reason.substr(0, 110)).c_str());
  std::fflush(stdout);
}

void print_sums(const std::vector<Trial>& trials) {
  std::map<std::string, int> rows;
  for (const char* kind : {"wild", "people", "own"}) {
    int count = 0, built = 0, failed = 0, crashed = 0;
    for (const Trial& trial : trials) {
      if (trial.kind != kind) continue;
      ++count;
      built += trial.outcome == "built";
      crashed += trial.outcome.find("crashed") != std::string::npos;
      failed += static_cast<int>(trial.failing.size());
      for (const std::string& row : trial.failing)
        ++rows[row];
    }
    if (count > 0)
      std::printf("%s: %d of %d built, %d crashed, %.2f failed rows a built head\n", kind, built, count,
                  crashed, built > 0 ? static_cast<double>(failed) / built : 0.0);
  }
  for (const auto& [row, count] : rows)
    std::printf("  %-32s fails on %d\n", row.c_str(), count);
}

void write_csv(const fs::path& path, const std::vector<Trial>& trials) {
  std::ofstream file(path);
  file << "name,kind,outcome,failed,rows,seconds,megabytes,warnings,failing,reason\n";
  for (const Trial& t : trials) {
    std::string reason = t.reason;
    std::replace(reason.begin(), reason.end(), '"', '\'');
    file << t.name << ',' << t.kind << ',' << t.outcome << ',' << t.failing.size() << ',' << t.rows << ','
         << t.seconds << ',' << t.megabytes << ',' << t.warnings << ',' << joined(t.failing) << ",\""
         << reason << "\"\n";
  }
}

void write_json(const fs::path& path, const std::vector<Trial>& trials) {
  nlohmann::ordered_json list = nlohmann::ordered_json::array();
  for (const Trial& t : trials)
    list.push_back({{"name", t.name},
                    {"kind", t.kind},
                    {"outcome", t.outcome},
                    {"reason", t.reason},
                    {"rows", t.rows},
                    {"failing", t.failing},
                    {"seconds", t.seconds},
                    {"megabytes", t.megabytes},
                    {"warnings", t.warnings}});
  std::ofstream(path) << list.dump(2) << "\n";
}

void run(const Request& request) {
  // Several may run side by side.
  const fs::path folder = fs::temp_directory_path() / ("fascia_bench_heads." + std::to_string(getpid()));
  fs::create_directories(folder);
  if (!request.sheets.empty()) fs::create_directories(request.sheets);
  std::vector<Trial> trials;
  const auto run_all = [&](const char* kind, const std::vector<std::pair<std::string, fs::path>>& heads) {
    if (!request.kind.empty() && request.kind != kind) return;
    for (const auto& [name, file] : heads) {
      if (name.find(request.only) == std::string::npos) continue;
      const fs::path sheet = request.sheets.empty() ? fs::path() : request.sheets / (name + ".png");
      trials.push_back(fascia::bench::try_head(name, kind, file, request.detail, folder, sheet));
      print(trials.back());
    }
  };
  run_all("own", fascia::bench::write_variants(folder));
  run_all("people", heads_in("ict", "neutral"));
  run_all("people", heads_in("ict", "person_"));
  run_all("wild", heads_in("wild"));
  print_sums(trials);
  if (!request.csv.empty()) write_csv(request.csv, trials);
  if (!request.json.empty()) write_json(request.json, trials);
  fs::remove_all(folder);
}

}  // namespace

int main(int argc, char** argv) {
  Request request;
  for (int i = 1; i < argc; ++i) {
    const auto value = [&] { return i + 1 < argc ? argv[++i] : ""; };
    if (!std::strcmp(argv[i], "--reference")) return fascia::bench::print_reference() == 0 ? 0 : 1;
    if (!std::strcmp(argv[i], "--kind"))
      request.kind = value();
    else if (!std::strcmp(argv[i], "--only"))
      request.only = value();
    else if (!std::strcmp(argv[i], "--detail"))
      request.detail = value();
    else if (!std::strcmp(argv[i], "--csv"))
      request.csv = value();
    else if (!std::strcmp(argv[i], "--json"))
      request.json = value();
    else if (!std::strcmp(argv[i], "--sheets"))
      request.sheets = value();
    else {
      std::fprintf(stderr,
                   "usage: bench_heads [--kind wild|people|own] [--only TEXT] [--detail LEVEL] [--csv FILE] "
                   "[--json FILE] [--sheets "
                   "DIR] | --reference\n");
      return 2;
    }
  }
  run(request);
  return 0;
}
