// Frames to count instructions of: count_frames face|sheet FRAMES. See instruction_counts.sh.
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <string>

#include "sim/realtime/solver.h"
#include "sim/sheet/sheet.h"
#include "tests/sim/patch.h"

namespace {

using namespace fascia;

void step_sheet(int frames) {
  sim::Sheet sheet(sim::SheetOptions{});
  for (int frame = 0; frame < frames; ++frame)
    sheet.step(1.0F / 60.0F);
}

void step_face(int frames) {
  testing::PatchOptions options;
  options.across = 24;
  options.along = 24;
  rig::TissueLevel level = testing::make_patch(options);
  testing::add_fibre(level, options, 0, 4, 1, 12, 0.4F);
  testing::add_fibre(level, options, 1, 4, 20, 9, 0.4F);
  const sim::FaceModel reference(sim::lattice_of(level), sim::jaw_of(rig::JawJoint{}));
  const sim::realtime::Model model(reference);
  sim::realtime::Solver face(model, 2);
  for (int frame = 0; frame < frames; ++frame) {
    const auto wave = 0.5F + 0.5F * std::sin(0.2F * static_cast<float>(frame));
    const std::vector<float> pull = {wave, 1.0F - wave};
    face.step(1.0 / 60.0, {pull, {0.2F * wave, 0, 0}, sim::Vec3::Zero()});
  }
}

}  // namespace

int main(int argc, char** argv) {
  const std::string what = argc > 1 ? argv[1] : "";
  const int frames = argc > 2 ? std::atoi(argv[2]) : 0;
  if (what == "sheet")
    step_sheet(frames);
  else if (what == "face")
    step_face(frames);
  else
    return std::fprintf(stderr, "usage: count_frames face|sheet FRAMES\n"), 2;
  return 0;
}
