// Landmarks found on heads whose landmarks are known: error in millimetres and time, person by person and variant by
// variant. Given files, it prints where the landmarks of those were found instead.
#include <Eigen/Geometry>
#include <chrono>
#include <cstdio>
#include <cstring>
#include <ctime>
#include <functional>

#include "builder/rigging/find_landmarks.h"
#include "tests/landmarks/measured_heads.h"

using namespace fascia;

namespace {

double seconds() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

struct Sums {
  double sum = 0, most = 0;
  int count = 0;
};

void measure(const testing::MeasuredHead& head, const anatomy::GenericAnatomy& anatomy, std::map<std::string, Sums>& by_landmark, Sums& all) {
  const double start = seconds();
  try {
    const rigging::FoundLandmarks found = rigging::find_landmarks(head.scene, {}, anatomy);
    const double time = seconds() - start;
    const Mat4 to_file = found.head.input_to_metres.inverse();
    double sum = 0, most = 0, least = 1;
    std::string worst;
    for (const auto& [name, truth] : head.truth) {
      const double error = head.millimetres * (transform_point(to_file, found.landmarks.at(name).position) - truth).norm();
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
    std::printf("%-48s mean %5.2f max %5.2f mm (%s), least confidence %.2f, %s, %.2f s (head %.2f prepare %.2f landmarks %.2f)\n", head.name.c_str(), sum / static_cast<double>(head.truth.size()),
                most, worst.c_str(), least, found.head.units.c_str(), time, found.seconds[0], found.seconds[1], found.seconds[2]);
  } catch (const std::exception& error) {
    std::printf("%-48s FAILED: %s\n", head.name.c_str(), error.what());
  }
  std::fflush(stdout);
}

void print_file(const std::string& path, const anatomy::GenericAnatomy& anatomy) {
  try {
    const double start = seconds();
    const rigging::FoundLandmarks found = rigging::find_landmarks(formats::read(path), {}, anatomy);
    std::printf("file %s likeness %.3f units %s %.2f s\n", path.c_str(), found.likeness, found.head.units.c_str(), seconds() - start);
    const Mat4 to_file = found.head.input_to_metres.inverse();
    for (const auto& [name, landmark] : found.landmarks) {
      const Vec3 p = transform_point(to_file, landmark.position);
      std::printf("%s %.6g %.6g %.6g %.2f\n", name.c_str(), p[0], p[1], p[2], landmark.confidence);
    }
  } catch (const std::exception& error) {
    std::printf("file %s: %s\n", path.c_str(), error.what());
  }
}

}  // namespace

int main(int argc, char** argv) {
  const anatomy::GenericAnatomy anatomy = anatomy::load_generic();
  if (argc > 1 && std::strcmp(argv[1], "--quick") != 0) {
    for (int a = 1; a < argc; ++a) print_file(argv[a], anatomy);
    return 0;
  }
  using testing::MeasuredHead;
  const bool is_quick = argc > 1;
  const auto turn = [](double x, double y, double z) {
    const double degree = EIGEN_PI / 180;
    return Mat3(Eigen::AngleAxisd(y * degree, Vec3::UnitY()) * Eigen::AngleAxisd(x * degree, Vec3::UnitX()) * Eigen::AngleAxisd(z * degree, Vec3::UnitZ()));
  };
  const std::vector<std::function<MeasuredHead(MeasuredHead)>> variants = {
      [](MeasuredHead h) { return h; },
      [&](MeasuredHead h) { return testing::in_units(testing::moved(std::move(h), turn(25, 35, -15)), 100); },
      [&](MeasuredHead h) { return testing::in_units(testing::moved(std::move(h), turn(-40, -10, 18), Vec3(0.3, -1, 2)), 1000); },
      [](MeasuredHead h) { return testing::decimated(std::move(h), 3000); },
      [](MeasuredHead h) { return testing::subdivided(std::move(h), 2); },
      [](MeasuredHead h) { return testing::noisy(std::move(h), 1.0, 7); },
      [](MeasuredHead h) { return testing::skin_only(std::move(h)); },
      [](MeasuredHead h) { return testing::without_lining(std::move(h)); },
      [](MeasuredHead h) { return testing::with_holes(testing::without_lining(std::move(h)), 9, 14, 3); }};
  std::map<std::string, Sums> by_landmark;
  for (const auto& variant : variants) {
    Sums all;
    for (const char* name : {"neutral", "person_0", "person_1", "person_2", "person_3", "person_4", "person_5"}) {
      if (is_quick && std::string(name) != "person_1" && std::string(name) != "person_3") continue;
      measure(variant(testing::ict_head(name)), anatomy, by_landmark, all);
    }
    if (all.count) std::printf("   all: mean %.2f max %.2f mm\n", all.sum / all.count, all.most);
  }
  for (const auto& [name, s] : by_landmark) std::printf("%-22s mean %.2f max %.2f mm\n", name.c_str(), s.sum / s.count, s.most);
  Sums all;
  std::map<std::string, Sums> body;
  measure(testing::makehuman(), anatomy, body, all);
  for (const auto& [name, s] : body) std::printf("  %-22s %.2f mm\n", name.c_str(), s.most);
}
