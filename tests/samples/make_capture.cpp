// Writes what the capture sample plays: make_capture TOOL FOLDER makes FOLDER/embedded.glb, the embedded
// head's rig at low detail, and FOLDER/stream.csv, landmarks of a take of it by its own simulation
// (samples/capture).
#include <Eigen/Geometry>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <random>

#include "cli/embedded_head.h"
#include "fit/live/head_pose.h"
#include "fit/live/landmark.h"
#include "fit/live/landmark_sets.h"
#include "fit/subject.h"
#include "formats/scene.h"

namespace fascia {
namespace {

std::vector<float> values_at(const fit::Subject& subject, double seconds) {
  std::vector<float> values;
  for (const rig::Channel& channel : subject.channels())
    values.push_back(channel.rest);
  const auto set = [&](const char* name, double size, double speed, double phase) {
    const double value = size * std::sin(speed * seconds + phase) * std::min(1.0, 2.0 * seconds);
    values.at(static_cast<size_t>(subject.channel(name))) = static_cast<float>(std::max(0.0, value));
  };
  set("jaw_open", 0.4, 5.0, 0.0);
  set("zygomaticus_major_superior_left", 0.8, 2.3, 1.0);
  set("zygomaticus_major_superior_right", 0.6, 2.3, 0.8);
  set("frontalis_medial_left", 0.7, 3.9, 0.0);
  set("frontalis_medial_right", 0.7, 3.9, 0.2);
  set("corrugator_supercilii_transverse_left", 0.6, 2.1, 3.5);
  set("corrugator_supercilii_transverse_right", 0.6, 2.1, 3.5);
  return values;
}

bool is_of_mouth(const std::string& name) {
  for (const char* part : {"labiale", "crista", "cheilion", "menton"})
    if (name.rfind(part, 0) == 0) return true;
  return false;
}

void write_stream(fit::Subject& subject, const std::filesystem::path& path) {
  constexpr int frames = 60;
  constexpr double rate = 24.0, noise_metres = 3e-4;
  const fit::LandmarkSet set = fit::find_landmark_set("ibug68").value();
  std::ofstream file(path);
  file << "time";
  for (size_t p = 0; p < set.points; ++p)
    file << ",x" << p << ",y" << p << ",z" << p;
  file << '\n';
  std::mt19937 random(1);
  std::normal_distribution<double> noise(0.0, noise_metres / std::sqrt(3.0));
  for (int frame = 0; frame < frames; ++frame) {
    const double seconds = frame / rate;
    subject.pose(values_at(subject, seconds), frame > 0);
    const fit::HeadPose head{(Eigen::AngleAxisd(0.3 * std::sin(2.0 * seconds), Vec3::UnitY()) *
                              Eigen::AngleAxisd(0.1 * std::sin(3.0 * seconds), Vec3::UnitX()))
                                 .toRotationMatrix(),
                             Vec3(0.02 * std::sin(seconds), 0.0, 0.4), 1.0};
    std::vector<std::string> fields(set.points, ",,,");
    for (const fit::LandmarkSet::Entry& entry : set.entries) {
      const auto place = fit::place_of_landmark(subject.file(), 0, entry.landmark);
      if (!place || (frame >= 30 && frame < 42 && is_of_mouth(entry.landmark))) continue;
      const fit::Landmark landmark = fit::landmark_at(subject.file(), 0, *place);
      Vec3 at = landmark.rest;
      for (const auto& [node, weight] : landmark.influences)
        at += weight * (subject.nodes()[node] - subject.model().rest()[node]);
      const Vec3 seen = 1e3 * (head * (at + Vec3(noise(random), noise(random), noise(random))));
      char text[64];
      std::snprintf(text, sizeof text, ",%.2f,%.2f,%.2f", seen.x(), seen.y(), seen.z());
      for (const uint32_t point : entry.points)
        fields[point] = text;
    }
    char time[32];
    std::snprintf(time, sizeof time, "%.4f", seconds);
    file << time;
    for (const std::string& field : fields)
      file << field;
    file << '\n';
  }
}

}  // namespace
}  // namespace fascia

int main(int argc, char** argv) {
  using namespace fascia;
  if (argc != 3) return 2;
  const std::filesystem::path folder = argv[2];
  cli::write_embedded_head(folder / "embedded.obj", folder / "embedded_landmarks.json");
  const auto at = [&](const char* name) { return (folder / name).string(); };
  const std::string command = std::string(argv[1]) + " build " + at("embedded.obj") + " --landmarks " +
                              at("embedded_landmarks.json") + " --detail low -o " + at("embedded.glb") +
                              " --quiet";
  if (std::system(command.c_str()) != 0) return 1;
  fit::Subject subject(rig::read(formats::read_bytes(folder / "embedded.glb")), "low");
  write_stream(subject, folder / "stream.csv");
  return 0;
}
