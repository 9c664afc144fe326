// The soft sheet: 100 x 100 particles, 59,002 springs, one row pinned, let go level under gravity, 60 Hz.
// Every row states the stretch beside the time; the programs' frames are taken in turn, so that a busy
// machine is busy for all.
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <string>

#include "bench/sim/clock.h"
#include "sim/sheet/sheet.h"
#ifdef FASCIA_BULLET
#include "bench/sim/bullet_sheet.h"
#endif

namespace {

using namespace fascia;

/// One program under measure.
struct Contender {
  std::string name;
  std::unique_ptr<sim::Sheet> own;
#ifdef FASCIA_BULLET
  std::unique_ptr<bench::BulletSheet> bullet;
#endif
  std::vector<double> milliseconds, stretch;

  void frame() {
    const double begin = bench::thread_milliseconds();
    if (own) own->step(1.0F / 60.0F);
#ifdef FASCIA_BULLET
    if (bullet) bullet->step(1.0 / 60.0);
#endif
    milliseconds.push_back(bench::thread_milliseconds() - begin);
    if (own) stretch.push_back(own->mean_stretch());
#ifdef FASCIA_BULLET
    if (bullet) stretch.push_back(bullet->mean_stretch());
#endif
  }
};

}  // namespace

int main(int argc, char** argv) {
  const int frames = argc > 1 ? std::max(2, std::atoi(argv[1])) : 300;
  std::vector<Contender> contenders;
  const auto add_own = [&](const char* name, sim::lanes::InstructionSet set, int substeps) {
    sim::SheetOptions options;
    options.instructions = set;
    options.substeps = substeps;
    Contender contender;
    contender.name = name;
    contender.own = std::make_unique<sim::Sheet>(options);
    contenders.push_back(std::move(contender));
  };
  add_own("Fascia, widest unit", sim::lanes::instruction_set(), 10);
  add_own("Fascia, SSE2", sim::lanes::InstructionSet::baseline, 10);
#ifdef FASCIA_BULLET
  const auto add_bullet = [&](const char* name, int substeps, int iterations) {
    Contender contender;
    contender.name = name;
    contender.bullet = std::make_unique<bench::BulletSheet>(100, 0.01, substeps, iterations);
    contenders.push_back(std::move(contender));
  };
  add_bullet("Bullet, 10 iterations", 1, 10);
  add_bullet("Bullet, 10 substeps", 10, 1);
#endif
  for (int frame = 0; frame < frames; ++frame)
    for (Contender& contender : contenders)
      contender.frame();
  std::printf("%-22s %10s %16s %16s %8s\n", "", "ms a frame", "stretch at end %", "worst frame %", "times");
  const double own = bench::median(contenders.front().milliseconds);
  for (const Contender& c : contenders) {
    const size_t last = c.stretch.size() / 5;
    double mean = 0.0, worst = 0.0;
    for (size_t i = 0; i < c.stretch.size(); ++i) {
      if (i + last >= c.stretch.size()) mean += c.stretch[i] / static_cast<double>(last);
      worst = std::max(worst, c.stretch[i]);
    }
    const double time = bench::median(c.milliseconds);
    std::printf("%-22s %10.3f %16.3f %16.3f %8.1f\n", c.name.c_str(), time, 100.0 * mean, 100.0 * worst,
                time / own);
  }
  return 0;
}
