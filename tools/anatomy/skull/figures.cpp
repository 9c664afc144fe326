#include "tools/anatomy/skull/figures.h"

#include <Eigen/LU>
#include <fstream>
#include <sstream>

#include "geometry/error.h"

namespace fascia::skull_maker {
namespace {

using Row = std::vector<std::string>;

/// Rows below the heading of a comma-separated file, comments left out.
std::vector<Row> read_rows(const std::string& path, std::size_t columns) {
  std::ifstream file(path);
  if (!file) throw Error("cannot open " + path + ": measure the figures first");
  std::vector<Row> rows;
  std::string line;
  bool heading = true;
  while (std::getline(file, line)) {
    if (line.empty() || line[0] == '#') continue;
    if (heading) {
      heading = false;
      continue;
    }
    Row row;
    std::stringstream cells(line);
    for (std::string cell; std::getline(cells, cell, ',');)
      row.push_back(cell);
    if (row.size() != columns)
      throw Error(path + ": a row has not " + std::to_string(columns) + " columns: " + line);
    rows.push_back(std::move(row));
  }
  return rows;
}

Vec3 vector_at(const Row& row, std::size_t first) {
  return {std::stod(row[first]), std::stod(row[first + 1]), std::stod(row[first + 2])};
}

std::vector<OrientedPoint> read_sections(const std::string& path) {
  std::vector<OrientedPoint> points;
  for (const Row& row : read_rows(path, 8))
    points.push_back({vector_at(row, 2), vector_at(row, 5).normalized()});
  return points;
}

std::vector<NamedCurve> read_curves(const std::string& path) {
  std::vector<NamedCurve> curves;
  for (const Row& row : read_rows(path, 8)) {
    if (curves.empty() || curves.back().name != row[0]) curves.push_back({row[0], row[1], {}});
    curves.back().points.push_back({vector_at(row, 2), vector_at(row, 5).normalized()});
  }
  return curves;
}

std::vector<Tooth> read_teeth(const std::string& path, const std::string& jaw) {
  std::vector<Tooth> teeth;
  for (const Row& row : read_rows(path, 14)) {
    if (row[0] != jaw) continue;
    if (teeth.empty() || teeth.back().name != row[1]) {
      teeth.push_back({row[1], vector_at(row, 6).normalized(), vector_at(row, 9).normalized(), {}});
    }
    teeth.back().sections.push_back(
        {std::stod(row[2]), vector_at(row, 3), std::stod(row[12]), std::stod(row[13])});
  }
  return teeth;
}

/// Same smoothing as measure_skull_frame.py: landmarks may be missed by about their deviation.
constexpr double warp_smoothing = 4.0;

splines::Warp read_frame(const std::string& path) {
  std::vector<Vec3> source;
  std::vector<Vec3> target;
  splines::WarpOptions options;
  options.lambda = warp_smoothing;
  const auto add = [&](const Vec3& from, const Vec3& to, double deviation) {
    source.push_back(from);
    target.push_back(to);
    options.weights.push_back(1.0 / (deviation * deviation));
  };
  const Vec3 mirror(-1, 1, 1);
  for (const Row& row : read_rows(path, 8)) {
    const Vec3 from = vector_at(row, 1);
    const Vec3 to = vector_at(row, 4);
    const double deviation = std::stod(row[7]);
    add(from, to, deviation);
    if (from.x() != 0) add(from.cwiseProduct(mirror), to.cwiseProduct(mirror), deviation);
  }
  return splines::fit_warp(source, target, options);
}

}  // namespace

Figures read_figures(const std::string& folder) {
  Figures figures;
  figures.cranium = read_sections(folder + "/skull_cranium_sections.csv");
  figures.mandible = read_sections(folder + "/skull_mandible_sections.csv");
  figures.teeth_upper = read_teeth(folder + "/skull_teeth.csv", "upper");
  figures.teeth_lower = read_teeth(folder + "/skull_teeth.csv", "lower");
  figures.curves = read_curves(folder + "/skull_curves.csv");
  figures.to_generic = read_frame(folder + "/skull_frame.csv");
  return figures;
}

const NamedCurve& curve(const std::vector<NamedCurve>& curves, const std::string& name) {
  for (const NamedCurve& found : curves) {
    if (found.name == name) return found;
  }
  throw Error("skull_curves.csv: no curve named " + name + ": measure the curves again");
}

std::vector<OrientedPoint> carry(const splines::Warp& warp, const std::vector<OrientedPoint>& points) {
  std::vector<OrientedPoint> carried;
  carried.reserve(points.size());
  for (const OrientedPoint& point : points) {
    const Mat3 jacobian = warp.jacobian(point.position);
    OrientedPoint out{warp(point.position), (jacobian.inverse().transpose() * point.normal).normalized()};
    if (point.position.x() == 0) {
      out.position.x() = 0;
      out.normal.x() = 0;
      out.normal.normalize();
    }
    carried.push_back(out);
  }
  return carried;
}

}  // namespace fascia::skull_maker
