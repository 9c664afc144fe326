#include "bench/heads/variants.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <functional>
#include <random>

#include "anatomy/anatomy.h"
#include "formats/write.h"

namespace fascia::bench {
namespace {

using Change = std::function<Vec3(const Vec3&)>;

/// A small child's proportions: the face small under a large vault, the whole smaller.
Vec3 as_child(const Vec3& p) {
  const double low = std::clamp((0.06 - p.y()) / 0.14, 0.0, 1.0);
  const double height = 0.04 + (p.y() < 0.04 ? 0.84 : 1.02) * (p.y() - 0.04);
  return 0.86 * Vec3(p.x() * (1.0 - 0.16 * low), height, p.z() * (1.0 - 0.1 * low));
}

/// Eyes drawn larger by `more` about where they are.
Change large_eyes(double more) {
  return [more](const Vec3& p) {
    Vec3 moved = p;
    for (const double side : {-1.0, 1.0}) {
      const Vec3 from = p - Vec3(side * 0.0315, 0.035, 0.075);
      moved += more * std::exp(-from.squaredNorm() / (0.032 * 0.032)) * from;
    }
    return moved;
  };
}

formats::Drawing changed(const std::vector<anatomy::MeshObject>& head, const Change& change,
                         bool with_eyes = true) {
  formats::Drawing drawing;
  for (const anatomy::MeshObject& object : head) {
    if (!with_eyes && object.name != "skin") continue;
    formats::NamedSurface surface{object.name, object.mesh};
    for (Vec3& p : surface.mesh.vertices)
      p = change(p);
    drawing.surfaces.push_back(std::move(surface));
  }
  return drawing;
}

}  // namespace

std::vector<std::pair<std::string, std::filesystem::path>> write_variants(
    const std::filesystem::path& folder) {
  const std::vector<anatomy::MeshObject> head = anatomy::load_generic().head;
  const Mat3 turn =
      (Eigen::AngleAxisd(0.6, Vec3::UnitY()) * Eigen::AngleAxisd(-0.4, Vec3::UnitX())).toRotationMatrix();
  std::mt19937 random(7);
  std::normal_distribution<double> noise(0.0, 2.5e-4);
  const auto same = [](const Vec3& p) { return p; };
  const std::vector<std::pair<std::string, formats::Drawing>> all = {
      {"embedded", changed(head, same)},
      {"turned_in_millimetres",
       changed(head, [&](const Vec3& p) { return Vec3(1e3 * (turn * p) + Vec3(40, 900, 3)); })},
      {"without_eyeballs", changed(head, same, false)},
      {"as_a_child", changed(head, as_child)},
      {"large_eyes", changed(head, large_eyes(0.45))},
      {"larger_eyes", changed(head, large_eyes(0.9))},
      {"wide", changed(head, [](const Vec3& p) { return Vec3(1.25 * p.x(), p.y(), p.z()); })},
      {"long", changed(head, [](const Vec3& p) { return Vec3(p.x(), 1.25 * p.y(), p.z()); })},
      {"lopsided",
       changed(head, [](const Vec3& p) { return Vec3(p.x() + 0.06 * p.y(), p.y(), p.z() + 0.05 * p.x()); })},
      {"quarter_millimetre_noise", changed(head, [&](const Vec3& p) {
         return Vec3(p + Vec3(noise(random), noise(random), noise(random)));
       })}};
  std::vector<std::pair<std::string, std::filesystem::path>> files;
  for (const auto& [name, drawing] : all) {
    files.emplace_back(name, folder / ("head_" + name + ".glb"));
    formats::write(files.back().second, drawing);
  }
  return files;
}

}  // namespace fascia::bench
