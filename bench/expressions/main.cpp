// How much of known expressions the simulated ones explain, on heads that carry their own ARKit shapes:
// people of ICT-FaceKit and avatars of other makers (data/wild). For each shape, the share explained of the
// face's motion, 1 - sum|u-v|^2 / sum|v|^2, the mean error over what moves more than 0.5 mm, and what tells a
// wrong amplitude from a wrong direction: the factor that would serve best and the share at it; means by
// family.
//
//   bench_expressions [HEAD|FAMILY]... [--level NAME] [--table FILE.json] [--only SHAPE,...] [--csv FILE]
//                     [--sheet PREFIX] [--threads N] [--anatomy DIR]
//   bench_expressions --remeshed PERSON... [--level NAME]
//   bench_expressions --response [HEAD|FAMILY]... [--level NAME] [--table FILE.json] [--threads N]
//
// Rigs are built by the tool as a user would, landmarks found, and kept in the temporary folder until the
// tool or the head changes; --table plays another table on them, --anatomy builds them from other data
// (files of DIR instead of those of their name in anatomy/data), which are not kept. Doing nothing scores 0
// and some 3 mm, a half-amplitude copy 0.75. mouthClose is scored as jawOpen + mouthClose. Heads of one
// family share one sculpted set.
#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <nlohmann/json.hpp>
#include <set>
#include <thread>

#include "bench/expressions/copies.h"
#include "bench/expressions/response.h"
#include "bench/expressions/score.h"
#include "bench/expressions/sculpted_head.h"
#include "bench/expressions/sheet.h"
#include "bench/people/arguments.h"
#include "geometry/error.h"

namespace fascia::bench {
namespace {

struct Request {
  std::vector<std::string> heads;
  std::set<std::string> only;
  std::string level = "low", table, csv, sheet, anatomy;
  int threads = 2;
  bool remeshed = false, response = false;
};

/// Scores of one head by shape; or why there are none.
struct HeadScores {
  SculptedHead head;
  std::map<std::string, Score> shapes;
  std::string failure;
};

anatomy::ExpressionSet table_of(const std::string& path) {
  anatomy::ExpressionSet table = *anatomy::load_generic().expression_set("arkit");
  if (path.empty()) return table;
  std::ifstream file(path);
  table.expressions.clear();
  const nlohmann::json played = nlohmann::json::parse(file);
  table.response_weights = played.value("response_weights", std::vector<double>());
  for (const auto& entry : played["expressions"]) {
    anatomy::Expression row;
    row.name = entry["name"];
    for (const auto& [actuator, weight] : entry["weights"].items())
      row.weights.emplace_back(actuator, weight.get<double>());
    row.response = entry.value("response", std::vector<double>());
    table.expressions.push_back(std::move(row));
  }
  return table;
}

HeadScores scores_of(const SculptedHead& head, const anatomy::ExpressionSet& table, const Request& request) {
  HeadScores result{head, {}, {}};
  try {
    KnownFace face(head, request.level);
    std::vector<Vec3> rest;
    for (const size_t v : face.face())
      rest.push_back(face.subject().rest().segment<3>(static_cast<Eigen::Index>(3 * v)));
    std::unique_ptr<Sheet> sheet;
    if (!request.sheet.empty()) sheet = std::make_unique<Sheet>();
    for (const auto& [name, shape] : face.shapes()) {
      if (table.find(name) == nullptr || (!request.only.empty() && !request.only.contains(name))) continue;
      const Eigen::VectorXd simulated = face.pose(face.activations(table, shape.values));
      result.shapes[name] = score(rest, face.triangles(), simulated, shape.truth);
      if (sheet) sheet->add(name, rest, face.triangles(), simulated, shape.truth, result.shapes[name]);
    }
    if (sheet) sheet->write(request.sheet + head.name + ".png");
  } catch (const std::exception& error) {
    result.failure = error.what();
  }
  return result;
}

std::string mirrored(const std::string& shape) {
  if (shape.ends_with("Left")) return shape.substr(0, shape.size() - 4) + "Right";
  return "";
}

struct Mean {
  double sum = 0.0;
  int count = 0;
  void add(double value) {
    sum += value;
    ++count;
  }
  double value() const { return count > 0 ? sum / count : 0.0; }
};

/// One row a shape, three columns a family: share, best factor, share at it.
void print_shapes(const std::vector<HeadScores>& heads) {
  std::vector<std::string> families;
  std::set<std::string> shapes;
  for (const HeadScores& head : heads) {
    if (!head.shapes.empty() &&
        std::find(families.begin(), families.end(), head.head.family) == families.end())
      families.push_back(head.head.family);
    for (const auto& [shape, score] : head.shapes)
      shapes.insert(shape);
  }
  std::printf("%-20s", "share, factor, at it");
  for (const std::string& family : families)
    std::printf(" | %21s", family.c_str());
  std::printf("\n");
  for (const std::string& shape : shapes) {
    std::printf("%-20s", shape.c_str());
    for (const std::string& family : families) {
      Mean share, factor, best;
      for (const HeadScores& head : heads) {
        const auto found = head.shapes.find(shape);
        if (head.head.family != family || found == head.shapes.end()) continue;
        share.add(found->second.explained);
        factor.add(found->second.best_scale);
        best.add(found->second.at_best_scale);
      }
      std::printf(" | %7.3f %6.2f %6.3f", share.value(), factor.value(), best.value());
    }
    std::printf("\n");
  }
}

void print_heads(const std::vector<HeadScores>& heads) {
  std::printf("\n%-16s %-8s %7s %7s %7s %8s %7s %9s %9s  %s\n", "head", "family", "share", "at best", "least",
              "no gaze", "mm", "left-right", "turned", "below 0");
  for (const HeadScores& head : heads) {
    if (!head.failure.empty()) {
      std::printf("%-16s %-8s %s\n", head.head.name.c_str(), head.head.family.c_str(), head.failure.c_str());
      continue;
    }
    Mean share, best, error, apart, no_gaze;
    double least = 1.0;
    int turned = 0;
    std::string below;
    for (const auto& [shape, score] : head.shapes) {
      share.add(score.explained);
      best.add(score.at_best_scale);
      error.add(score.error_mm);
      if (shape.rfind("eyeLook", 0) != 0) no_gaze.add(score.explained);
      turned += score.turned;
      least = std::min(least, score.explained);
      if (score.explained < 0.0) below += " " + shape;
      if (const auto other = head.shapes.find(mirrored(shape)); other != head.shapes.end())
        apart.add(std::abs(score.explained - other->second.explained));
    }
    std::printf("%-16s %-8s %7.3f %7.3f %7.2f %8.3f %7.2f %9.3f %9d %s\n", head.head.name.c_str(),
                head.head.family.c_str(), share.value(), best.value(), least, no_gaze.value(), error.value(),
                apart.value(), turned, below.c_str());
  }
}

void write_csv(const std::string& path, const std::vector<HeadScores>& heads) {
  std::ofstream file(path);
  file << "head,family,shape,explained,error_mm,best_scale,at_best_scale,turned\n";
  for (const HeadScores& head : heads)
    for (const auto& [shape, s] : head.shapes)
      file << head.head.name << ',' << head.head.family << ',' << shape << ',' << s.explained << ','
           << s.error_mm << ',' << s.best_scale << ',' << s.at_best_scale << ',' << s.turned << '\n';
}

void run(const Request& request) {
  std::vector<SculptedHead> heads;
  for (const SculptedHead& head : sculpted_heads())
    if (request.heads.empty() ||
        std::find(request.heads.begin(), request.heads.end(), head.name) != request.heads.end() ||
        std::find(request.heads.begin(), request.heads.end(), head.family) != request.heads.end())
      heads.push_back(head);
  for (SculptedHead& head : heads)
    head.anatomy = request.anatomy;
  if (heads.empty()) {
    std::printf("skipped: the measured data hold no heads with shapes of their own of that name\n");
    return;
  }
  const anatomy::ExpressionSet table = table_of(request.table);
  if (request.response) {
    run_response(heads, table, request.level, request.threads);
    return;
  }
  std::vector<HeadScores> scores(heads.size());
  std::atomic<size_t> next = 0;
  const auto work = [&] {
    for (size_t h = next++; h < heads.size(); h = next++)
      scores[h] = scores_of(heads[h], table, request);
  };
  std::vector<std::thread> threads;
  for (int i = 1; i < (request.sheet.empty() ? request.threads : 1); ++i)  // one display
    threads.emplace_back(work);
  work();
  for (std::thread& thread : threads)
    thread.join();
  print_shapes(scores);
  print_heads(scores);
  if (!request.csv.empty()) write_csv(request.csv, scores);
}

}  // namespace
}  // namespace fascia::bench

int main(int argc, char** argv) {
  fascia::bench::Request request;
  fascia::bench::Arguments arguments("bench_expressions", "[HEAD|FAMILY]...");
  arguments.option("--level", "NAME", request.level);
  arguments.option("--table", "FILE.json", request.table);
  arguments.option("--only", "SHAPE,...", request.only);
  arguments.option("--csv", "FILE", request.csv);
  arguments.option("--sheet", "PREFIX", request.sheet);
  arguments.option("--threads", "N", request.threads);
  arguments.option("--anatomy", "DIR", request.anatomy);
  arguments.flag("--remeshed", request.remeshed);
  arguments.flag("--response", request.response);
  if (!arguments.parse(argc, argv, request.heads)) return 2;
  try {
    if (request.remeshed)
      for (const std::string& person : request.heads)
        fascia::bench::run_copies(person, request.level);
    else
      fascia::bench::run(request);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "bench_expressions: %s\n", error.what());
    return 1;
  }
  return 0;
}
