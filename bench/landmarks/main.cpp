// Landmarks found on heads whose landmarks are known: error in millimetres and time, person by person and
// variant by variant (--quick: two of the people; --variant N: one kind alone). Given files, it prints where
// the landmarks of those were found instead;
// --sheet FILE.png draws every kind of head with its landmarks, --sheet FILE.png HEAD... the heads of those
// files;
// --same HEAD... says how far landmarks of changed copies differ, and of those with landmarks, skin or up
// axis given;
// --people COUNT [FIRST [GIVEN]] measures random people of the face model, from seed FIRST (1) on, with the
// first GIVEN (0) of their known landmarks given.
#include <Eigen/Geometry>
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstring>
#include <ctime>
#include <functional>

#include "bench/landmarks/same_head.h"
#include "bench/landmarks/sheet.h"
#include "bench/people/model_person.h"
#include "builder/rigging/find_landmarks.h"
#include "tests/landmarks/made_heads.h"
#include "tests/landmarks/measured_heads.h"

using namespace fascia;

namespace {

double seconds() {
  return static_cast<double>(std::clock()) / CLOCKS_PER_SEC;
}

struct Sums {
  double sum = 0, most = 0;
  int count = 0;
};

void measure(const testing::MeasuredHead& head, const anatomy::GenericAnatomy& anatomy,
             std::map<std::string, Sums>& by_landmark, Sums& all, const formats::LandmarkFile& given = {}) {
  const double start = seconds();
  try {
    const rigging::FoundLandmarks found = rigging::find_landmarks(head.scene, given, anatomy);
    const double time = seconds() - start;
    const Mat4 to_file = found.head.input_to_metres.inverse();
    double sum = 0, most = 0, least = 1;
    std::string worst;
    for (const auto& [name, truth] : head.truth) {
      Vec3 position = found.landmarks.at(name).position;
      if (head.name != "makehuman")
        position += testing::offset_of_definition(name, *anatomy.landmark(name)->skin);
      const double error = head.millimetres * (transform_point(to_file, position) - truth).norm();
      least = std::min(least, found.landmarks.at(name).confidence);
      sum += error;
      if (error > most) worst = name;
      most = std::max(most, error);
      Sums& one = by_landmark[name];
      for (Sums* s : {&one, &all}) {
        s->sum += error;
        s->most = std::max(s->most, error);
        ++s->count;
      }
    }
    std::printf(
        "%-48s likeness %.2f mean %5.2f max %5.2f mm (%s), least confidence %.2f, %s, %.2f s (head %.2f "
        "prepare %.2f "
        "landmarks %.2f)\n",
        head.name.c_str(), found.likeness, sum / static_cast<double>(head.truth.size()), most, worst.c_str(),
        least, found.head.units.c_str(), time, found.seconds[0], found.seconds[1], found.seconds[2]);
  } catch (const std::exception& error) {
    std::printf("%-48s FAILED: %s\n", head.name.c_str(), error.what());
  }
  std::fflush(stdout);
}

void print_file(const std::string& path, const anatomy::GenericAnatomy& anatomy) {
  try {
    const double start = seconds();
    const rigging::FoundLandmarks found = rigging::find_landmarks(formats::read(path), {}, anatomy);
    std::printf("file %s likeness %.3f units %s %.2f s\n", path.c_str(), found.likeness,
                found.head.units.c_str(), seconds() - start);
    const Mat4 to_file = found.head.input_to_metres.inverse();
    for (const auto& [name, landmark] : found.landmarks) {
      const Vec3 p = transform_point(to_file, landmark.position);
      std::printf("%s %.6g %.6g %.6g %.2f\n", name.c_str(), p[0], p[1], p[2], landmark.confidence);
    }
  } catch (const std::exception& error) {
    std::printf("file %s: %s\n", path.c_str(), error.what());
  }
}

testing::MeasuredHead stretched(testing::MeasuredHead head, const std::string& name,
                                const std::function<Vec3(const Vec3&)>& change) {
  head.name = name;
  for (formats::SceneMesh& mesh : head.scene.meshes)
    for (Vec3& p : mesh.positions)
      p = change(p);
  return head;
}

/// The contact sheet of docs/heads.md.
void draw_sheet(const std::string& path, const anatomy::GenericAnatomy& anatomy) {
  using namespace testing;
  const Mat3 upside_down = Eigen::AngleAxisd(EIGEN_PI, Vec3::UnitZ()).toRotationMatrix();
  const Mat3 away = Eigen::AngleAxisd(2.8, Vec3(0.2, 1, 0.1).normalized()).toRotationMatrix();
  MeasuredHead embedded;
  embedded.name = "the embedded head";
  for (const anatomy::MeshObject& object : anatomy.head) {
    formats::SceneMesh mesh;
    mesh.name = object.name;
    mesh.positions = object.mesh.vertices;
    mesh.triangles = object.mesh.triangles;
    embedded.scene.meshes.push_back(mesh);
  }
  const auto named = [](MeasuredHead head, const char* name) {
    head.name = name;
    return head;
  };
  std::vector<MeasuredHead> heads = {embedded, named(ict_head("neutral"), "mean head")};
  for (int p = 0; p < 6; ++p)
    heads.push_back(named(ict_head("person_" + std::to_string(p)), ("person " + std::to_string(p)).c_str()));
  heads.push_back(named(in_units(moved(ict_head("person_0"), upside_down), 100), "upside down, cm"));
  heads.push_back(named(in_units(moved(ict_head("person_1"), away, Vec3(0, 1, 2)), 1000), "turned away, mm"));
  heads.push_back(named(decimated(ict_head("person_5"), 3000), "3000 triangles"));
  heads.push_back(named(noisy(ict_head("person_4"), 1.0, 7), "1 mm of noise"));
  heads.push_back(named(skin_only(ict_head("person_2")), "no eyes, no teeth"));
  heads.push_back(named(without_lining(ict_head("person_3")), "no lining"));
  heads.push_back(named(in_units(moved(face_alone(ict_head("person_2"), 95), away), 1000), "a face alone"));
  heads.push_back(named(cut_above_brows(ict_head("person_4")), "cut above the brows"));
  heads.push_back(named(with_holes(without_lining(ict_head("person_0")), 9, 14, 3), "holes"));
  heads.push_back(stretched(ict_head("person_0"), "as a child", testing::as_child));
  heads.push_back(stretched(ict_head("person_0"), "large eyes", testing::with_large_eyes));
  heads.push_back(named(makehuman(), "head of a body"));
  for (const auto& [file, caption] : {std::pair("ct/headsq_skin.ply", "CT, no forehead"),
                                      std::pair("bodyparts3d/skin.obj", "BodyParts3D")}) {
    MeasuredHead scan;
    scan.name = caption;
    scan.scene = formats::read(measured_data() / file);
    heads.push_back(scan);
  }
  std::vector<view::Tile> tiles;
  int turned = 0;
  for (const MeasuredHead& head : heads) {
    try {
      tiles.push_back(bench::landmark_tile(rigging::find_landmarks(head.scene, {}, anatomy), head.name,
                                           turned++ % 2 ? 32 : 0));
    } catch (const std::exception& error) {
      std::printf("%s: %s\n", head.name.c_str(), error.what());
    }
  }
  view::write_png(path, view::contact_sheet(tiles, 5));
}

/// The heads of files, each from the front and from the side, with what was found in it.
void draw_files(const std::string& path, const std::vector<std::string>& files,
                const anatomy::GenericAnatomy& anatomy) {
  std::vector<view::Tile> tiles;
  for (const std::string& file : files) {
    const std::string name = std::filesystem::path(file).filename();
    try {
      const double start = seconds();
      const rigging::FoundLandmarks found = rigging::find_landmarks(formats::read(file), {}, anatomy);
      std::printf("%-24s likeness %.3f units %s %.2f s\n", name.c_str(), found.likeness,
                  found.head.units.c_str(), seconds() - start);
      for (double yaw : {0.0, 50.0})
        tiles.push_back(bench::landmark_tile(found, name, yaw));
    } catch (const std::exception& error) {
      std::printf("%-24s FAILED: %s\n", name.c_str(), error.what());
    }
    std::fflush(stdout);
  }
  view::write_png(path, view::contact_sheet(tiles, 6));
}

/// `count` of the landmarks that are known of `head`, those that matter most first; as our definitions have
/// them.
formats::LandmarkFile some_given(const testing::MeasuredHead& head, size_t count,
                                 const anatomy::GenericAnatomy& anatomy) {
  std::vector<std::string> order = {"exocanthion_left", "exocanthion_right", "pronasale",
                                    "cheilion_left",    "cheilion_right",    "menton"};
  for (const auto& [name, p] : head.truth)
    if (std::find(order.begin(), order.end(), name) == order.end()) order.push_back(name);
  formats::LandmarkFile given;
  for (const std::string& name : order)
    if (const auto at = head.truth.find(name); at != head.truth.end() && given.points.size() < count)
      given.points[name] = at->second - testing::offset_of_definition(name, *anatomy.landmark(name)->skin) *
                                            (1e3 / head.millimetres);
  return given;
}

/// Mean and worst person of `count` random ones, by the mean error of their landmarks.
void measure_people(uint32_t first, uint32_t count, size_t given, const anatomy::GenericAnatomy& anatomy) {
  const bench::FaceModel model;
  const auto vertices = testing::ict_model_vertices();
  Sums all;
  double worst = 0;
  for (uint32_t seed = first; seed < first + count; ++seed) {
    testing::MeasuredHead head;
    head.name = "seed " + std::to_string(seed);
    head.scene = model.scene(seed);
    for (const auto& [name, vertex] : vertices)
      head.truth[name] = head.scene.meshes[0].positions[static_cast<size_t>(vertex)];
    std::map<std::string, Sums> by_landmark;
    Sums one;
    measure(head, anatomy, by_landmark, one, some_given(head, given, anatomy));
    if (one.count) worst = std::max(worst, one.sum / one.count);
    all.sum += one.sum;
    all.count += one.count;
  }
  if (all.count)
    std::printf("%u people: mean %.2f mm, worst person %.2f mm\n", count, all.sum / all.count, worst);
}

}  // namespace

int main(int argc, char** argv) {
  const anatomy::GenericAnatomy anatomy = anatomy::load_generic();
  if (argc > 2 && std::strcmp(argv[1], "--sheet") == 0) {
    if (argc > 3)
      draw_files(argv[2], std::vector<std::string>(argv + 3, argv + argc), anatomy);
    else
      draw_sheet(argv[2], anatomy);
    return 0;
  }
  if (argc > 2 && std::strcmp(argv[1], "--same") == 0) {
    for (int a = 2; a < argc; ++a)
      bench::measure_same_head(argv[a], anatomy);
    return 0;
  }
  if (argc > 2 && std::strcmp(argv[1], "--people") == 0) {
    measure_people(argc > 3 ? static_cast<uint32_t>(std::atoi(argv[3])) : 1,
                   static_cast<uint32_t>(std::atoi(argv[2])),
                   argc > 4 ? static_cast<size_t>(std::atoi(argv[4])) : 0, anatomy);
    return 0;
  }
  const bool is_one_variant = argc > 2 && std::strcmp(argv[1], "--variant") == 0;
  if (argc > 1 && std::strcmp(argv[1], "--quick") != 0 && !is_one_variant) {
    for (int a = 1; a < argc; ++a)
      print_file(argv[a], anatomy);
    return 0;
  }
  using testing::MeasuredHead;
  const bool is_quick = argc > 1 && !is_one_variant;
  const auto turn = [](double x, double y, double z) {
    const double degree = EIGEN_PI / 180;
    return Mat3(Eigen::AngleAxisd(y * degree, Vec3::UnitY()) * Eigen::AngleAxisd(x * degree, Vec3::UnitX()) *
                Eigen::AngleAxisd(z * degree, Vec3::UnitZ()));
  };
  const std::vector<std::function<MeasuredHead(MeasuredHead)>> variants = {
      [](MeasuredHead h) { return h; },
      [&](MeasuredHead h) { return testing::in_units(testing::moved(std::move(h), turn(25, 35, -15)), 100); },
      [&](MeasuredHead h) {
        return testing::in_units(testing::moved(std::move(h), turn(-40, -10, 18), Vec3(0.3, -1, 2)), 1000);
      },
      [](MeasuredHead h) { return testing::decimated(std::move(h), 3000); },
      [](MeasuredHead h) { return testing::subdivided(std::move(h), 2); },
      [](MeasuredHead h) { return testing::noisy(std::move(h), 1.0, 7); },
      [](MeasuredHead h) { return testing::skin_only(std::move(h)); },
      [](MeasuredHead h) { return testing::without_lining(std::move(h)); },
      [](MeasuredHead h) { return testing::with_holes(testing::without_lining(std::move(h)), 9, 14, 3); },
      [&](MeasuredHead h) {
        return testing::in_units(testing::moved(testing::face_alone(std::move(h), 95), turn(-30, 130, 70)),
                                 1000);
      },
      [](MeasuredHead h) { return testing::face_alone(std::move(h), 85); },
      [&](MeasuredHead h) {
        return testing::in_units(testing::moved(testing::cut_above_brows(std::move(h)), turn(80, -60, 10)),
                                 100);
      }};
  std::map<std::string, Sums> by_landmark;
  for (size_t v = 0; v < variants.size(); ++v) {
    if (is_one_variant && v != static_cast<size_t>(std::atoi(argv[2]))) continue;
    const auto& variant = variants[v];
    Sums all;
    for (const char* name :
         {"neutral", "person_0", "person_1", "person_2", "person_3", "person_4", "person_5"}) {
      if (is_quick && std::string(name) != "person_1" && std::string(name) != "person_3") continue;
      measure(variant(testing::ict_head(name)), anatomy, by_landmark, all);
    }
    if (all.count) std::printf("   all: mean %.2f max %.2f mm\n", all.sum / all.count, all.most);
  }
  for (const auto& [name, s] : by_landmark)
    std::printf("%-22s mean %.2f max %.2f mm\n", name.c_str(), s.sum / s.count, s.most);
  Sums all;
  std::map<std::string, Sums> body;
  measure(testing::makehuman(), anatomy, body, all);
  for (const auto& [name, s] : body)
    std::printf("  %-22s %.2f mm\n", name.c_str(), s.most);
}
