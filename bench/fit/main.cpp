// What fitting makes of known expressions, on heads that carry their own ARKit shapes: people of ICT-FaceKit
// and avatars of other makers (data/wild). For each shape, the share explained of the face's motion, 1 -
// sum|u-v|^2 / sum|v|^2, by the expression's own row, by bounded activations of the linear response at rest,
// and by `fit` on the full simulation; means by head.
//
//   bench_fit [HEAD|FAMILY]... [--level NAME] [--only SHAPE,...] [--calibrate] [--random POSES] [--scans]
//             [--parts N] [--ridge PRICE] [--sparsity PRICE]
//
// --parts fits each of N parts of a head's shapes with muscles and tissue that were calibrated by the others.
// --random finds that many random poses of each head's own again instead (`embedded` is a head too),
// --scans its own ARKit expressions from scans of another meshing.
// --calibrate also finds each head's own muscles from its shapes, and judges them by shapes left out; then
// the same of the head with muscles of known other strengths.
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <set>

#include "bench/expressions/score.h"
#include "bench/expressions/sculpted_head.h"
#include "bench/fit/calibrated.h"
#include "bench/fit/round_trip.h"
#include "bench/fit/scans.h"
#include "bench/people/arguments.h"
#include "fit/fit.h"
#include "geometry/error.h"

namespace fascia::bench {
namespace {

struct FitRequest {
  std::vector<std::string> heads;
  std::set<std::string> only;
  std::string level = "low";
  bool calibrate = false;
  int random = 0, parts = 0;
  bool scans = false;
  fit::FitOptions fitting;
};

double seconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

/// The share that bounded activations would explain if the face moved as it does at first from rest.
double linear_share(KnownFace& face, fit::Fitter& fitter, const fit::Target& target) {
  std::vector<float> rest;
  for (const rig::Channel& channel : face.subject().channels())
    rest.push_back(channel.rest);
  const fit::Linearised at = fitter.linearised(target, rest);
  Eigen::VectorXd moved = Eigen::VectorXd::Zero(at.slope.size()), pull = at.slope;
  for (int sweep = 0; sweep < 500; ++sweep) {
    double largest = 0.0;
    for (Eigen::Index i = 0; i < moved.size(); ++i) {
      const rig::Channel& channel = face.subject().channels()[at.channels[static_cast<size_t>(i)]];
      if (!(at.hessian(i, i) > 1e-12)) continue;
      const double next = std::clamp(moved[i] - pull[i] / at.hessian(i, i),
                                     static_cast<double>(channel.minimum - channel.rest),
                                     static_cast<double>(channel.maximum - channel.rest));
      pull += (next - moved[i]) * at.hessian.col(i);
      largest = std::max(largest, std::abs(next - moved[i]));
      moved[i] = next;
    }
    if (largest < 1e-6) break;
  }
  const double left = at.mean_square + 2.0 * at.slope.dot(moved) + moved.dot(at.hessian * moved);
  return 1.0 - left / at.target_square;
}

void fit_head(const SculptedHead& head, const FitRequest& request) {
  KnownFace face(head, request.level);
  const anatomy::ExpressionSet table = *anatomy::load_generic().expression_set("arkit");
  std::vector<Vec3> rest;
  for (const size_t v : face.face())
    rest.push_back(face.subject().rest().segment<3>(static_cast<Eigen::Index>(3 * v)));
  fit::Fitter fitter(face.subject(), request.fitting);
  double by_row = 0.0, linear = 0.0, by_fit = 0.0, error = 0.0, seconds = 0.0;
  int count = 0, iterations = 0;
  for (const auto& [name, shape] : face.shapes()) {
    if (!request.only.empty() && !request.only.contains(name)) continue;
    const double row =
        score(rest, face.triangles(), face.pose(face.activations(table, shape.values)), shape.truth)
            .explained;
    const fit::Target target = target_of(face, shape.truth);
    const double bounded = linear_share(face, fitter, target);
    const auto start = std::chrono::steady_clock::now();
    const fit::FitResult result = fitter.fit(target);
    const double took = seconds_since(start);
    const Score found = score(rest, face.triangles(), face.face_rows(result.displacements), shape.truth);
    std::printf("%-16s %-20s row %6.3f linear %6.3f fit %6.3f %5.2f mm %3d steps %5.2f s%s\n",
                head.name.c_str(), name.c_str(), row, bounded, found.explained, found.error_mm,
                result.iterations, took, result.converged ? "" : " (not converged)");
    by_row += row;
    linear += bounded;
    by_fit += found.explained;
    error += found.error_mm;
    seconds += took;
    iterations += result.iterations;
    ++count;
  }
  if (count == 0) return;
  std::printf("%-16s mean of %d shapes: row %.3f, linear %.3f, fit %.3f, %.2f mm; %d steps, %.1f s\n",
              head.name.c_str(), count, by_row / count, linear / count, by_fit / count, error / count,
              iterations, seconds);
  if (request.calibrate) calibrate_head(face, table);
  if (request.parts > 1) fit_calibrated_head(face, table, request.parts, request.fitting);
}

void run(const FitRequest& request) {
  bool any = false;
  std::vector<SculptedHead> heads = sculpted_heads();
  if (request.random > 0 || request.scans) heads.push_back(generic_head());
  for (const SculptedHead& head : heads) {
    const auto is_named = [&](const std::string& name) {
      return std::find(request.heads.begin(), request.heads.end(), name) != request.heads.end();
    };
    if (!request.heads.empty() && !is_named(head.name) && !is_named(head.family)) continue;
    any = true;
    try {
      if (request.scans)
        find_scans(head, request.level, request.only, request.fitting);
      else if (request.random > 0)
        find_random_poses(head, request.level, request.random, request.fitting);
      else
        fit_head(head, request);
    } catch (const Error& error) {
      std::printf("%-16s %s\n", head.name.c_str(), error.what());
    }
    std::fflush(stdout);
  }
  if (!any) std::printf("skipped: the measured data hold no heads with shapes of their own of that name\n");
}

}  // namespace
}  // namespace fascia::bench

int main(int argc, char** argv) {
  fascia::bench::FitRequest request;
  fascia::bench::Arguments arguments("bench_fit", "[HEAD|FAMILY]...");
  arguments.option("--level", "NAME", request.level);
  arguments.option("--only", "SHAPE,...", request.only);
  arguments.flag("--calibrate", request.calibrate);
  arguments.option("--parts", "N", request.parts);
  arguments.option("--random", "POSES", request.random);
  arguments.flag("--scans", request.scans);
  arguments.option("--ridge", "PRICE", request.fitting.ridge);
  arguments.option("--sparsity", "PRICE", request.fitting.sparsity);
  if (!arguments.parse(argc, argv, request.heads)) return 2;
  try {
    fascia::bench::run(request);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "bench_fit: %s\n", error.what());
    return 1;
  }
  return 0;
}
