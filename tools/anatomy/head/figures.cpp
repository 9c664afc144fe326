#include "tools/anatomy/head/figures.h"

#include <algorithm>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "geometry/error.h"

namespace fascia::head_maker {

double Profile::at(const std::string& name) const {
  const auto mark = marks.find(name);
  if (mark == marks.end()) throw Error("head_profiles.csv: a profile has no point named " + name);
  double s = 0.0;
  for (int i = 1; i <= mark->second; ++i)
    s += (points[i] - points[i - 1]).norm();
  return s;
}

double Profile::length() const {
  double s = 0.0;
  for (std::size_t i = 1; i < points.size(); ++i)
    s += (points[i] - points[i - 1]).norm();
  return s;
}

Vec3 Profile::point(double s) const {
  for (std::size_t i = 1; i < points.size(); ++i) {
    const double step = (points[i] - points[i - 1]).norm();
    if (s <= step && step > 0.0)
      return points[i - 1] + (points[i] - points[i - 1]) * (std::max(s, 0.0) / step);
    s -= step;
  }
  return points.back();
}

namespace {

std::vector<std::vector<std::string>> read_csv(const std::string& path) {
  std::ifstream file(path);
  if (!file) throw Error(path + ": cannot be read; give the folder anatomy/figures");
  std::vector<std::vector<std::string>> rows;
  bool header = true;
  for (std::string line; std::getline(file, line);) {
    if (line.empty() || line[0] == '#') continue;
    if (header) {
      header = false;
      continue;
    }
    std::vector<std::string> row;
    std::istringstream cells(line);
    for (std::string cell; std::getline(cells, cell, ',');)
      row.push_back(cell);
    rows.push_back(std::move(row));
  }
  return rows;
}

Vec3 vector_of(const std::vector<std::string>& row, int first) {
  return {std::stod(row[first]), std::stod(row[first + 1]), std::stod(row[first + 2])};
}

Vec3 vector_of(const nlohmann::json& json) {
  return {json[0].get<double>(), json[1].get<double>(), json[2].get<double>()};
}

}  // namespace

Figures read_figures(const std::string& folder) {
  Figures out;
  for (const auto& row : read_csv(folder + "/head_profiles.csv")) {
    auto& fan = out.fans[row[0]];
    const std::size_t index = std::stoul(row[1]);
    if (fan.size() <= index) fan.resize(index + 1);
    if (row.size() > 5 && !row[5].empty())
      fan[index].marks[row[5]] = static_cast<int>(fan[index].points.size());
    fan[index].points.push_back(vector_of(row, 2));
  }
  for (const auto& row : read_csv(folder + "/head_sections.csv")) {
    Sample sample{vector_of(row, 2), vector_of(row, 5).normalized(), 0.0};
    const Vec3& p = sample.position;
    const bool face = p.z() > 78 && p.y() > -82 && p.y() < 68 && p.x() < 62;
    const bool nose_and_lips = p.z() > 95 && p.y() > -52 && p.y() < 32 && p.x() < 26;
    sample.spacing = nose_and_lips ? 2.0 : face ? 3.0 : 6.0;
    out.sections.push_back(sample);
  }
  std::ifstream file(folder + "/head_figures.json");
  if (!file) throw Error(folder + "/head_figures.json: cannot be read");
  const auto json = nlohmann::json::parse(file);
  for (const auto& [name, point] : json.at("landmarks").items())
    out.landmarks[name] = vector_of(point);
  out.eye_centre = vector_of(json.at("eyeball").at("centre_left"));
  out.eye_radius = json.at("eyeball").at("radius");
  out.cornea_front = json.at("eyeball").at("cornea_front");
  for (const auto& slice : json.at("mouth_slices_z_halfwidth_bottom_top"))
    out.mouth_slices.emplace_back(slice[0].get<double>(), slice[1].get<double>(), slice[2].get<double>(),
                                  slice[3].get<double>());
  return out;
}

}  // namespace fascia::head_maker
