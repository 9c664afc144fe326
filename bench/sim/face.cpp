// The full face in real time: what a 60 Hz frame costs on one thread with every actuator moving and contact
// on, beside what is left undone; a static pose from the frame before; set-up of the first face and of
// another; a crowd on one thread and on two.
//
//   bench_face RIG.glb [FRAMES]
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <stdexcept>
#include <thread>

#include "bench/sim/clock.h"
#include "fascia/fascia.h"
#include "runtime/asset.h"
#include "sim/realtime/solver.h"
#include "sim/reference_solver.h"

namespace {

using namespace fascia;
using sim::Vec3f;

/// Every channel on a slow sine of its own, up to a share of its range.
struct Motion {
  const runtime::Asset& asset;
  std::vector<float> values;
  explicit Motion(const runtime::Asset& of) : asset(of), values(of.channel_names.size()) {}
  sim::Controls at(double seconds, float amplitude) {
    for (size_t c = 0; c < values.size(); ++c) {
      const auto wave =
          static_cast<float>(std::sin(2.0 * M_PI * (0.4 + 0.07 * static_cast<double>(c % 11)) * seconds +
                                      2.399963 * static_cast<double>(c)));
      values[c] =
          wave * wave * amplitude * (wave > 0.0F ? asset.channel_maximum[c] : asset.channel_minimum[c]);
    }
    const auto value = [&](int32_t channel) {
      return channel < 0 ? 0.0F : values[static_cast<size_t>(channel)];
    };
    const runtime::BoneChannels& bones = asset.bones();
    sim::Controls drive;
    drive.activations = values;
    drive.jaw = {value(bones.jaw_open), value(bones.jaw_forward), value(bones.jaw_lateral)};
    return drive;
  }
};

double mean_gap(const std::vector<Vec3f>& a, const std::vector<Vec3f>& b) {
  double sum = 0.0;
  for (size_t i = 0; i < a.size(); ++i)
    sum += static_cast<double>((a[i] - b[i]).norm());
  return sum / static_cast<double>(a.size());
}

/// Static poses of a moving face, each from the frame before: the fewest iterations that come within 1 % of
/// the converged one.
void measure_static_poses(const sim::FaceModel& reference, const sim::realtime::Model& model, size_t channels,
                          Motion& motion) {
  const size_t nodes = reference.rest().size();
  std::vector<Vec3f> now(nodes), truth(nodes);
  sim::PoseOptions tight, warm;
  tight.solver.iterations = 800;
  warm.from_last_pose = true;
  warm.contact_rounds = 1;
  warm.newton.iterations = 0;
  warm.solver.iterations = 0;
  std::vector<double> times, counts;
  for (int second = 1; second <= 9; ++second) {
    sim::realtime::Solver posed(model, channels), goal(model, channels);
    posed.static_pose(motion.at(second, 0.2F), tight, now);
    const sim::Controls next = motion.at(second + 1.0 / 60.0, 0.2F);
    goal.static_pose(next, tight, truth);
    double size = 0.0, spent = 0.0;
    for (size_t i = 0; i < nodes; ++i)
      size +=
          static_cast<double>((truth[i] - reference.lattice().rest[i]).norm()) / static_cast<double>(nodes);
    for (double left = 1.0; left > 0.01 && warm.solver.iterations < 400;) {
      ++warm.solver.iterations;
      sim::realtime::Solver trial = posed;
      const double begin = bench::thread_milliseconds();
      trial.static_pose(next, warm, now);
      spent = bench::thread_milliseconds() - begin;
      left = mean_gap(now, truth) / size;
    }
    times.push_back(spent);
    counts.push_back(warm.solver.iterations);
    warm.solver.iterations = 0;
  }
  std::printf(
      "  static pose to 1 %% from the frame before, median (most) of nine: %.0f (%.0f) iterations, %.1f "
      "(%.1f) ms\n",
      bench::median(counts), *std::max_element(counts.begin(), counts.end()), bench::median(times),
      *std::max_element(times.begin(), times.end()));
}

void measure_level(const runtime::Asset& asset, size_t level, int frames) {
  double begin = bench::thread_milliseconds();
  const sim::FaceModel& reference = asset.model(level);
  const sim::realtime::Model& model = asset.realtime_model(level);
  const double first = bench::thread_milliseconds() - begin;
  const size_t channels = asset.channel_names.size(), nodes = reference.rest().size();
  begin = bench::thread_milliseconds();
  sim::realtime::Solver face(model, channels);
  const double another = bench::thread_milliseconds() - begin;
  std::printf("\n%s: %zu nodes, %zu unknowns, %zu entries of the factor\n",
              asset.rig().tissue.levels[level].name.c_str(), nodes, model.unknowns(), model.factor_entries());
  std::printf("  first face %.1f ms, another %.2f ms and %.2f MiB\n", first, another,
              static_cast<double>(face.memory()) / 1048576.0);
  Motion motion(asset);
  std::vector<Vec3f> now(nodes), truth(nodes);
  for (const int iterations : {1, 2, 4}) {
    sim::realtime::StepOptions options;
    options.iterations = iterations;
    sim::realtime::Solver moving(model, channels), exact(model, channels);
    sim::realtime::StepOptions converged;
    converged.iterations = 60;
    converged.tolerance = 2e-6;
    converged.checks_last = true;
    std::vector<double> times;
    double gap = 0.0, move = 0.0;
    const int compared = std::min(frames, 40);
    for (int frame = 0; frame < frames; ++frame) {
      const sim::Controls drive = motion.at(frame / 60.0, 0.2F);
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
    const double a_node = 1e6 * bench::median(times) / static_cast<double>(nodes);
    std::printf(
        "  %d iterations a substep: %.2f ms a frame, %.0f ns a node; last move %.3f mm; off the converged "
        "motion by %.3f mm in the mean\n",
        iterations, bench::median(times), a_node, 1e3 * move, 1e3 * gap);
  }
  measure_static_poses(reference, model, channels, motion);
}

/// A host with two threads.
void* begin_halves(fascia_task_range run, uint32_t count, uint32_t, void* context, void*) {
  auto* other = new std::thread(run, count / 2, count, context);
  run(0, count / 2, context);
  return other;
}
void finish_halves(void* task, void*) {
  auto* other = static_cast<std::thread*>(task);
  other->join();
  delete other;
}

double wall_milliseconds() {
  timespec now{};
  clock_gettime(CLOCK_MONOTONIC, &now);
  return 1e3 * static_cast<double>(now.tv_sec) + 1e-6 * static_cast<double>(now.tv_nsec);
}

/// A hundred faces of one asset at the coarsest level, through the C interface: median milliseconds a frame
/// by the wall clock, and where the last face's skin ends.
double crowd(fascia_asset* asset, const runtime::Asset& names, int iterations, bool two_threads,
             std::vector<float>& end) {
  constexpr uint32_t count = 100;
  fascia_face_options options = fascia_default_face_options();
  options.level = 0;
  options.iterations = iterations;
  std::vector<fascia_face*> faces(count);
  for (fascia_face*& face : faces)
    if (fascia_face_create(asset, &options, &face) != FASCIA_OK)
      throw std::runtime_error(fascia_last_message());
  const fascia_tasks tasks{sizeof(fascia_tasks), 0, begin_halves, finish_halves, nullptr};
  Motion motion(names);
  std::vector<double> times;
  for (int frame = 0; frame < 30; ++frame) {
    for (uint32_t i = 0; i < count; ++i) {
      motion.at(frame / 60.0 + i, 0.2F);
      std::copy(motion.values.begin(), motion.values.end(), fascia_face_values(faces[i]));
    }
    const double begin = wall_milliseconds();
    fascia_faces_step(faces.data(), count, 1.0F / 60.0F, two_threads ? &tasks : nullptr);
    times.push_back(wall_milliseconds() - begin);
  }
  fascia_vectors positions{};
  positions.struct_size = sizeof positions;
  for (const uint32_t i : {0U, 49U, 99U}) {
    fascia_face_positions(faces[i], 0, &positions);
    end.insert(end.end(), positions.data, positions.data + 3 * static_cast<size_t>(positions.count));
  }
  for (fascia_face* face : faces)
    fascia_face_release(face);
  return bench::median(times);
}

void measure_crowd(const std::vector<char>& bytes, const runtime::Asset& names) {
  fascia_asset* asset = nullptr;
  if (fascia_asset_load(bytes.data(), bytes.size(), &asset) != FASCIA_OK)
    throw std::runtime_error(fascia_last_message());
  std::printf("\n100 faces at the coarsest level through fascia_faces_step, wall clock a frame\n");
  for (const int iterations : {1, 2}) {
    std::vector<float> one, two;
    const double alone = crowd(asset, names, iterations, false, one),
                 together = crowd(asset, names, iterations, true, two);
    std::printf("  %d iterations a substep: %.1f ms on one thread, %.1f ms on two; %s\n", iterations, alone,
                together, one == two ? "the same bits" : "NOT the same bits");
  }
  fascia_asset_release(asset);
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
    for (size_t level = 0; level < asset.rig().tissue.levels.size(); ++level)
      measure_level(asset, level, frames);
    measure_crowd(bytes, asset);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "bench_face: %s\n", error.what());
    return 1;
  }
  return 0;
}
