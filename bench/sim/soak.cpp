// Minutes of random drive on a whole head: does anything become not a number, does the watchdog put the face
// back, does a prism turn inside out, and does it turn back?
//
//   bench_soak RIG.glb [--level INDEX] [--seconds S] [--solver own|reference] [--iterations N] [--pull
//   NEWTON] [--shake M/S2] [--seed N] [--rates]
//
// Every quarter of a second all channels jump to other values; `--pull` presses a finger on a node of skin
// chosen anew with each jump, `--shake` moves the head. `--rates` compares frame rates and iterations
// instead.
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <iterator>

#include "bench/sim/clock.h"
#include "sim/reference_solver.h"
#include "tests/builder/played.h"
#include "tests/builder/swept_face.h"

namespace {

using namespace fascia;

struct Request {
  const char* rig = nullptr;
  size_t level = 0;
  double seconds = 600.0, pull = 0.0, shake = 0.0;
  int iterations = 2;
  unsigned seed = 1;
  bool is_reference = false, is_named = false, compares_rates = false;
};

/// What a soak has seen.
struct Tally {
  int frames = 0, resets = 0, not_finite = 0, frames_turned = 0, most_turned = 0;
  double farthest = 0.0, milliseconds = 0.0;
  std::vector<int> turned_by_prism, run, longest_run;
};

void look(const sim::FaceModel& model, const std::vector<sim::Vec3f>& moved, Tally& tally) {
  const auto& prisms = model.prisms();
  tally.turned_by_prism.resize(prisms.size());
  tally.run.resize(prisms.size());
  tally.longest_run.resize(prisms.size());
  std::vector<Vec3> now(moved.size());
  bool is_finite = true;
  for (size_t i = 0; i < moved.size(); ++i) {
    is_finite = is_finite && moved[i].allFinite();
    now[i] = model.rest()[i] + moved[i].cast<double>();
    tally.farthest = std::max<double>(tally.farthest, moved[i].norm());
  }
  ++tally.frames;
  if (!is_finite) {
    ++tally.not_finite;
    return;
  }
  int turned = 0;
  for (size_t p = 0; p < prisms.size(); ++p) {
    const bool is_turned = !(sim::prism_volume(prisms[p].nodes, now.data()) > 0.0);
    tally.run[p] = is_turned ? tally.run[p] + 1 : 0;
    tally.longest_run[p] = std::max(tally.longest_run[p], tally.run[p]);
    tally.turned_by_prism[p] += is_turned;
    turned += is_turned;
  }
  tally.frames_turned += turned > 0;
  tally.most_turned = std::max(tally.most_turned, turned);
}

void print(const sim::FaceModel& model, const Tally& tally, bool is_named) {
  const int longest = *std::max_element(tally.longest_run.begin(), tally.longest_run.end());
  std::printf(
      "%d frames: %d not finite, %d resets, farthest node %.1f mm; prisms turned in %d frames, %d of %zu at "
      "once, the longest for %d frames; %.2f ms a frame\n",
      tally.frames, tally.not_finite, tally.resets, 1e3 * tally.farthest, tally.frames_turned,
      tally.most_turned, model.prisms().size(), longest, tally.milliseconds / std::max(1, tally.frames));
  std::vector<size_t> order(tally.turned_by_prism.size());
  for (size_t p = 0; p < order.size(); ++p)
    order[p] = p;
  std::sort(order.begin(), order.end(),
            [&](size_t a, size_t b) { return tally.turned_by_prism[a] > tally.turned_by_prism[b]; });
  for (size_t k = 0;
       is_named && k < std::min<size_t>(12, order.size()) && tally.turned_by_prism[order[k]] > 0; ++k) {
    const sim::Prism& prism = model.prisms()[order[k]];
    const Vec3 at = 1e3 * model.rest()[prism.nodes[0]];
    std::printf("  prism %zu (%s) at %.1f %.1f %.1f mm, volume %.2f mm3: %d frames\n", order[k],
                prism.nodes[0] < model.lattice().columns ? "outer" : "inner", at.x(), at.y(), at.z(),
                1e9 * prism.volume, tally.turned_by_prism[order[k]]);
  }
}

template <class Face, class Options>
Tally soak(Face& face, const Options& options, const Request& request, testing::SweptFace& drives) {
  const sim::FaceModel& model = drives.model();
  std::mt19937 random(request.seed);
  const auto chance = [&] { return static_cast<double>(random() % 20001U) / 1e4 - 1.0; };
  Tally tally;
  std::vector<sim::Vec3f> moved(model.rest().size());
  sim::NodeForce touch;
  const int frames = static_cast<int>(60.0 * request.seconds);
  for (int frame = 0; frame < frames; ++frame) {
    if (frame % 15 == 0) {
      drives.draw(random);
      touch = {static_cast<uint32_t>(random() % model.lattice().columns),
               request.pull * sim::Vec3(chance(), chance(), chance()).normalized()};
      drives.add_force(request.shake * sim::Vec3(chance(), chance(), chance()));
    }
    if (request.pull > 0.0) drives.touch(std::span(&touch, 1));
    drives.pass(1.0 / 60.0);
    const double begin = bench::thread_milliseconds();
    const sim::StepResult result = face.step(1.0 / 60.0, drives.drive(), options);
    tally.milliseconds += bench::thread_milliseconds() - begin;
    tally.resets += result.status == sim::StepStatus::reset;
    face.displacements(moved);
    look(model, moved, tally);
  }
  return tally;
}

/// The same two seconds at other frame rates and with other numbers of iterations, beside 60 Hz converged.
void compare_rates(const runtime::Asset& asset, size_t level) {
  sim::realtime::StepOptions options;
  const auto row = [](const char* name, int number, const testing::Apart& apart) {
    std::printf("%4d %s: %.2f %% of the motion off, at most %.2f mm\n", number, name, 100.0 * apart.share,
                1e3 * apart.most);
  };
  options.iterations = 60;
  options.tolerance = 1e-6;
  options.checks_last = true;
  const auto truth = testing::played(asset, level, 60, options);
  for (const int rate : {30, 120})
    row("Hz, converged", rate, testing::apart(testing::played(asset, level, rate, options), truth));
  const auto usual = testing::played(asset, level, 60, {});
  for (const int rate : {30, 120})
    row("Hz, two iterations, beside 60 Hz alike", rate,
        testing::apart(testing::played(asset, level, rate, {}), usual));
  for (const int iterations : {1, 2, 4, 8, 16}) {
    sim::realtime::StepOptions few;
    few.iterations = iterations;
    row("iterations a substep, 60 Hz", iterations,
        testing::apart(testing::played(asset, level, 60, few), truth));
  }
}

}  // namespace

int main(int argc, char** argv) {
  Request request;
  for (int i = 1; i < argc; ++i) {
    const auto value = [&] { return i + 1 < argc ? argv[++i] : "0"; };
    if (!std::strcmp(argv[i], "--level"))
      request.level = static_cast<size_t>(std::atoi(value()));
    else if (!std::strcmp(argv[i], "--seconds"))
      request.seconds = std::atof(value());
    else if (!std::strcmp(argv[i], "--solver"))
      request.is_reference = !std::strcmp(value(), "reference");
    else if (!std::strcmp(argv[i], "--iterations"))
      request.iterations = std::atoi(value());
    else if (!std::strcmp(argv[i], "--pull"))
      request.pull = std::atof(value());
    else if (!std::strcmp(argv[i], "--shake"))
      request.shake = std::atof(value());
    else if (!std::strcmp(argv[i], "--seed"))
      request.seed = static_cast<unsigned>(std::atoi(value()));
    else if (!std::strcmp(argv[i], "--names"))
      request.is_named = true;
    else if (!std::strcmp(argv[i], "--rates"))
      request.compares_rates = true;
    else
      request.rig = argv[i];
  }
  if (request.rig == nullptr) {
    std::fprintf(stderr,
                 "usage: bench_soak RIG.glb [--level INDEX] [--seconds S] [--solver own|reference] "
                 "[--iterations N] [--pull NEWTON] [--shake M/S2] [--seed N] [--names] [--rates]\n");
    return 2;
  }
  std::ifstream file(request.rig, std::ios::binary);
  const std::vector<char> bytes((std::istreambuf_iterator<char>(file)), {});
  try {
    const auto asset = std::make_shared<const runtime::Asset>(
        std::span(reinterpret_cast<const uint8_t*>(bytes.data()), bytes.size()));
    if (request.level >= asset->rig().tissue.levels.size())
      throw std::runtime_error("the rig has no such level");
    if (request.compares_rates) {
      compare_rates(*asset, request.level);
      return 0;
    }
    testing::SweptFace drives(asset, request.level);
    const size_t channels = asset->channel_names.size();
    if (request.is_reference) {
      sim::ReferenceSolver face(asset->model(request.level), channels);
      print(drives.model(), soak(face, sim::StepOptions{}, request, drives), request.is_named);
    } else {
      sim::realtime::Solver face(asset->realtime_model(request.level), channels);
      sim::realtime::StepOptions options;
      options.iterations = request.iterations;
      print(drives.model(), soak(face, options, request, drives), request.is_named);
    }
  } catch (const std::exception& error) {
    std::fprintf(stderr, "bench_soak: %s\n", error.what());
    return 1;
  }
  return 0;
}
