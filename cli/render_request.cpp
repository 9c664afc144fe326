#include "cli/render_request.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <sstream>

#include "geometry/error.h"
#include "view/environment.h"
#include "view/video.h"

namespace fascia::cli {

namespace {

/// Numbers with commas between; nothing else may stand there.
std::vector<double> numbers_from(const std::string& text, const std::string& option) {
  std::vector<double> numbers;
  std::istringstream words(text);
  for (std::string word; std::getline(words, word, ',');) {
    char* end = nullptr;
    numbers.push_back(std::strtod(word.c_str(), &end));
    if (word.empty() || *end != 0 || !std::isfinite(numbers.back()))
      throw Error(option + " '" + text + "': '" + word + "' is not a number");
  }
  return numbers;
}

view::Colour colour_from(const std::string& text) {
  if (text == "white") return {255, 255, 255};
  if (text == "black") return {0, 0, 0};
  unsigned r = 0, g = 0, b = 0;
  int length = 0;
  if (text.size() == 7 && std::sscanf(text.c_str(), "#%2x%2x%2x%n", &r, &g, &b, &length) == 3 && length == 7)
    return {static_cast<uint8_t>(r), static_cast<uint8_t>(g), static_cast<uint8_t>(b)};
  throw Error("--background '" + text + "' is unknown: use studio, white, black or #RRGGBB");
}

}  // namespace

PictureSize size_from(const std::string& text) {
  int width = 0, height = 0, length = 0;
  const int found = std::sscanf(text.c_str(), "%d%n", &width, &length);
  bool is_good = found == 1 && length == static_cast<int>(text.size());
  if (is_good)
    height = width;
  else
    is_good = std::sscanf(text.c_str(), "%dx%d%n", &width, &height, &length) == 2 &&
              length == static_cast<int>(text.size());
  if (!is_good) throw Error("--size '" + text + "' is no size: give pixels, 900 or 1280x720");
  if (std::min(width, height) < 16 || std::max(width, height) > 8192)
    throw Error("--size '" + text + "': pictures are 16 to 8192 pixels wide and high");
  return {width, height};
}

view::Look look_from(const RenderRequest& request) {
  view::Look look;
  look.light = request.light;
  view::environment(request.light);  // throws for an unknown one before anything is simulated
  look.samples = request.samples ? request.samples : view::is_film(request.output) ? 2 : 8;
  look.has_backdrop = request.background == "studio";
  look.background = look.has_backdrop ? view::Colour{52, 56, 62} : colour_from(request.background);
  return look;
}

std::vector<std::string> views_from(const std::string& list) {
  std::vector<std::string> views;
  std::istringstream words(list);
  for (std::string word; std::getline(words, word, ',');) {
    view::named_camera(word, Bounds{Vec3(0, 0, 0), Vec3(1, 1, 1)});  // throws for an unknown one
    views.push_back(word);
  }
  if (views.empty()) throw Error("--view is empty: use front, side, right, three-quarter, back or turntable");
  return views;
}

view::Camera camera_for(const std::string& view, const RenderRequest& request, const Bounds& box,
                        PictureSize size) {
  const std::string &adjustment = request.camera, &look_at = request.look_at;
  view::Camera camera = view::named_camera(view, box, 0.98);
  const double aspect = static_cast<double>(size.width) / size.height;
  if (aspect < 1.0) camera.distance /= aspect;  // what is framed by height must fit the width too
  if (!look_at.empty()) {
    const std::vector<double> place = numbers_from(look_at, "--look-at");
    if (place.size() != 4 || !(place[3] > 0.0))
      throw Error("--look-at '" + look_at +
                  "' is not X,Y,Z,DISTANCE: a point in the rig's axes, and how far from it the camera is, in "
                  "metres");
    camera.target = Vec3(place[0], place[1], place[2]);
    camera.distance = place[3];
  }
  if (adjustment.empty()) return camera;
  const std::vector<double> numbers = numbers_from(adjustment, "--camera");
  if (numbers.size() < 2 || numbers.size() > 3 || std::abs(numbers[1]) > 90.0 ||
      (numbers.size() == 3 && !(numbers[2] >= 0.05 && numbers[2] <= 50.0)))
    throw Error("--camera '" + adjustment +
                "' is not YAW,PITCH[,ZOOM]: degrees to the subject's left, degrees up (-90 to 90), times "
                "nearer (0.05 "
                "to 50)");
  camera.yaw += numbers[0];
  camera.pitch += numbers[1];
  if (numbers.size() == 3) camera.distance /= numbers[2];
  return camera;
}

std::optional<Eigen::Vector4d> reveal_from(const std::string& reveal, const Bounds& box) {
  const Vec3 centre = box.centre();
  if (reveal.empty()) return std::nullopt;
  if (reveal == "left") return Eigen::Vector4d(1, 0, 0, centre[0]);
  if (reveal == "right") return Eigen::Vector4d(-1, 0, 0, -centre[0]);
  if (reveal == "top") return Eigen::Vector4d(0, 1, 0, centre[1]);
  if (reveal == "bottom") return Eigen::Vector4d(0, -1, 0, -centre[1]);
  throw Error("--reveal '" + reveal + "' is unknown: use left, right, top or bottom");
}

}  // namespace fascia::cli
