#include "bench/landmarks/same_head.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cstdio>
#include <functional>

#include "builder/rigging/find_landmarks.h"
#include "tests/landmarks/made_heads.h"
#include "tests/landmarks/measured_heads.h"

namespace fascia::bench {
namespace {

using rigging::FoundLandmarks;

/// Places in file coordinates.
Landmarks places_of(const FoundLandmarks& found) {
  const Mat4 to_file = found.head.input_to_metres.inverse();
  Landmarks places;
  for (const auto& [name, landmark] : found.landmarks)
    places[name] = transform_point(to_file, landmark.position);
  return places;
}

struct Report {
  std::string file;
  double millimetres;  ///< of a file unit

  void print(const char* change, const Landmarks& expected,
             const std::function<FoundLandmarks()>& find) const {
    try {
      const Landmarks places = places_of(find());
      double sum = 0.0, most = 0.0, count = 0.0;
      std::string worst;
      for (const auto& [name, p] : expected) {
        const auto at = places.find(name);
        if (at == places.end()) continue;
        const double off = millimetres * (at->second - p).norm();
        sum += off;
        count += 1.0;
        if (off > most) worst = name;
        most = std::max(most, off);
      }
      std::printf("%-22s %-12s mean %6.2f max %6.2f mm%s %s\n", file.c_str(), change, sum / count, most,
                  most > 1.0 ? " !" : "", worst.c_str());
    } catch (const std::exception& error) {
      std::printf("%-22s %-12s FAILED: %s\n", file.c_str(), change, error.what());
    }
    std::fflush(stdout);
  }
};

/// `count` of `places`, those that matter most first.
formats::LandmarkFile some_of(const Landmarks& places, size_t count) {
  formats::LandmarkFile given;
  given.units = prepare::head_units;
  for (const char* name : {"exocanthion_left",   "exocanthion_right",
                           "pronasale",          "cheilion_left",
                           "cheilion_right",     "menton",
                           "glabella",           "sellion",
                           "subnasale",          "stomion",
                           "pogonion",           "endocanthion_left",
                           "endocanthion_right", "alare_left",
                           "alare_right",        "tragion_left",
                           "tragion_right",      "zygion_left",
                           "zygion_right",       "gonion_left",
                           "gonion_right"})
    if (const auto at = places.find(name); at != places.end() && given.points.size() < count)
      given.points.insert(*at);
  return given;
}

}  // namespace

void measure_same_head(const std::string& path, const anatomy::GenericAnatomy& anatomy) {
  const formats::Scene scene = formats::read(path);
  const FoundLandmarks first = rigging::find_landmarks(scene, {}, anatomy);
  const Landmarks places = places_of(first);
  const double scale = first.head.input_to_metres.topLeftCorner<3, 1>().norm();
  testing::MadeHead made{path, scene, places, 1e3 * scale};
  made.scene.kind = formats::FileKind::obj;  // the shapes in a glTF's own bytes belong to its own vertices
  const Report report{std::filesystem::path(path).filename(), 1e3 * scale};
  const auto plain = [&](const char* change, const formats::Scene& changed, const Landmarks& expected) {
    report.print(change, expected, [&] { return rigging::find_landmarks(changed, {}, anatomy); });
  };
  for (int pose = 1; pose <= 3; ++pose) {
    const Mat3 turn = Eigen::AngleAxisd(pose < 3 ? 0.15 * pose : 2.5, Vec3(pose, 2 - pose, 1).normalized())
                          .toRotationMatrix();
    const testing::MadeHead moved = testing::moved(made, turn, 1.0, Vec3(3, -2, 1) / scale);
    plain(pose == 1 ? "turned 9" : pose == 2 ? "turned 17" : "turned 143", moved.scene, moved.truth);
  }
  const testing::MadeHead mirrored = testing::mirrored(made);
  plain("mirrored", mirrored.scene, mirrored.truth);
  plain("reordered", testing::reordered(made, 5).scene, places);
  plain("subdivided", testing::subdivided(made).scene, places);
  size_t triangles = 0;
  for (const formats::SceneMesh& mesh : scene.meshes)
    triangles += mesh.triangles.size();
  plain("decimated",
        testing::decimated({path, made.scene, places, 1e3 * scale}, static_cast<int>(triangles / 2)).scene,
        places);
  for (const auto& [change, count] : {std::pair("given 2", size_t{2}), {"given 5", 5}, {"given 20", 20}})
    report.print(change, places,
                 [&] { return rigging::find_landmarks(scene, some_of(places, count), anatomy); });
  // What the file holds most of the face in, and which of its axes points up.
  const formats::SceneMesh* skin = nullptr;
  for (size_t m = 0; m < scene.meshes.size(); ++m)
    for (const prepare::Part part : first.head.meshes[m].parts)
      if (part == prepare::Part::skin && (!skin || scene.meshes[m].positions.size() > skin->positions.size()))
        skin = &scene.meshes[m];
  prepare::PrepareOptions with_skin, with_up;
  if (skin) with_skin.skin = skin->name;
  if (!with_skin.skin.empty() && scene.meshes.size() > 1)
    report.print("--skin", places, [&] { return rigging::find_landmarks(scene, {}, anatomy, with_skin); });
  const Vec3 up = first.head.input_to_metres.topLeftCorner<3, 3>().row(1).transpose().normalized();
  with_up.up = up.y() > 0.9 ? "y" : up.z() > 0.9 ? "z" : "auto";
  if (with_up.up != "auto")
    report.print("--up", places, [&] { return rigging::find_landmarks(scene, {}, anatomy, with_up); });
}

}  // namespace fascia::bench
