// Whether lips or lids ever cross: random drives of all channels, as static poses and as steps in time, and
// every ARKit shape alone; by nodes of the lattice's skin and by vertices of the mesh.
//
//   bench_sweep RIG.glb [--level INDEX] [--poses N] [--seconds S] [--seed N]
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <iterator>

#include "tests/builder/swept_face.h"

namespace {

using namespace fascia;
using testing::SweptFace;

constexpr double tolerance = 5e-4;  // metres
constexpr const char* openings[] = {"lips", "left lids", "right lids"};

void print(const char* name, const SweptFace::State& state, int frames) {
  std::printf("%s, %d states: %s, %d turned prisms\n", name, frames,
              state.is_finite ? "finite" : "NOT FINITE", state.turned_prisms);
  for (size_t k = 0; k < 3; ++k) {
    const auto& l = state.lattice[k];
    const auto& r = state.rendered[k];
    std::printf("  %-10s  lattice %.2f mm, %d beyond %.1f mm; mesh %.2f mm, %d; worst at %.1f %.1f %.1f mm\n",
                openings[k], 1e3 * l.depth, l.count, 1e3 * tolerance, 1e3 * r.depth, r.count,
                1e3 * r.place.x(), 1e3 * r.place.y(), 1e3 * r.place.z());
  }
}

/// Each ARKit shape alone at full value; those that cross are named.
void sweep_shapes(SweptFace& face) {
  SweptFace::State all;
  const std::vector<std::string> shapes = face.shapes();
  for (const std::string& shape : shapes) {
    face.relax();
    face.add(shape, 1.0F);
    face.pose();
    const SweptFace::State state = face.state(tolerance);
    all.take(state);
    for (size_t k = 0; k < 3; ++k)
      if (state.rendered[k].count + state.lattice[k].count + state.turned_prisms > 0)
        std::printf("    %s: %s lattice %.2f mm, mesh %.2f mm (%d), turned prisms %d\n", shape.c_str(),
                    openings[k], 1e3 * state.lattice[k].depth, 1e3 * state.rendered[k].depth,
                    state.rendered[k].count, state.turned_prisms);
  }
  print("ARKit shapes alone", all, static_cast<int>(shapes.size()));
}

}  // namespace

int main(int argc, char** argv) {
  const char* rig = nullptr;
  size_t level = 0;
  int poses = 200;
  double seconds = 30.0;
  unsigned seed = 1;
  bool names = false;
  for (int i = 1; i < argc; ++i) {
    const auto value = [&] { return i + 1 < argc ? argv[++i] : "0"; };
    if (!std::strcmp(argv[i], "--level"))
      level = static_cast<size_t>(std::atoi(value()));
    else if (!std::strcmp(argv[i], "--poses"))
      poses = std::atoi(value());
    else if (!std::strcmp(argv[i], "--seconds"))
      seconds = std::atof(value());
    else if (!std::strcmp(argv[i], "--seed"))
      seed = static_cast<unsigned>(std::atoi(value()));
    else if (!std::strcmp(argv[i], "--names"))
      names = true;
    else
      rig = argv[i];
  }
  if (rig == nullptr) {
    std::fprintf(
        stderr,
        "usage: bench_sweep RIG.glb [--level INDEX] [--poses N] [--seconds S] [--seed N] [--names]\n");
    return 2;
  }
  std::ifstream file(rig, std::ios::binary);
  const std::vector<char> bytes((std::istreambuf_iterator<char>(file)), {});
  try {
    const auto asset = std::make_shared<const runtime::Asset>(
        std::span(reinterpret_cast<const uint8_t*>(bytes.data()), bytes.size()));
    if (level >= asset->rig().tissue.levels.size()) throw std::runtime_error("the rig has no such level");
    SweptFace face(asset, level);
    sweep_shapes(face);
    std::mt19937 random(seed);
    SweptFace::State still, moving;
    for (int i = 0; i < poses; ++i) {
      face.draw(random);
      face.pose();
      const SweptFace::State state = face.state(tolerance);
      still.take(state);
      for (size_t k = 0; names && k < 3; ++k) {
        if (state.rendered[k].depth < 2.0 * tolerance) continue;
        std::printf("    pose %d: %s mesh %.2f mm, lattice %.2f mm at %.1f %.1f %.1f mm:", i, openings[k],
                    1e3 * state.rendered[k].depth, 1e3 * state.lattice[k].depth,
                    1e3 * state.rendered[k].place.x(), 1e3 * state.rendered[k].place.y(),
                    1e3 * state.rendered[k].place.z());
        for (size_t c = 0; c < face.values().size(); ++c)
          if (face.values()[c] != 0.0F)
            std::printf(" %s=%.2f", asset->channel_names[c], static_cast<double>(face.values()[c]));
        std::printf("\n");
      }
    }
    print("random static poses", still, poses);
    face.relax();
    face.pose();
    const int frames = static_cast<int>(60.0 * seconds);
    int resets = 0;
    for (int frame = 0; frame < frames; ++frame) {
      if (frame % 15 == 0) face.draw(random);  // a jump every quarter of a second
      if (!face.step(1.0 / 60.0)) ++resets;
      moving.take(face.state(tolerance));
    }
    std::printf("%d resets\n", resets);
    print("jumps four times a second", moving, frames);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "bench_sweep: %s\n", error.what());
    return 1;
  }
  return 0;
}
