#include "app/model/sketch.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "builder/muscles/muscles.h"
#include "builder/rigging/edits.h"
#include "geometry/error.h"

namespace fascia::app {

namespace {

constexpr double curve_step = 0.002;  ///< metres
constexpr size_t most_curve_points = 64;

const nlohmann::ordered_json* sketch_entry(const DocumentState& state, const std::string& muscle,
                                           MuscleEnd end) {
  const auto& edits = state.edits;
  const auto list = edits.find("muscles");
  if (list == edits.end() || !list->is_object()) return nullptr;
  const auto item = list->find(muscle);
  if (item == list->end() || !item->is_object()) return nullptr;
  const auto region = item->find(name_of(end));
  return region == item->end() || !region->is_object() ? nullptr : &*region;
}

double length_of(const std::vector<Vec3>& line) {
  double length = 0.0;
  for (size_t i = 1; i < line.size(); ++i)
    length += (line[i] - line[i - 1]).norm();
  return length;
}

/// `count` points at even distances along the line, its first and last among them.
std::vector<Vec3> evened(const std::vector<Vec3>& line, size_t count) {
  const double step = length_of(line) / static_cast<double>(count - 1);
  std::vector<Vec3> points = {line.front()};
  double passed = 0.0;
  for (size_t i = 1; i < line.size() && points.size() + 1 < count; ++i) {
    const double piece = (line[i] - line[i - 1]).norm();
    while (points.size() + 1 < count) {
      const double wanted = step * static_cast<double>(points.size());
      if (wanted > passed + piece) break;
      points.push_back(line[i - 1] + (wanted - passed) / std::max(piece, 1e-12) * (line[i] - line[i - 1]));
    }
    passed += piece;
  }
  points.push_back(line.back());
  return points;
}

/// Without what lies beyond the place where the first and the last sixth meet.
std::vector<Vec3> cut_where_ends_meet(const std::vector<Vec3>& line) {
  const size_t sixth = line.size() / 6;
  double nearest = curve_step;
  size_t first = 0, last = line.size() - 1;
  for (size_t i = 0; i < sixth; ++i)
    for (size_t j = line.size() - sixth; j < line.size(); ++j)
      if (const double distance = (line[i] - line[j]).norm(); distance < nearest) {
        nearest = distance;
        first = i;
        last = j;
      }
  return {line.begin() + static_cast<std::ptrdiff_t>(first),
          line.begin() + static_cast<std::ptrdiff_t>(last) + 1};
}

}  // namespace

Mat4 edits_to_metres(const DocumentState& state, const Mat4& head_to_metres) {
  const auto units = state.edits.find("units");
  if (units == state.edits.end()) return head_to_metres;
  const bool is_word = units->is_string();
  if (is_word && *units != "m" && *units != "cm" && *units != "mm") return head_to_metres;
  if (!is_word && (!units->is_number() || units->get<double>() <= 0.0)) return head_to_metres;
  Mat4 scale = Mat4::Identity();
  scale.topLeftCorner<3, 3>() *=
      rigging::unit_ratio(is_word ? units->get<std::string>() : units->dump(), head_to_metres);
  return head_to_metres * scale;
}

const char* name_of(MuscleEnd end) {
  return end == MuscleEnd::origin ? "origin" : "insertion";
}

std::vector<Vec3> muscle_sketch(const DocumentState& state, const std::string& muscle, MuscleEnd end,
                                const Mat4& head_to_metres) {
  std::vector<Vec3> curve;
  const auto* entry = sketch_entry(state, muscle, end);
  if (!entry) return curve;
  const Mat4 to_metres = edits_to_metres(state, head_to_metres);
  for (const char* key : {"curve", "points"}) {
    if (!entry->contains(key) || !(*entry)[key].is_array()) continue;
    for (const auto& p : (*entry)[key]) {
      const bool is_point =
          p.is_array() && p.size() == 3 && p[0].is_number() && p[1].is_number() && p[2].is_number();
      if (is_point)
        curve.push_back(
            transform_point(to_metres, Vec3(p[0].get<double>(), p[1].get<double>(), p[2].get<double>())));
    }
  }
  return curve;
}

void set_muscle_sketch(DocumentState& state, const std::string& muscle, MuscleEnd end,
                       const std::vector<Vec3>& curve, const Mat4& head_to_metres) {
  nlohmann::ordered_json entry;
  if (!curve.empty()) {
    const Mat4 from_metres = edits_to_metres(state, head_to_metres).inverse();
    nlohmann::ordered_json points = nlohmann::ordered_json::array();
    for (const Vec3& p : curve) {
      const Vec3 in_file = transform_point(from_metres, p);
      points.push_back({in_file[0], in_file[1], in_file[2]});
    }
    entry = {{"curve", std::move(points)}};
  }
  set_muscle_entry(state, muscle, name_of(end), entry);
}

size_t count_sketches(const DocumentState& state) {
  size_t count = 0;
  const auto muscles = state.edits.find("muscles");
  if (muscles == state.edits.end() || !muscles->is_object()) return 0;
  for (const auto& [name, entry] : muscles->items())
    for (const MuscleEnd end : {MuscleEnd::origin, MuscleEnd::insertion})
      if (entry.is_object() && entry.contains(name_of(end))) ++count;
  return count;
}

std::vector<Vec3> closed_curve(const std::vector<Vec3>& stroke) {
  if (stroke.size() < 3) return stroke;
  const double fine = 0.25 * curve_step;
  const auto count_at = [](double length, double step, size_t most) {
    return std::clamp(static_cast<size_t>(std::ceil(length / step)), size_t{4}, most);
  };
  std::vector<Vec3> line =
      cut_where_ends_meet(evened(stroke, count_at(length_of(stroke), fine, 4 * most_curve_points)));
  line.push_back(line.front());
  const double length = length_of(line);
  line = evened(line, count_at(length, curve_step, most_curve_points) + 1);
  line.pop_back();  // the first again
  return line;
}

std::string sketch_fault(const std::vector<Vec3>& curve) {
  try {
    muscles::check_sketch({curve, true}, "This curve");
    return "";
  } catch (const Error& error) {
    return error.what();
  }
}

}  // namespace fascia::app
