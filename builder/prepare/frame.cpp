#include "builder/prepare/frame.h"

#include <Eigen/Geometry>
#include <array>
#include <cmath>
#include <cstdio>
#include <string_view>
#include <utility>

#include "builder/spatial/surface_query.h"
#include "geometry/alignment.h"
#include "geometry/error.h"

namespace fascia::prepare {

namespace {

struct Unit {
  const char* name;
  double metres;
};
constexpr std::array<Unit, 5> known_units = {
    {{"m", 1.0}, {"dm", 0.1}, {"cm", 0.01}, {"mm", 0.001}, {"in", 0.0254}}};

double declared_metres(const std::string& units) {
  for (const Unit& unit : known_units)
    if (units == unit.name) return unit.metres;
  char* end = nullptr;
  const double value = std::strtod(units.c_str(), &end);
  if (*end == 0 && std::isfinite(value) && value > 0) return value;
  throw Error("units '" + units +
              "' are unknown: give auto, m, cm, mm or the metres of one unit as a number");
}

std::string as_text(double number) {
  char text[32];
  std::snprintf(text, sizeof text, "%.6g", number);
  return text;
}

std::string unit_name(double metres) {
  for (const Unit& unit : known_units)
    if (std::abs(std::log(metres / unit.metres)) < 1e-9) return unit.name;
  return as_text(metres);
}

struct Similarity {
  double scale = 1.0;
  Mat3 rotation = Mat3::Identity();
};

/// Least-squares similarity that carries `from` onto `to` (Umeyama 1991).
Similarity procrustes(const std::vector<Vec3>& from, const std::vector<Vec3>& to) {
  const Mat4 map = similarity(from, to);
  Similarity result;
  result.scale = map.topLeftCorner<3, 1>().norm();
  result.rotation = map.topLeftCorner<3, 3>() / result.scale;
  return result;
}

/// The axis permutation with signs that is nearest to `rotation`.
Mat3 nearest_axes(const Mat3& rotation) {
  Mat3 axes = Mat3::Zero();
  Mat3 left = rotation;
  for (int round = 0; round < 3; ++round) {
    Eigen::Index row, column;
    left.cwiseAbs().maxCoeff(&row, &column);
    axes(row, column) = left(row, column) > 0 ? 1.0 : -1.0;
    left.row(row).setZero();
    left.col(column).setZero();
  }
  return axes;
}

bool are_collinear(const std::vector<Vec3>& points) {
  const Vec3 spread = principal_axes(scatter(points)).values;
  return spread[1] < 1e-6 * spread[2];
}

double snapped_unit(double scale, std::vector<std::string>& warnings) {
  for (const Unit& unit : known_units)
    if (std::abs(std::log(scale / unit.metres)) < std::log(1.45)) return unit.metres;
  warnings.push_back(
      "the landmarks fit none of m, dm, cm, mm and inch; the head was scaled to adult size (one unit = " +
      as_text(scale) + " m); give --units to set it");
  return scale;
}

/// Warns of given units that make a head another size than people's, and throws when it is out of all reason.
double checked_unit(const std::string& file, double metres, double scale,
                    std::vector<std::string>& warnings) {
  const double times = metres / scale;
  if (times > 0.5 && times < 2.0) return metres;
  const std::string what = "the units given make the head " + as_text(times) +
                           " times the size of an adult's, whose unit would be " + as_text(scale) +
                           " m; correct --units, or leave it out";
  if (times < 0.125 || times > 8.0) throw Error("'" + file + "': " + what);
  warnings.push_back(what);
  return metres;
}

Mat4 compose(double scale, const Mat3& rotation) {
  Mat4 map = Mat4::Identity();
  map.topLeftCorner<3, 3>() = scale * rotation;
  return map;
}

/// The name of the other side's landmark; the same for one of the midline.
std::string of_other_side(const std::string& name) {
  for (const auto& [side, other] : {std::pair{"_left", "_right"}, {"_right", "_left"}})
    if (const size_t length = std::string_view(side).size();
        name.size() > length && name.compare(name.size() - length, length, side) == 0)
      return name.substr(0, name.size() - length) + other;
  return name;
}

/// Root mean square of what the best similarity from `from` to `to` leaves, in units of `to`.
double left_over(const std::vector<Vec3>& from, const std::vector<Vec3>& to) {
  const Mat4 map = similarity(from, to);
  double sum = 0.0;
  for (size_t i = 0; i < from.size(); ++i)
    sum += (transform_point(map, from[i]) - to[i]).squaredNorm();
  return std::sqrt(sum / static_cast<double>(from.size()));
}

/// Landmarks that fit no head as they are named, and one when left is called right: nothing built on them
/// would be where it belongs. `reference` in metres.
void refuse_exchanged_sides(const std::string& file, const Landmarks& given, const Landmarks& reference) {
  constexpr double too_far = 0.012, much_better = 0.5;  // metres; share
  std::vector<Vec3> here, named, exchanged;
  for (const auto& [name, p] : given) {
    const auto own = reference.find(name), other = reference.find(of_other_side(name));
    if (own == reference.end() || other == reference.end()) continue;
    here.push_back(p);
    named.push_back(own->second);
    exchanged.push_back(other->second);
  }
  if (here.size() < 6) return;
  const double as_named = left_over(here, named);
  if (as_named > too_far && left_over(here, exchanged) < much_better * as_named)
    throw Error("'" + file +
                "': the landmarks call left what is right: left is the subject's own; exchange the sides");
}

Frame from_landmarks(const formats::Scene& scene, const formats::LandmarkFile& given,
                     const Landmarks& reference, const PrepareOptions& options) {
  Frame frame;
  frame.landmarks = in_file_units(scene, given).points;
  std::vector<Vec3> here, generic;
  for (const auto& [name, p] : frame.landmarks)
    if (const auto known = reference.find(name); known != reference.end()) {
      here.push_back(p);
      generic.push_back(known->second);
    }
  if (here.size() < 3 || are_collinear(here))
    throw Error(
        "'" + scene.path.string() + "': " + std::to_string(here.size()) +
        " landmarks with known names do not fix size and facing; give at least three that are not in a line");
  refuse_exchanged_sides(scene.path.string(), frame.landmarks, reference);
  const Similarity fit = procrustes(here, generic);
  const double metres =
      options.units == "auto"
          ? snapped_unit(fit.scale, frame.warnings)
          : checked_unit(scene.path.string(), declared_metres(options.units), fit.scale, frame.warnings);
  // A head that stands along the axes keeps them to the last digit. One that is turned or tilted is set
  // upright, for what follows tells up and front from the axes: so it gets the same rig whichever way it
  // looks.
  const Mat3 axes = nearest_axes(fit.rotation);
  const double angle = Eigen::AngleAxisd(Mat3(fit.rotation * axes.transpose())).angle();
  const bool is_upright = axes.determinant() > 0 && angle < 5.0 * EIGEN_PI / 180.0;
  frame.input_to_metres = compose(metres, is_upright ? axes : fit.rotation);
  frame.units = unit_name(metres);
  return frame;
}

/// One unit in metres for something `height` units high: a head or bust is 0.18 to 0.6 m, a body about 1.7 m.
double likely_unit(double height) {
  double best = 1e300, metres = 1.0;
  for (const Unit& unit : known_units)
    for (double expected : {0.3, 1.7}) {
      const double off = std::abs(std::log(height * unit.metres / expected));
      if (off < best) {
        best = off;
        metres = unit.metres;
      }
    }
  return metres;
}

Frame from_convention(const formats::Scene& scene, const PrepareOptions& options) {
  Frame frame;
  const Vec3 size = bounds(joined_meshes(scene).vertices).size();
  const bool is_gltf = scene.kind == formats::FileKind::glb || scene.kind == formats::FileKind::gltf;
  const bool z_up = options.up == "z" || (options.up == "auto" && !is_gltf && size[2] > 1.4 * size[1]);
  Mat3 axes = Mat3::Identity();
  // Z up faces along -Y (3D Slicer, Blender): left stays +X.
  if (z_up) axes << 1, 0, 0, 0, 0, 1, 0, -1, 0;
  const double metres =
      options.units == "auto" ? likely_unit(z_up ? size[2] : size[1]) : declared_metres(options.units);
  frame.input_to_metres = compose(metres, axes);
  frame.units = unit_name(metres);
  return frame;
}

}  // namespace

TriangleMesh joined_meshes(const formats::Scene& scene, const std::string& only) {
  TriangleMesh all;
  std::string known;
  for (const formats::SceneMesh& mesh : scene.meshes) {
    known += (known.empty() ? "" : ", ") + mesh.name;
    if (!only.empty() && mesh.name != only) continue;
    const int base = all.vertex_count();
    all.vertices.insert(all.vertices.end(), mesh.positions.begin(), mesh.positions.end());
    for (const Triangle& t : mesh.triangles)
      all.triangles.push_back({t[0] + base, t[1] + base, t[2] + base});
  }
  if (!only.empty() && all.empty())
    throw Error("'" + scene.path.string() + "' has no mesh '" + only + "'; it has: " + known);
  return all;
}

formats::LandmarkFile in_file_units(const formats::Scene& scene, const formats::LandmarkFile& given) {
  if (given.points.empty() || given.units == head_units) return given;
  const spatial::SurfaceQuery surface(joined_meshes(scene));
  double best = 1e300, ratio = 1.0;
  for (double candidate : {1.0, 1e-3, 1e3, 1e-2, 1e2, 1e-1, 1e1}) {
    double sum = 0.0;
    for (const auto& [name, p] : given.points)
      sum += surface.nearest_place(candidate * p - scene.offset).distance;
    if (sum < 0.5 * best) {
      best = sum;
      ratio = candidate;
    }
  }
  formats::LandmarkFile file = given;
  for (auto& [name, p] : file.points)
    p = ratio * p - scene.offset;
  return file;
}

Frame find_frame(const formats::Scene& scene, const formats::LandmarkFile& given, const Landmarks& reference,
                 const PrepareOptions& options) {
  if (options.up != "auto" && options.up != "y" && options.up != "z")
    throw Error("up axis '" + options.up + "' is unknown: give auto, y or z");
  return given.points.empty() ? from_convention(scene, options)
                              : from_landmarks(scene, given, reference, options);
}

}  // namespace fascia::prepare
