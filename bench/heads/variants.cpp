#include "bench/heads/variants.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <functional>
#include <random>

#include "anatomy/anatomy.h"
#include "formats/write.h"
#include "tests/landmarks/made_heads.h"

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

/// The head with its eyeballs alone grown by `growth` about their own centres and shifted; of the left eye
/// alone or of both.
formats::Drawing with_eyeballs(const std::vector<anatomy::MeshObject>& head, double growth, const Vec3& shift,
                               bool both = true) {
  formats::Drawing drawing;
  for (const anatomy::MeshObject& object : head) {
    formats::NamedSurface surface{object.name, object.mesh};
    if (object.name == "eye_left" || (both && object.name == "eye_right")) {
      if (growth <= 0.0) continue;
      const Vec3 centre = bounds(object.mesh.vertices).centre();
      for (Vec3& p : surface.mesh.vertices)
        p = centre + growth * (p - centre) + shift;
    }
    drawing.surfaces.push_back(std::move(surface));
  }
  return drawing;
}

/// Lips a third as high, the mouth half as wide again.
Vec3 with_thin_lips(const Vec3& p) {
  const Vec3 from = p - Vec3(0, -0.0375, 0.1);
  const double near = std::exp(-(0.4 * from.x() * from.x() + 2.0 * from.y() * from.y()) / (0.016 * 0.016)) *
                      (from.z() > -0.03 ? 1.0 : 0.0);
  return p + near * Vec3(0.4 * from.x(), -0.5 * from.y(), 0);
}

formats::Drawing drawing_of(const testing::MadeHead& head, double scale = 1.0) {
  formats::Drawing drawing;
  for (const formats::SceneMesh& mesh : head.scene.meshes) {
    formats::NamedSurface surface{mesh.name, {mesh.positions, mesh.triangles}};
    for (Vec3& p : surface.mesh.vertices)
      p *= scale;
    drawing.surfaces.push_back(std::move(surface));
  }
  return drawing;
}

}  // namespace

std::vector<std::pair<std::string, std::filesystem::path>> write_variants(
    const std::filesystem::path& folder) {
  const anatomy::GenericAnatomy anatomy = anatomy::load_generic();
  const std::vector<anatomy::MeshObject>& head = anatomy.head;
  const testing::MadeHead made = testing::made_head(anatomy, "made", [](const Vec3& p) { return p; });
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
      {"quarter_millimetre_noise",
       changed(head,
               [&](const Vec3& p) { return Vec3(p + Vec3(noise(random), noise(random), noise(random))); })},
      {"eyeballs_0.6", with_eyeballs(head, 0.6, Vec3::Zero())},
      {"eyeballs_0.8", with_eyeballs(head, 0.8, Vec3::Zero())},
      {"eyeballs_1.3", with_eyeballs(head, 1.3, Vec3::Zero())},
      {"eyeballs_1.8", with_eyeballs(head, 1.8, Vec3::Zero())},
      {"eyeballs_2.5", with_eyeballs(head, 2.5, Vec3::Zero())},
      {"eyeballs_up", with_eyeballs(head, 1.0, Vec3(0, 0.006, 0))},
      {"eyeballs_before", with_eyeballs(head, 1.0, Vec3(0, 0, 0.008))},
      {"eyeballs_behind", with_eyeballs(head, 1.0, Vec3(0.003, 0, -0.012))},
      {"left_eyeball_missing", with_eyeballs(head, 0.0, Vec3::Zero(), false)},
      {"eyes_2.5", changed(head, large_eyes(1.5))},
      {"eyes_2.5_without_eyeballs", changed(head, large_eyes(1.5), false)},
      {"eyes_0.6", changed(head, large_eyes(-0.4))},
      {"thin_lips", changed(head, with_thin_lips)},
      {"elder", changed(head, testing::as_elder)},
      {"anime", changed(head, testing::as_anime)},
      {"toon", changed(head, testing::as_toon)},
      {"creature", changed(head, testing::as_creature)},
      {"in_inches", changed(head, [](const Vec3& p) { return Vec3(p / 0.0254); })},
      {"mirrored", drawing_of(testing::mirrored(made))},
      {"of_400_triangles", drawing_of(testing::coarse(made, 400))},
      {"of_2000_triangles", drawing_of(testing::coarse(made, 2000))},
      {"mask", drawing_of(testing::mask(made))},
      {"subdivided_thrice", drawing_of(testing::subdivided(testing::subdivided(testing::subdivided(made))))}};
  std::vector<std::pair<std::string, std::filesystem::path>> files;
  for (const auto& [name, drawing] : all) {
    files.emplace_back(name, folder / ("head_" + name + ".glb"));
    formats::write(files.back().second, drawing);
  }
  return files;
}

}  // namespace fascia::bench
