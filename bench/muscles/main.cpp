// The experiment of Tables 7.1 and 7.2 of O. Aina's thesis: the time to make muscles against how many fibres
// they have and how fine the SMAS is, on one core. bench_muscles           both tables on the embedded head
// bench_muscles measured  mean fibre lengths beside published ones

#include <algorithm>
#include <cstdio>
#include <cstring>
#include <ctime>

#include "bench/muscles/face.h"
#include "bench/muscles/measured.h"
#include "geometry/error.h"

namespace {

using namespace fascia;

/// Processor time of this thread, milliseconds: other programs on the machine do not count.
double now() {
  timespec time{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
  return 1e3 * static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_nsec);
}

struct Run {
  double milliseconds = 1e300;
  size_t fibres = 0;
};

/// The shortest of `times` runs.
Run run(const muscles::Inputs& inputs, const muscles::Options& options, int times) {
  Run best;
  for (int k = 0; k < times; ++k) {
    const double started = now();
    const muscles::Result built = muscles::build(inputs, options);
    best.milliseconds = std::min(best.milliseconds, now() - started);
    best.fibres = 0;
    for (const muscles::Muscle& muscle : built.muscles)
      best.fibres += muscle.fibres.size();
  }
  return best;
}

muscles::Options with_fibres(int count) {
  muscles::Options options;
  options.fewest_fibres = options.most_fibres = count;
  return options;
}

/// Table 7.1: against the fibres of each muscle, on the SMAS as it is built by default.
void print_against_fibres(const bench::Face& face) {
  std::printf("\nTime against fibres a muscle (Table 7.1), %zu muscle parts on %d triangles\n",
              face.inputs.muscles.size(), face.smas.triangle_count());
  std::printf("%12s %12s %14s %16s %18s\n", "a muscle", "fibres", "all, ms", "ms a muscle",
              "us a fibre more");
  Run last;
  for (const int count : {3, 6, 12, 24, 48}) {
    const Run now = run(face.inputs, with_fibres(count), 3);
    const double more =
        last.fibres ? 1e3 * (now.milliseconds - last.milliseconds) / double(now.fibres - last.fibres) : 0.0;
    std::printf("%12d %12zu %14.1f %16.2f %18.1f\n", count, now.fibres, now.milliseconds,
                now.milliseconds / double(face.inputs.muscles.size()), more);
    last = now;
  }
  std::printf("default options: ");
  const Run usual = run(face.inputs, {}, 5);
  std::printf("%zu fibres in %.1f ms (goal: 150)\n", usual.fibres, usual.milliseconds);
}

/// Muscle by muscle: what each adds to a build of none.
void print_by_muscle(const bench::Face& face) {
  std::printf("\nTime muscle by muscle, left side, default options\n%-48s %8s %10s\n", "muscle", "fibres",
              "ms");
  muscles::Inputs inputs = face.inputs;
  inputs.muscles = {};
  const double empty = run(inputs, {}, 3).milliseconds;
  std::printf("%-48s %8s %10.2f\n", "(surfaces and depths alone)", "", empty);
  for (const anatomy::Muscle& muscle : face.inputs.muscles) {
    if (muscle.side == anatomy::Side::right) continue;
    inputs.muscles = {&muscle, 1};
    const Run alone = run(inputs, {}, 2);
    std::printf("%-48s %8zu %10.2f\n", muscle.name.c_str(), alone.fibres,
                std::max(0.0, alone.milliseconds - empty));
  }
}

/// Table 7.2: against the triangles of the SMAS.
void print_against_mesh() {
  std::printf("\nTime against the SMAS' triangles (Table 7.2), default options\n%12s %12s %12s %14s\n",
              "edge, mm", "triangles", "fibres", "all, ms");
  for (const double edge : {0.0056, 0.004, 0.0028, 0.002}) {
    const auto face = bench::embedded_face(edge);
    const Run all = run(face->inputs, {}, 3);
    std::printf("%12.1f %12d %12zu %14.1f\n", 1e3 * edge, face->smas.triangle_count(), all.fibres,
                all.milliseconds);
  }
}

}  // namespace

int main(int argc, char** argv) {
  try {
    const auto face = bench::embedded_face(0.004);
    if (argc > 1 && std::strcmp(argv[1], "measured") == 0) {
      bench::print_lengths(muscles::build(face->inputs));
      return 0;
    }
    if (argc > 1) return std::fputs("usage: bench_muscles [measured]\n", stderr), 2;
    std::printf(
        "The thesis timed its muscles on a 1.6 GHz machine with 512 MB and a 3.2 GHz machine with 2 GB; the "
        "figures of\n"
        "its tables are not public. Goals here: all muscles of a face under 150 ms on one core, linear in "
        "fibres.\n");
    print_against_fibres(*face);
    print_by_muscle(*face);
    print_against_mesh();
  } catch (const Error& error) {
    std::fprintf(stderr, "bench_muscles: %s\n", error.what());
    return 1;
  }
}
