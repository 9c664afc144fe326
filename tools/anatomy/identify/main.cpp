// Fits what the anatomy cannot be measured for to heads whose own expressions are known.
//
//   identify tables TABLE.json [--heads NAME,...] [--only SHAPE,...] [--actuators FILE] [--level low]
//   [--reach R]
//                   [-o FILE]
//
//   identify tissue TABLE.json [--heads NAME,...] [--only SHAPE,...] [--actuators FILE] [--data DIR] -o
//   MECHANICS.json
//
//   identify responses anatomy/data/expressions [--heads NAME,...] [--level low] [--threads N]
//
// `tables` fits the rows of the ARKit table on several heads of several makers together and writes it;
// `--left` looks at one side of one-sided shapes alone. `tissue` makes a step of Gauss and Newton on the
// tissue's constants. `responses` finds for each row of every table what share of it to play at a weight, so
// that the face shows that weight of the shape; "embedded" is the generic head itself.
#include <chrono>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <iostream>
#include <nlohmann/json.hpp>
#include <set>

#include "geometry/error.h"
#include "tools/anatomy/identify/responses.h"
#include "tools/anatomy/identify/table_file.h"
#include "tools/anatomy/identify/tables.h"
#include "tools/anatomy/identify/tissue.h"

namespace fascia::identify {
namespace {

struct Request {
  std::string table, output, level = "low", actuators = "anatomy/figures/expression_actuators.json";
  std::set<std::string> heads = {"neutral", "person_3", "asian_business", "rpm_avatar", "facecap_plain"},
                        only;
  bool has_heads = false;
  double reach = 1.0;
  ResponseOptions responses;
  TableOptions options;
  TissueOptions tissue;
};

std::set<std::string> list_of(const std::string& text) {
  std::set<std::string> names;
  std::string name;
  for (const char c : text + ",")
    if (c != ',')
      name += c;
    else if (!name.empty()) {
      names.insert(name);
      name.clear();
    }
  return names;
}

Json sorted(const Weights& weights) {
  std::vector<std::pair<std::string, double>> list(weights.begin(), weights.end());
  std::stable_sort(list.begin(), list.end(),
                   [](const auto& a, const auto& b) { return std::abs(a.second) > std::abs(b.second); });
  Json out = Json::object();
  for (const auto& [name, value] : list)
    out[name] = std::round(1000.0 * value) / 1000.0;
  return out;
}

/// The heads asked for, and how much each counts: families alike.
std::vector<std::pair<bench::SculptedHead, double>> heads_of(const Request& request) {
  std::map<std::string, int> families;
  std::vector<std::pair<bench::SculptedHead, double>> heads;
  for (const bench::SculptedHead& head : bench::sculpted_heads())
    if (request.heads.contains(head.name)) {
      heads.emplace_back(head, 0.0);
      ++families[head.family];
    }
  for (auto& [head, weight] : heads)
    weight = 1.0 / families[head.family];
  if (heads.empty()) throw Error("none of these heads has shapes of its own in the measured data");
  return heads;
}

std::vector<ShapeEntry> entries_of(const Request& request) {
  std::vector<ShapeEntry> entries = read_entries(request.actuators);
  if (!request.only.empty())
    std::erase_if(entries, [&](const ShapeEntry& entry) { return !request.only.contains(entry.shape); });
  return entries;
}

void fit_tissue(const Request& request) {
  const Json table = read_table(request.table);
  std::map<std::string, Weights> rows;
  for (const Json& row : table["expressions"])
    rows[row["name"]] = row["weights"].get<Weights>();
  std::vector<bench::SculptedHead> heads;
  std::vector<double> weights;
  for (const auto& [head, weight] : heads_of(request)) {
    heads.push_back(head);
    weights.push_back(weight);
  }
  identify_tissue(entries_of(request), rows, heads, weights, request.tissue, request.output);
}

/// The generic head too, which has no shapes of its own and needs none here.
void fit_responses(const Request& request) {
  const std::set<std::string> wanted =
      request.has_heads ? request.heads : std::set<std::string>{"neutral", "rpm_avatar", "embedded"};
  std::vector<bench::SculptedHead> heads;
  for (const bench::SculptedHead& head : bench::sculpted_heads())
    if (wanted.contains(head.name)) heads.push_back(head);
  const std::filesystem::path folder = request.table;
  if (wanted.contains("embedded")) heads.push_back(bench::generic_head());
  if (heads.empty()) throw Error("none of these heads lies in the measured data");
  identify_responses(folder, heads, request.level, request.responses);
}

void fit_tables(const Request& request) {
  Json table = read_table(request.table);
  const auto row_of = [&](const std::string& name) -> Json& {
    for (Json& row : table["expressions"])
      if (row["name"] == name) return row;
    throw Error("the table has no row '" + name + "'");
  };
  std::vector<FittedHead> heads;
  for (const auto& [head, weight] : heads_of(request)) {
    heads.emplace_back(head, request.level);
    heads.back().weight = weight;
  }
  double sum = 0.0;
  int count = 0;
  for (const ShapeEntry& entry : entries_of(request)) {
    const auto started = std::chrono::steady_clock::now();
    const Weights base =
        entry.corrects.empty() ? Weights() : row_of(entry.corrects)["weights"].get<Weights>();
    const FittedRow row = fit_row(entry, base, row_of(entry.name())["weights"].get<Weights>(), heads,
                                  request.options, request.reach);
    if (row.shares.empty()) continue;
    row_of(entry.name())["weights"] = sorted(row.weights);
    if (!entry.mirror().empty()) row_of(entry.mirror())["weights"] = sorted(mirrored(row.weights));
    sum += row.share;
    ++count;
    std::printf("%-18s %6.3f [", entry.name().c_str(), row.share);
    for (const double share : row.shares)
      std::printf(" %.2f", share);
    std::printf(" ] %.0f s ",
                std::chrono::duration<double>(std::chrono::steady_clock::now() - started).count());
    const Json found = sorted(row.weights);
    for (const auto& [name, value] : found.items())
      if (name.find("_right") == std::string::npos ||
          !row.weights.contains(name.substr(0, name.size() - 5) + "left"))
        std::printf(" %s %.2f", name.c_str(), value.get<double>());
    std::printf("\n");
    std::fflush(stdout);
    write_table(request.output.empty() ? request.table : request.output, table);
  }
  std::printf("mean of %d: %.3f\n", count, sum / std::max(1, count));
}

}  // namespace
}  // namespace fascia::identify

int main(int argc, char** argv) {
  fascia::identify::Request request;
  std::string command;
  for (int i = 1; i < argc; ++i) {
    const std::string word = argv[i];
    const auto value = [&]() -> std::string { return i + 1 < argc ? argv[++i] : ""; };
    if (word == "--heads")
      request.heads = fascia::identify::list_of(value()), request.has_heads = true;
    else if (word == "--threads")
      request.responses.threads = std::stoi(value());
    else if (word == "--only")
      request.only = fascia::identify::list_of(value());
    else if (word == "--level")
      request.level = value();
    else if (word == "--actuators")
      request.actuators = value();
    else if (word == "--reach")
      request.reach = std::stod(value());
    else if (word == "--left")
      request.options.both_sides = false;
    else if (word == "--data")
      request.tissue.data = value();
    else if (word == "-o")
      request.output = value();
    else if (command.empty())
      command = word;
    else
      request.table = word;
  }
  try {
    if ((command != "tables" && command != "tissue" && command != "responses") || request.table.empty() ||
        (command == "tissue" && request.output.empty())) {
      std::fprintf(stderr,
                   "usage: identify tables|tissue TABLE.json|responses FOLDER [--heads NAME,...] [--only "
                   "SHAPE,...] [--actuators FILE] "
                   "[--level NAME] [--reach R] [--left] [--data DIR] [-o FILE]\n");
      return 2;
    }
    if (command == "tables")
      fascia::identify::fit_tables(request);
    else if (command == "responses")
      fascia::identify::fit_responses(request);
    else
      fascia::identify::fit_tissue(request);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "identify: %s\n", error.what());
    return 1;
  }
  return 0;
}
