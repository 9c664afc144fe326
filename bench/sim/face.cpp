// The full face in real time: what a 60 Hz frame costs on one thread with every actuator moving and contact on, beside what is
// left undone; a static pose from the frame before; set-up of the first face and of another; a crowd on one thread and on two.
//
//   bench_face RIG.glb [FRAMES]
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <thread>

#include "bench/sim/clock.h"
#include "runtime/asset.h"
#include "sim/face.h"
#include "sim/realtime/face.h"

namespace {

using namespace fascia;
using sim::Vec3f;

/// Every channel on a slow sine of its own, up to a share of its range.
struct Motion {
  const runtime::Asset& asset;
  std::vector<float> values;
  explicit Motion(const runtime::Asset& of) : asset(of), values(of.channel_names.size()) {}
  sim::Drive at(double seconds, float amplitude) {
    for (size_t c = 0; c < values.size(); ++c) {
      const auto wave = static_cast<float>(std::sin(2.0 * M_PI * (0.4 + 0.07 * static_cast<double>(c % 11)) * seconds + 2.399963 * static_cast<double>(c)));
      values[c] = wave * wave * amplitude * (wave > 0.0F ? asset.channel_maximum[c] : asset.channel_minimum[c]);
    }
    const auto value = [&](int32_t channel) { return channel < 0 ? 0.0F : values[static_cast<size_t>(channel)]; };
    const runtime::BoneChannels& bones = asset.bones();
    sim::Drive drive;
    drive.activations = values;
    drive.jaw = {value(bones.jaw_open), value(bones.jaw_forward), value(bones.jaw_lateral)};
    return drive;
  }
};

double mean_gap(const std::vector<Vec3f>& a, const std::vector<Vec3f>& b) {
  double sum = 0.0;
  for (size_t i = 0; i < a.size(); ++i) sum += static_cast<double>((a[i] - b[i]).norm());
  return sum / static_cast<double>(a.size());
}

void measure_level(const runtime::Asset& asset, size_t level, int frames) {
  double begin = bench::thread_milliseconds();
  const sim::FaceModel& reference = asset.model(level);
  const sim::realtime::Model& model = asset.realtime_model(level);
  const double first = bench::thread_milliseconds() - begin;
  const size_t channels = asset.channel_names.size(), nodes = reference.rest().size();
  begin = bench::thread_milliseconds();
  sim::realtime::Face face(model, channels);
  const double another = bench::thread_milliseconds() - begin;
  std::printf("\n%s: %zu nodes, %zu unknowns, %zu entries of the factor\n", asset.rig().tissue.levels[level].name.c_str(), nodes, model.unknowns(), model.factor_entries());
  std::printf("  first face %.1f ms, another %.2f ms and %.2f MiB\n", first, another, static_cast<double>(face.memory()) / 1048576.0);
  Motion motion(asset);
  std::vector<Vec3f> now(nodes), truth(nodes);
  for (const int iterations : {1, 2, 4}) {
    sim::realtime::StepOptions options;
    options.iterations = iterations;
    sim::realtime::Face moving(model, channels), exact(model, channels);
    sim::realtime::StepOptions converged;
    converged.iterations = 60;
    converged.tolerance = 2e-6;
    converged.checks_last = true;
    std::vector<double> times;
    double gap = 0.0, move = 0.0;
    const int compared = std::min(frames, 40);
    for (int frame = 0; frame < frames; ++frame) {
      const sim::Drive drive = motion.at(frame / 60.0, 0.2F);
      begin = bench::thread_milliseconds();
      const sim::StepResult result = moving.step(1.0 / 60.0, drive, options);
      times.push_back(bench::thread_milliseconds() - begin);
      move += result.move / frames;
      if (frame >= compared) continue;
      exact.step(1.0 / 60.0, drive, converged);
      moving.displacements(now);
      exact.displacements(truth);
      gap += mean_gap(now, truth) / compared;
    }
    std::printf("  %d iterations a substep: %.2f ms a frame; last move %.3f mm; off the converged motion by %.3f mm in the mean\n", iterations,
                bench::median(times), 1e3 * move, 1e3 * gap);
  }
  sim::PoseOptions tight;
  tight.solver.iterations = 1000;
  sim::realtime::Face posed(model, channels), goal(model, channels);
  posed.static_pose(motion.at(1.0, 0.2F), tight, now);
  goal.static_pose(motion.at(1.0 + 1.0 / 60.0, 0.2F), tight, truth);
  const sim::Drive next = motion.at(1.0 + 1.0 / 60.0, 0.2F);
  double size = 0.0;
  for (size_t i = 0; i < nodes; ++i) size += static_cast<double>((truth[i] - reference.lattice().rest[i]).norm()) / static_cast<double>(nodes);
  sim::PoseOptions warm;
  warm.from_last_pose = true;
  warm.contact_rounds = 1;
  double spent = 0.0, left = 1.0;
  int iterations = 0;
  while (left > 0.01 && iterations < 200) {  // one iteration at a time, each from the last: no corrections kept, so an upper bound
    warm.solver.iterations = 1;
    begin = bench::thread_milliseconds();
    posed.static_pose(next, warm, now);
    spent += bench::thread_milliseconds() - begin;
    ++iterations;
    left = mean_gap(now, truth) / size;
  }
  std::printf("  static pose from the frame before: %.2f %% off after %d iterations, %.1f ms\n", 100.0 * left, iterations, spent);
}

/// Milliseconds of the slowest frame's median for `count` faces on `threads` threads, wall clock.
double crowd(const runtime::Asset& asset, size_t count, size_t threads, std::vector<std::vector<Vec3f>>& end) {
  const sim::realtime::Model& model = asset.realtime_model(0);
  std::vector<sim::realtime::Face> faces;
  for (size_t i = 0; i < count; ++i) faces.emplace_back(model, asset.channel_names.size());
  sim::realtime::StepOptions options;
  options.iterations = 1;
  std::vector<double> times;
  for (int frame = 0; frame < 20; ++frame) {
    timespec begin{}, done{};
    clock_gettime(CLOCK_MONOTONIC, &begin);
    const auto work = [&](size_t first) {
      Motion motion(asset);
      for (size_t i = first; i < count; i += threads) faces[i].step(1.0 / 60.0, motion.at(frame / 60.0 + static_cast<double>(i), 0.2F), options);
    };
    std::vector<std::thread> others;
    for (size_t t = 1; t < threads; ++t) others.emplace_back(work, t);
    work(0);
    for (std::thread& other : others) other.join();
    clock_gettime(CLOCK_MONOTONIC, &done);
    times.push_back(1e3 * static_cast<double>(done.tv_sec - begin.tv_sec) + 1e-6 * static_cast<double>(done.tv_nsec - begin.tv_nsec));
  }
  for (const auto& face : faces) face.displacements(end.emplace_back(model.face().rest().size()));
  return bench::median(times);
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 2) {
    std::fprintf(stderr, "usage: bench_face RIG.glb [FRAMES]\n");
    return 2;
  }
  std::ifstream file(argv[1], std::ios::binary);
  const std::vector<char> bytes((std::istreambuf_iterator<char>(file)), {});
  try {
    const runtime::Asset asset(std::span(reinterpret_cast<const uint8_t*>(bytes.data()), bytes.size()));
    const int frames = argc > 2 ? std::max(2, std::atoi(argv[2])) : 240;
    for (size_t level = 0; level < asset.rig().tissue.levels.size(); ++level) measure_level(asset, level, frames);
    std::vector<std::vector<Vec3f>> one, two;
    const double alone = crowd(asset, 100, 1, one), together = crowd(asset, 100, 2, two);
    std::printf("\n100 faces at the coarsest level, wall clock a frame: %.0f ms on one thread, %.0f ms on two; %s\n", alone, together,
                one == two ? "the same bits" : "NOT the same bits");
  } catch (const std::exception& error) {
    std::fprintf(stderr, "bench_face: %s\n", error.what());
    return 1;
  }
  return 0;
}
