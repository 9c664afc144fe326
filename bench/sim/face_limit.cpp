#include "bench/sim/face_limit.h"

#include <cstdio>
#include <fstream>
#include <functional>
#include <iterator>

#include "bench/sim/clock.h"
#include "runtime/asset.h"

namespace fascia::bench {
namespace {

using namespace sim::realtime;

double microseconds(const std::function<void()>& work) {
  std::vector<double> times;
  for (int round = 0; round < 41; ++round) {
    const double begin = thread_milliseconds();
    for (int i = 0; i < 10; ++i)
      work();
    times.push_back(100.0 * (thread_milliseconds() - begin));
  }
  return median(times);
}

void print_row(const char* what, double us, double flops, double bytes, const Machine& machine) {
  const double gigaflops = 1e-3 * flops / us, gigabytes = 1e-3 * bytes / us;
  std::printf("  %-34s %7.1f us  %6.2f MFLOP %6.1f GFLOP/s %3.0f %%   %6.2f MB %6.1f GB/s %3.0f %%\n", what,
              us, 1e-6 * flops, gigaflops, 100.0 * gigaflops / machine.gigaflops, 1e-6 * bytes, gigabytes,
              100.0 * gigabytes / machine.near);
}

// Operations of one lane, counted in sim/realtime/loops.h with nothing compressed past a wall: 150 a membrane
// and 262 a prism, two of each a triangle; 167 a hinge and 35 a spring, two and four an edge. Places are
// fetched as 16 bytes and added to as 32.
constexpr double triangle_flops = 2 * (150 + 262), edge_flops = 2 * 167 + 4 * 35, wide = batch_width;
constexpr double triangle_places = 9, edge_places = 10, place_bytes = 48;

void print_level(const Model& model, const std::string& name, const Machine& machine) {
  std::unique_ptr<Workspace> work = model.borrow();
  Boundary boundary = model.boundary(*work);
  std::fill(work->values.begin(), work->values.end(), 0.2F);
  model.set_jaw({0.2, 0.0, 0.0}, boundary);
  const Loops& loops = model.loops();
  loops.place(model.packed(), boundary);
  std::copy(boundary.carried, boundary.carried + model.places(), work->start.data());
  const auto energy_of = [&](const Packed& packed) {
    return microseconds([&] { loops.energy(packed, boundary, work->start.data(), work->gradient.data()); });
  };
  Packed only_triangles = model.packed();
  only_triangles.edge_batches = only_triangles.spring_batches = only_triangles.tether_batches =
      only_triangles.carrier_batches = 0;
  only_triangles.globe_batches = only_triangles.fibre_batches = only_triangles.pressure_batches = 0;
  Packed nothing = only_triangles, only_edges = only_triangles;
  nothing.triangle_batches = only_edges.triangle_batches = 0;
  only_edges.edge_batches = model.packed().edge_batches;
  const double overhead = energy_of(nothing);
  const auto triangles = static_cast<double>(model.packed().triangle_batches),
             edges = static_cast<double>(model.packed().edge_batches);
  std::printf("%s, %zu unknowns; shares are of the arithmetic and of the second-level cache's bandwidth\n",
              name.c_str(), model.unknowns());
  print_row("triangles: membranes, prisms", energy_of(only_triangles) - overhead,
            triangles * wide * triangle_flops,
            triangles * (sizeof(TriangleBatch) + wide * triangle_places * place_bytes), machine);
  print_row("edges: hinges, springs", energy_of(only_edges) - overhead, edges * wide * edge_flops,
            edges * (sizeof(EdgeBatch) + wide * edge_places * place_bytes), machine);
  const auto entries = static_cast<double>(model.factor_entries());
  print_row("solve, there and back", microseconds([&] {
              for (size_t i = 0; i < model.unknown_floats(); ++i)
                work->direction.data()[i] = 1e-3F;
              loops.solve(model.step_factor(), work->direction.data(), work->solve_scratch.data());
            }),
            12 * entries, 8 * entries, machine);
  const SparseRows matrix = model.stiffness();
  const auto stored = static_cast<double>(matrix.begin[matrix.size]);
  print_row("product with the stiffness",
            microseconds([&] { loops.multiply(matrix, work->moved.data(), work->damped.data()); }),
            6 * stored, 24 * stored, machine);
  model.give_back(std::move(work));
}

}  // namespace

void print_face_limits(const std::string& rig, const Machine& machine) {
  std::ifstream file(rig, std::ios::binary);
  const std::vector<char> bytes((std::istreambuf_iterator<char>(file)), {});
  const runtime::Asset asset(std::span(reinterpret_cast<const uint8_t*>(bytes.data()), bytes.size()));
  for (size_t level = 0; level < asset.rig().tissue.levels.size(); ++level)
    print_level(asset.realtime_model(level), asset.rig().tissue.levels[level].name, machine);
}

}  // namespace fascia::bench
