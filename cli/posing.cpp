#include "cli/posing.h"

#include <fascia/research.h>
#include <fascia/fascia.hpp>

#include <cmath>

#include "formats/activation_file.h"
#include "formats/scene.h"
#include "geometry/error.h"
#include "geometry/nearest_names.h"

namespace fascia::cli {

namespace {

using api::sized;

std::span<const float> as_span(const fascia_vectors& vectors) {
  return {vectors.data, static_cast<size_t>(vectors.count) * 3};
}

int32_t level_index(const fascia_asset* asset, uint32_t count, const std::string& name) {
  if (name.empty()) return -1;
  std::string known;
  for (uint32_t i = 0; i < count; ++i) {
    auto level = sized<fascia_level_info>();
    check(fascia_asset_get_level(asset, i, &level), "level");
    if (name == level.name) return static_cast<int32_t>(i);
    known += (known.empty() ? "" : ", ") + std::string(level.name);
  }
  throw Error("the rig has no level '" + name + "'; it has: " + known);
}

}  // namespace

void check(fascia_result result, const std::string& what) {
  if (result != FASCIA_OK) throw Error(what + ": " + fascia_last_message());
}

Face::Face(const std::filesystem::path& rig, const Options& options) {
  bytes_ = std::make_shared<const std::vector<uint8_t>>(formats::read_bytes(rig));
  path_ = rig.string();
  fascia_asset* asset = nullptr;
  check(fascia_asset_load(bytes_->data(), bytes_->size(), &asset), "'" + rig.string() + "'");
  asset_.reset(asset, Release());
  options_ = options;
  create("'" + rig.string() + "'");
}

Face Face::sibling() const {
  Face face;
  face.asset_ = asset_;
  face.bytes_ = bytes_;
  face.path_ = path_;
  face.options_ = options_;
  face.create("rig");
  return face;
}

void Face::create(const std::string& rig) {
  fascia_asset* const asset = asset_.get();
  const Options& options = options_;
  auto info = sized<fascia_asset_info>();
  check(fascia_asset_get_info(asset, &info), "rig");
  level_ = level_index(asset, info.level_count, options.level);
  fascia_face_options face_options = fascia_default_face_options();
  face_options.space = options.space;
  face_options.level = level_;
  if (options.solver == "bullet")
    face_options.solver = FASCIA_SOLVER_BULLET;
  else if (options.solver == "reference")
    face_options.solver = FASCIA_SOLVER_REFERENCE;
  else if (options.solver != "own")
    throw Error("solver '" + options.solver + "' is unknown: use own, reference or bullet");
  fascia_face* face = nullptr;
  const fascia_result created = fascia_face_create(asset, &face_options, &face);
  if (created == FASCIA_ERROR_MODULE)
    throw Error("--solver " + options.solver +
                " needs libfascia_bullet.so beside the library libfascia.so; --solver own needs nothing");
  check(created, rig);
  face_.reset(face);
  if (level_ < 0) level_ = static_cast<int32_t>(info.level_count) - 1;
  for (uint32_t m = 0; m < info.mesh_count; ++m) {
    auto mesh = sized<fascia_mesh_info>();
    check(fascia_asset_get_mesh(asset, m, &mesh), "mesh");
    FaceMesh entry;
    entry.mesh = mesh.mesh;
    entry.primitive = mesh.primitive;
    entry.vertex_count = mesh.vertex_count;
    entry.name = mesh.name;
    entry.part = mesh.part;
    for (uint32_t t = 0; t < mesh.triangle_count; ++t)
      entry.triangles.push_back({static_cast<int>(mesh.triangles[3 * t]),
                                 static_cast<int>(mesh.triangles[3 * t + 1]),
                                 static_cast<int>(mesh.triangles[3 * t + 2])});
    meshes_.push_back(std::move(entry));
    const std::span<const float> now = positions(m);
    rest_.emplace_back(now.begin(), now.end());
  }
}

std::vector<std::string> Face::set_names() const {
  auto info = sized<fascia_asset_info>();
  check(fascia_asset_get_info(asset_.get(), &info), "rig");
  std::vector<std::string> names;
  for (uint32_t s = 0; s < info.set_count; ++s) {
    auto entry = sized<fascia_set_info>();
    check(fascia_asset_get_set(asset_.get(), s, &entry), "set");
    names.emplace_back(entry.name);
  }
  return names;
}

std::vector<std::string> Face::set_members(const std::string& set) const {
  auto info = sized<fascia_asset_info>();
  check(fascia_asset_get_info(asset_.get(), &info), "rig");
  for (uint32_t s = 0; s < info.set_count; ++s) {
    auto entry = sized<fascia_set_info>();
    check(fascia_asset_get_set(asset_.get(), s, &entry), "set");
    if (set == entry.name) return {entry.members, entry.members + entry.member_count};
  }
  throw Error("the rig has no vocabulary '" + set + "'");
}

std::vector<std::string> Face::channel_names() const {
  auto channels = sized<fascia_channels>();
  check(fascia_asset_get_channels(asset_.get(), &channels), "channels");
  return {channels.names, channels.names + channels.count};
}

std::string Face::suggestion(const std::string& name) const {
  std::vector<std::string> known = channel_names();
  for (const std::string& set : set_names())
    for (const std::string& member : set_members(set))
      known.push_back(set == "whole" ? member : set + ":" + member);  // muscles go by their bare names
  std::string suggested = did_you_mean(name, known);
  // A member written without its set is nearest to members, not to words that are as long with the set's
  // name.
  if (suggested.empty() && name.find(':') == std::string::npos)
    for (const std::string& set : set_names())
      if (suggested.empty()) suggested = did_you_mean(name, set_members(set));
  return suggested;
}

void Face::set(const std::string& name, double value) {
  const fascia_result result = fascia_face_set(face_.get(), name.c_str(), static_cast<float>(value));
  if (result == FASCIA_ERROR_NAME)
    throw Error(
        "the rig has no channel or shape '" + name + "'" + suggestion(name) +
        "; 'fascia info RIG --channels' lists them, 'fascia info --names' what other programs call them");
  check(result, "'" + name + "'");
}

Face::Range Face::range(const std::string& name) const {
  const int32_t channel = fascia_asset_find_channel(asset_.get(), name.c_str());
  if (channel < 0) return {};
  auto channels = sized<fascia_channels>();
  check(fascia_asset_get_channels(asset_.get(), &channels), "channels");
  return {static_cast<double>(channels.minimum[channel]), static_cast<double>(channels.maximum[channel])};
}

void Face::clear() {
  check(fascia_face_clear(face_.get()), "clear");
}
void Face::pose() {
  check(fascia_face_pose(face_.get()), "pose");
}
void Face::reset() {
  check(fascia_face_reset(face_.get()), "reset");
}

bool Face::step(double seconds) {
  const fascia_result result = fascia_face_step(face_.get(), static_cast<float>(seconds));
  if (result == FASCIA_ERROR_DIVERGED) return false;
  check(result, "step");
  return true;
}

std::span<const float> Face::positions(size_t mesh) const {
  auto vectors = sized<fascia_vectors>();
  check(fascia_face_positions(face_.get(), static_cast<uint32_t>(mesh), &vectors), "positions");
  return as_span(vectors);
}

std::span<const float> Face::normals(size_t mesh) const {
  auto vectors = sized<fascia_vectors>();
  check(fascia_face_normals(face_.get(), static_cast<uint32_t>(mesh), &vectors), "normals");
  return as_span(vectors);
}

std::vector<std::pair<std::string, std::vector<std::vector<Vec3>>>> Face::fibres() const {
  auto rest = sized<fascia_fibres>();
  check(fascia_asset_fibres(asset_.get(), static_cast<uint32_t>(level_), &rest), "fibres");
  auto points = sized<fascia_vectors>();
  check(fascia_face_fibre_points(face_.get(), &points), "fibres");
  std::vector<std::pair<std::string, std::vector<std::vector<Vec3>>>> muscles;
  for (uint32_t f = 0; f < rest.fibre_count; ++f) {
    if (muscles.empty() || muscles.back().first != rest.muscles[f]) muscles.push_back({rest.muscles[f], {}});
    std::vector<Vec3> line;
    for (uint32_t p = rest.offsets[f]; p < rest.offsets[f + 1]; ++p)
      line.emplace_back(points.data[3 * p], points.data[3 * p + 1], points.data[3 * p + 2]);
    muscles.back().second.push_back(std::move(line));
  }
  return muscles;
}

std::map<std::string, double> Face::effective_values() const {
  const float* values = fascia_face_effective_values(face_.get());
  const std::vector<std::string> names = channel_names();
  std::map<std::string, double> all;
  for (size_t i = 0; values && i < names.size(); ++i)
    all[names[i]] = values[i];
  return all;
}

view::Lattice Face::lattice() const {
  auto facts = sized<fascia_lattice>();
  check(fascia_asset_lattice(asset_.get(), static_cast<uint32_t>(level_), &facts), "the lattice");
  auto nodes = sized<fascia_vectors>();
  check(fascia_face_nodes(face_.get(), &nodes), "the lattice's nodes");
  view::Lattice lattice;
  lattice.columns = facts.column_count;
  for (uint32_t n = 0; n < nodes.count; ++n)
    lattice.nodes.emplace_back(nodes.data[3 * n], nodes.data[3 * n + 1], nodes.data[3 * n + 2]);
  for (uint32_t t = 0; t < facts.triangle_count; ++t)
    lattice.prisms.push_back({static_cast<int>(facts.triangles[3 * t]),
                              static_cast<int>(facts.triangles[3 * t + 1]),
                              static_cast<int>(facts.triangles[3 * t + 2])});
  return lattice;
}

Mat4 Face::jaw() const {
  float matrix[16];
  check(fascia_face_jaw(face_.get(), matrix), "jaw");
  return Eigen::Map<const Eigen::Matrix4f>(matrix).cast<double>();
}

std::vector<std::pair<std::string, double>> activations(const std::vector<std::string>& words,
                                                        const std::filesystem::path& file) {
  std::vector<std::pair<std::string, double>> values;
  if (!file.empty()) values = formats::read_activations(file);
  for (const std::string& word : words) {
    const size_t at = word.find('=');
    char* end = nullptr;
    const double value = at == std::string::npos ? NAN : std::strtod(word.c_str() + at + 1, &end);
    if (!std::isfinite(value) || !end || *end != 0 || end == word.c_str() + at + 1)
      throw Error("--set '" + word + "' is not NAME=VALUE with a number");
    values.emplace_back(word.substr(0, at), value);
  }
  return values;
}

void set_all(const Common& common, Face& face, const std::vector<std::pair<std::string, double>>& values) {
  for (const auto& [name, value] : values) {
    face.set(name, value);
    const Face::Range range = face.range(name);
    const double rounding = 1e-6 * (range.most - range.least);
    if (value >= range.least - rounding && value <= range.most + rounding) continue;
    char text[96];
    std::snprintf(text, sizeof text, "%g lies beyond its range, %g to %g, and is cut off", value, range.least,
                  range.most);
    common.warn("'" + name + "': " + text);
  }
}

}  // namespace fascia::cli
