// Whether the levels of detail give the same poses: for each ARKit shape the distance between two levels'
// places of the skin's vertices, over those that either moves by more than half a millimetre.
//
//   bench_levels [embedded|neutral|person_1|...]... [--solver own|reference] [--only SUBSTRING] [--rigs DIR]
//   [--pose NAME=VALUE]...
//                [--sheet PREFIX]
//
// A sheet shows each pose at the medium and low level, coloured by how far the next finer one lies from it
// (red: 2 mm). With --rigs the rigs are kept in DIR, and read from there when they are. --pose plays channels
// instead of shapes.

#include <algorithm>
#include <chrono>
#include <cstdio>

#include "bench/people/arguments.h"
#include "bench/people/person.h"
#include "cli/posing.h"
#include "view/image.h"
#include "view/renderer.h"

namespace fascia::bench {
namespace {

namespace fs = std::filesystem;

struct Request {
  std::vector<std::string> people, poses;
  std::string solver = "own", only, sheet;
  fs::path rigs;
};

/// Motions of all skin vertices, metres.
std::vector<Vec3> motions(cli::Face& face, const std::string& name, double value) {
  face.clear();
  face.reset();
  face.set(name, value);
  face.pose();
  std::vector<Vec3> moved;
  for (size_t m = 0; m < face.meshes().size(); ++m) {
    if (face.meshes()[m].part != "skin") continue;
    const auto now = face.positions(m), rest = face.rest(m);
    for (size_t i = 0; i + 2 < now.size(); i += 3)
      moved.emplace_back(now[i] - rest[i], now[i + 1] - rest[i + 1], now[i + 2] - rest[i + 2]);
  }
  return moved;
}

/// How far two poses of one face lie apart where it moves, millimetres.
struct Difference {
  double mean = 0.0, most = 0.0, largest = 0.0, motion = 0.0;  ///< most: 95 % of the vertices lie within
};

Difference difference(const std::vector<Vec3>& a, const std::vector<Vec3>& b) {
  std::vector<double> apart;
  Difference out;
  for (size_t v = 0; v < a.size(); ++v) {
    if (std::max(a[v].norm(), b[v].norm()) < 0.0005) continue;
    apart.push_back(1e3 * (a[v] - b[v]).norm());
    out.mean += apart.back();
    out.motion += 1e3 * b[v].norm();
  }
  if (apart.empty()) return out;
  std::sort(apart.begin(), apart.end());
  out.mean /= static_cast<double>(apart.size());
  out.motion /= static_cast<double>(apart.size());
  out.most = apart[apart.size() * 95 / 100];
  out.largest = apart.back();
  return out;
}

Vec3 heat(double mm) {
  const double t = std::min(mm / 2.0, 1.0);
  return {std::min(1.0, 2.0 * t), std::min({1.0, 2.0 * t, 2.0 - 2.0 * t}), std::max(0.0, 1.0 - 2.0 * t)};
}

/// The skin as `moved` has it, coloured by how far `other` lies from it.
view::Image picture(const view::Renderer& renderer, const cli::Face& face, const std::vector<Vec3>& moved,
                    const std::vector<Vec3>& other) {
  view::DrawList list;
  size_t first = 0;
  Vec3 front = Vec3(0, 0, -1e9);
  for (size_t m = 0; m < face.meshes().size(); ++m) {
    if (face.meshes()[m].part != "skin") continue;
    view::DrawSurface surface;
    surface.triangles = face.meshes()[m].triangles;
    const auto rest = face.rest(m);
    for (size_t i = 0; i + 2 < rest.size(); i += 3, ++first) {
      const Vec3 p(rest[i], rest[i + 1], rest[i + 2]);
      if (p.z() > front.z()) front = p;
      surface.positions.push_back(p + moved[first]);
      surface.vertex_colours.push_back(heat(1e3 * (moved[first] - other[first]).norm()));
    }
    list.surfaces.push_back(std::move(surface));
  }
  view::Camera camera;
  camera.target = front + Vec3(0, -0.02, -0.04);
  camera.distance = 0.42;
  camera.yaw = 25;
  return renderer.draw(list, camera);
}

void run(const std::string& name, const Request& request) {
  const fs::path path =
      (request.rigs.empty() ? fs::temp_directory_path() : request.rigs) / ("fascia_levels_" + name + ".glb");
  if (request.rigs.empty() || !fs::exists(path)) build_rig_file(read_person(name), "high", path);
  const char* const levels[] = {"low", "medium", "high"};
  std::vector<std::unique_ptr<cli::Face>> faces;
  for (const char* level : levels)
    faces.push_back(
        std::make_unique<cli::Face>(path, cli::Face::Options{FASCIA_SPACE_METRES, request.solver, level}));
  std::vector<std::pair<std::string, double>> poses;
  for (const std::string& word : request.poses)
    poses.emplace_back(word.substr(0, word.find('=')), std::stod(word.substr(word.find('=') + 1)));
  if (poses.empty())
    for (const std::string& shape : faces[0]->set_members("arkit"))
      if (shape.find(request.only) != std::string::npos && shape.find("Right") == std::string::npos)
        poses.emplace_back("arkit:" + shape, 1.0);
  std::printf("%s, millimetres\n%-26s %6s   %-22s %-22s %s\n%26s %6s   %6s %6s %6s  %6s %6s %6s  %s\n",
              name.c_str(), "shape", "motion", "medium from high", "low from medium", "seconds", "", "",
              "mean", "95 %", "most", "mean", "95 %", "most", "low, medium, high");
  Difference sum[2];
  int within = 0;
  std::vector<view::Tile> tiles;
  std::unique_ptr<view::Renderer> renderer;
  if (!request.sheet.empty()) renderer = std::make_unique<view::Renderer>(320, 360);
  for (const auto& [pose, value] : poses) {
    std::vector<std::vector<Vec3>> moved;
    double seconds[3] = {};
    for (size_t level = 0; level < 3; ++level) {
      const auto begin = std::chrono::steady_clock::now();
      moved.push_back(motions(*faces[level], pose, value));
      seconds[level] = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    }
    const Difference fine = difference(moved[1], moved[2]), coarse = difference(moved[0], moved[1]);
    std::printf("%-26s %6.2f   %6.2f %6.2f %6.2f  %6.2f %6.2f %6.2f  %.1f %.1f %.1f\n", pose.c_str(),
                fine.motion, fine.mean, fine.most, fine.largest, coarse.mean, coarse.most, coarse.largest,
                seconds[0], seconds[1], seconds[2]);
    std::fflush(stdout);
    for (size_t level : {1, 0})
      if (renderer)
        tiles.push_back({picture(*renderer, *faces[level], moved[level], moved[level + 1]),
                         pose.substr(pose.find(':') + 1) + " " + levels[level]});
    within += fine.mean <= 0.5 && fine.most <= 1.5;
    for (int k = 0; k < 2; ++k) {
      const Difference& d = k ? coarse : fine;
      sum[k].mean += d.mean;
      sum[k].most += d.most;
      sum[k].largest += d.largest;
      sum[k].motion += d.motion;
    }
  }
  const auto count = static_cast<double>(poses.size());
  std::printf(
      "%-26s %6.2f   %6.2f %6.2f %6.2f  %6.2f %6.2f %6.2f\n%d of %zu with medium from high within 0.5 mm in "
      "the mean and 1.5 mm in 95 %%\n\n",
      "mean", sum[0].motion / count, sum[0].mean / count, sum[0].most / count, sum[0].largest / count,
      sum[1].mean / count, sum[1].most / count, sum[1].largest / count, within, poses.size());
  if (renderer) view::write_png(request.sheet + "_" + name + ".png", view::contact_sheet(tiles, 6));
  if (request.rigs.empty()) fs::remove(path);
}

}  // namespace
}  // namespace fascia::bench

int main(int argc, char** argv) {
  fascia::bench::Request request;
  fascia::bench::Arguments arguments("bench_levels", "[embedded|neutral|person_1|...]...");
  arguments.option("--solver", "own|reference", request.solver);
  arguments.option("--only", "SUBSTRING", request.only);
  arguments.option("--rigs", "DIR", request.rigs);
  arguments.option("--pose", "NAME=VALUE", request.poses);
  arguments.option("--sheet", "PREFIX", request.sheet);
  if (!arguments.parse(argc, argv, request.people)) return 2;
  return fascia::bench::for_each_person("bench_levels", request.people, [&](const std::string& person) {
    fascia::bench::run(person, request);
  });
}
