// What the machine can do at most: floats multiplied and added a second by one thread, and bytes moved from
// memory and from the second-level cache. Then how near the sheet comes, and the loops of a face.
//
//   bench_machine [RIG.glb]
#include <cstdio>
#include <exception>
#include <vector>

#include "bench/sim/clock.h"
#include "bench/sim/face_limit.h"
#include "sim/sheet/sheet.h"

namespace {

using namespace fascia;

typedef float Sixteen __attribute__((vector_size(64)));

#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__)
#define FASCIA_WIDEST __attribute__((target_clones("avx512f", "avx2", "default")))
#else
#define FASCIA_WIDEST
#endif

/// Multiplications and additions, not fused, in twelve chains.
FASCIA_WIDEST float arithmetic(long rounds) {
  Sixteen sum[12] = {};
  const Sixteen factor = Sixteen{} + 0.999F, more = Sixteen{} + 1.0F;
  for (long i = 0; i < rounds; ++i)
    for (auto& s : sum)
      s = s * factor + more;
  Sixteen all = {};
  for (const auto& s : sum)
    all += s;
  return all[0];
}

FASCIA_WIDEST void triad(float* a, const float* b, const float* c, size_t count) {
  for (size_t i = 0; i < count; ++i)
    a[i] = b[i] + 0.5F * c[i];
}

double gigabytes_a_second(size_t floats, int rounds) {
  std::vector<float> a(floats, 1.0F), b(floats, 2.0F), c(floats, 3.0F);
  std::vector<double> times;
  for (int round = 0; round < rounds; ++round) {
    const double begin = bench::thread_milliseconds();
    triad(a.data(), b.data(), c.data(), floats);
    times.push_back(bench::thread_milliseconds() - begin);
    c[static_cast<size_t>(round) % floats] = a[0];
  }
  return 12e-6 * static_cast<double>(floats) / bench::median(times);
}

}  // namespace

int main(int argc, char** argv) {
  std::vector<double> times;
  volatile float keep = 0.0F;
  constexpr long rounds = 2000000;
  for (int i = 0; i < 7; ++i) {
    const double begin = bench::thread_milliseconds();
    keep = keep + arithmetic(rounds);
    times.push_back(bench::thread_milliseconds() - begin);
  }
  const double peak = 1e-6 * static_cast<double>(rounds) * 12 * 32 / bench::median(times);
  const double far = gigabytes_a_second(16 << 20, 9), near = gigabytes_a_second(64 << 10, 401);
  std::printf("arithmetic %.1f GFLOP/s (not fused); memory %.1f GB/s, second-level cache %.1f GB/s\n", peak,
              far, near);

  sim::Sheet sheet(sim::SheetOptions{});
  times.clear();
  for (int frame = 0; frame < 200; ++frame) {
    const double begin = bench::thread_milliseconds();
    sheet.step(1.0F / 60.0F);
    times.push_back(bench::thread_milliseconds() - begin);
  }
  // A substep, from sim/sheet/sheet_loops.h, on 112 x 100 places (strips filled up): 30 operations and 108
  // bytes a spring that is relaxed (two places read and written, three weights), 62 and 148 a segment of a
  // chain, 15 and 60 a place that moves.
  constexpr double places = 112.0 * 100, relaxed = 49102 * 1.12, segments = 99 * 112.0;
  const double flops = 10 * (30 * relaxed + 62 * segments + 15 * places),
               bytes = 10 * (108 * relaxed + 148 * segments + 60 * places);
  const double seconds = 1e-3 * bench::median(times);
  std::printf(
      "sheet %.2f ms a frame: %.1f GFLOP/s, %.0f %% of the arithmetic; %.1f GB/s read and written, "
      "neighbours' from the first-level cache\n",
      1e3 * seconds, 1e-9 * flops / seconds, 1e-7 * flops / seconds / peak, 1e-9 * bytes / seconds);
  if (argc > 1) try {
      bench::print_face_limits(argv[1], {peak, near, far});
    } catch (const std::exception& error) {
      std::fprintf(stderr, "bench_machine: %s: %s\n", argv[1], error.what());
      return 1;
    }
  return keep == 0.5F ? 1 : 0;
}
