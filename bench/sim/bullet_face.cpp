// The full face in our own solver and in Bullet: every ARKit shape as a static pose of the same lattice, how
// far the skin moves, how far the two are apart, and what each takes; a picture of some, side by side, with
// the difference as colour.
//
//   bench_bullet RIG.glb [--level NAME] [--only SUBSTRING|pictured] [--picture FILE.png]
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstring>

#include "cli/picture.h"
#include "cli/posing.h"
#include "formats/scene.h"
#include "geometry/error.h"
#include "rig/read/read.h"
#include "view/image.h"

namespace {

using namespace fascia;

constexpr const char* pictured[] = {"arkit:eyeBlinkLeft", "arkit:jawOpen", "arkit:mouthSmileLeft",
                                    "arkit:mouthRollLower"};
constexpr double full_colour = 0.002;  // metres of difference that are drawn red

double pose(cli::Face& face, const std::string& shape) {
  face.clear();
  face.reset();
  face.set(shape, 1.0);
  const auto begin = std::chrono::steady_clock::now();
  face.pose();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
}

Vec3 place(std::span<const float> flat, size_t v) {
  return {flat[3 * v], flat[3 * v + 1], flat[3 * v + 2]};
}

/// White over yellow to red.
Vec3 heat(double share) {
  const double t = std::clamp(share, 0.0, 1.0);
  return {0.92, 0.92 - 0.85 * std::max(0.0, 2.0 * t - 1.0) - 0.1 * std::min(1.0, 2.0 * t),
          0.92 - 0.85 * std::min(1.0, 2.0 * t)};
}

struct Compared {
  std::vector<double> moved, apart;        ///< of skin vertices that either solver moves by 0.2 mm or more
  std::vector<std::vector<Vec3>> colours;  ///< by mesh, for its skin
};

Compared compare(const cli::Face& own, const cli::Face& bullet) {
  Compared result;
  for (size_t m = 0; m < own.meshes().size(); ++m) {
    result.colours.emplace_back();
    if (own.meshes()[m].part != "skin") continue;
    const auto rest = own.rest(m), a = own.positions(m), b = bullet.positions(m);
    for (size_t v = 0; v < own.meshes()[m].vertex_count; ++v) {
      const double moved = (place(a, v) - place(rest, v)).norm(),
                   other = (place(b, v) - place(rest, v)).norm(), apart = (place(a, v) - place(b, v)).norm();
      result.colours.back().push_back(heat(apart / full_colour));
      if (std::max(moved, other) < 2e-4) continue;
      result.moved.push_back(moved);
      result.apart.push_back(apart);
    }
  }
  return result;
}

double mean(const std::vector<double>& values) {
  double sum = 0.0;
  for (const double value : values)
    sum += value;
  return values.empty() ? 0.0 : sum / static_cast<double>(values.size());
}

double quantile(std::vector<double> values, double share) {
  if (values.empty()) return 0.0;
  std::sort(values.begin(), values.end());
  return values[std::min(values.size() - 1, static_cast<size_t>(share * static_cast<double>(values.size())))];
}

view::DrawList coloured(const cli::Face& face, const rig::Rig& rig, const Compared& compared) {
  view::DrawList list = cli::draw_face(face, rig, cli::layers_from("skin"));
  for (view::DrawSurface& surface : list.surfaces)
    for (const auto& colours : compared.colours) {
      if (colours.size() != surface.positions.size() || colours.empty()) continue;
      surface.vertex_colours = colours;
      surface.shading = view::Shading::data;
      surface.colour_map = surface.normal_map = surface.surface_map = nullptr;
    }
  return list;
}

void run(const std::string& path, const std::string& level, const std::string& only,
         const std::string& picture) {
  const std::vector<uint8_t> bytes = formats::read_bytes(path);
  const rig::Rig rig = rig::read(bytes, path).rig;
  cli::Face own(path, {FASCIA_SPACE_METRES, "own", level}),
      bullet(path, {FASCIA_SPACE_METRES, "bullet", level});
  const view::Camera camera = view::named_camera("front", cli::face_box(rig), 1.15);
  std::unique_ptr<view::Renderer> renderer;
  if (!picture.empty()) renderer = std::make_unique<view::Renderer>(320, 340);
  std::vector<view::Tile> tiles;
  std::printf(
      "| shape | skin moves, mean / most mm | apart, mean / 95 %% / most mm | own s | Bullet s "
      "|\n|---|---|---|---|---|\n");
  std::vector<double> all_moved, all_apart, own_times, bullet_times;
  for (const std::string& member : own.set_members("arkit")) {
    const std::string shape = "arkit:" + member;
    const bool is_pictured = std::find(std::begin(pictured), std::end(pictured), shape) != std::end(pictured);
    if (only == "pictured" ? !is_pictured : shape.find(only) == std::string::npos) continue;
    const double own_time = pose(own, shape), bullet_time = pose(bullet, shape);
    const Compared compared = compare(own, bullet);
    own_times.push_back(own_time);
    bullet_times.push_back(bullet_time);
    all_moved.insert(all_moved.end(), compared.moved.begin(), compared.moved.end());
    all_apart.insert(all_apart.end(), compared.apart.begin(), compared.apart.end());
    std::printf("| %s | %.2f / %.1f | %.2f / %.2f / %.1f | %.2f | %.1f |\n", member.c_str(),
                1e3 * mean(compared.moved), 1e3 * quantile(compared.moved, 1.0), 1e3 * mean(compared.apart),
                1e3 * quantile(compared.apart, 0.95), 1e3 * quantile(compared.apart, 1.0), own_time,
                bullet_time);
    std::fflush(stdout);
    if (!renderer || !is_pictured) continue;
    const auto layers = cli::layers_from("skin,eyes");
    tiles.push_back({renderer->draw(cli::draw_face(own, rig, layers), camera), member + ", own"});
    tiles.push_back({renderer->draw(cli::draw_face(bullet, rig, layers), camera), "Bullet"});
    tiles.push_back({renderer->draw(coloured(own, rig, compared), camera), "apart, red 2 mm"});
  }
  std::printf("| all | %.2f / %.1f | %.2f / %.2f / %.1f | %.2f | %.1f |\n", 1e3 * mean(all_moved),
              1e3 * quantile(all_moved, 1.0), 1e3 * mean(all_apart), 1e3 * quantile(all_apart, 0.95),
              1e3 * quantile(all_apart, 1.0), mean(own_times), mean(bullet_times));
  if (renderer) view::write_png(picture, view::contact_sheet(tiles, 3));
}

}  // namespace

int main(int argc, char** argv) {
  std::string rig, level = "low", only, picture;
  for (int i = 1; i < argc; ++i) {
    const bool more = i + 1 < argc;
    if (!std::strcmp(argv[i], "--level") && more)
      level = argv[++i];
    else if (!std::strcmp(argv[i], "--only") && more)
      only = argv[++i];
    else if (!std::strcmp(argv[i], "--picture") && more)
      picture = argv[++i];
    else
      rig = argv[i];
  }
  if (rig.empty()) {
    std::fprintf(stderr,
                 "usage: bench_bullet RIG.glb [--level NAME] [--only SUBSTRING] [--picture FILE.png]\n");
    return 2;
  }
  try {
    run(rig, level, only, picture);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "bench_bullet: %s\n", error.what());
    return 1;
  }
  return 0;
}
