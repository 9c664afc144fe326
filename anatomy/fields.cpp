#include "anatomy/fields.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "formats/files.h"
#include "geometry/json.h"

namespace fascia::anatomy {
namespace {

constexpr double metres = 1e-3;

Vec3 triple(const Json& value, const Fields& fields, const char* key) {
  if (!value.is_array() || value.size() != 3)
    fields.fail(std::string("\"") + key + "\" must be three numbers");
  Vec3 point;
  for (int i = 0; i < 3; ++i) {
    if (!value[static_cast<size_t>(i)].is_number())
      fields.fail(std::string("\"") + key + "\" must be three numbers");
    point[i] = value[static_cast<size_t>(i)].get<double>();
  }
  return point;
}

/// Files of anatomy/data that are only compiled in: other parts of the program read them without a folder.
bool is_fixed(const std::string& name) {
  static const std::set<std::string> fixed = {
      "aliases.json",  "correctives.json",     "landmark_sets.json",      "head_parts.obj",
      "head_skin.jpg", "head_skin_normal.jpg", "head_skin_roughness.jpg",
  };
  return fixed.count(name) > 0;
}

}  // namespace

void DataFiles::check_directory() const {
  const std::vector<std::string> known = embedded_files();
  bool any = false;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(directory_)) {
    const std::string name = std::filesystem::relative(entry.path(), directory_).generic_string();
    const bool is_known = std::find(known.begin(), known.end(), name) != known.end();
    any = any || is_known;
    if (is_fixed(name) && read(name) != embedded_file(name))
      throw Error(
          entry.path().string() +
          ": cannot be corrected here, because it is compiled into the program; take it out, or correct "
          "it in anatomy/data and build Fascia again");
    const std::string extension = entry.path().extension().string();
    if (!is_known && entry.is_regular_file() && (extension == ".json" || extension == ".obj"))
      throw Error(entry.path().string() +
                  ": nothing reads a file of this name; name it as in anatomy/data or take it out");
  }
  if (!any)
    throw Error(directory_.string() + ": holds no file of anatomy/data; copy those to correct into it");
}

std::string DataFiles::place(const std::string& name) const {
  const std::filesystem::path path = directory_ / name;
  return !directory_.empty() && std::filesystem::exists(path) ? path.string() : name;
}

std::string DataFiles::read(const std::string& name) const {
  if (const auto text = texts_.find(name); text != texts_.end()) return text->second;
  if (place(name) == name) return std::string(embedded_file(name));
  const std::vector<uint8_t> bytes = formats::read_bytes(directory_ / name);
  return {bytes.begin(), bytes.end()};
}

Json DataFiles::json(const std::string& name) const {
  try {
    const std::string text = read(name);
    check_depth(text, place(name));
    Json document = Json::parse(text);
    if (!document.is_object()) throw Error(place(name) + ": must hold one JSON object");
    return document;
  } catch (const Json::exception& problem) {
    throw Error(place(name) + ": is not JSON: " + problem.what());
  }
}

Fields::Fields(const Json& object, std::string where) : object_(&object), where_(std::move(where)) {
  if (!object.is_object()) fail("must be a JSON object");
}

void Fields::fail(const std::string& what) const {
  throw Error(where_ + ": " + what);
}

const Json& Fields::raw(const char* key) const {
  const auto found = object_->find(key);
  if (found == object_->end()) fail(std::string("\"") + key + "\" is missing");
  return *found;
}

std::vector<std::string> Fields::keys() const {
  std::vector<std::string> keys;
  for (const auto& item : object_->items())
    keys.push_back(item.key());
  return keys;
}

void Fields::allow_only(std::initializer_list<const char*> known) const {
  for (const auto& item : object_->items())
    if (std::find(known.begin(), known.end(), item.key()) == known.end())
      fail("nothing reads \"" + item.key() + "\"; remove it or correct its name");
}

std::string Fields::text(const char* key) const {
  const Json& value = raw(key);
  if (!value.is_string()) fail(std::string("\"") + key + "\" must be a string");
  return value.get<std::string>();
}

std::string Fields::text_or(const char* key, const std::string& fallback) const {
  return has(key) ? text(key) : fallback;
}

double Fields::number(const char* key) const {
  const Json& value = raw(key);
  if (!value.is_number() || !std::isfinite(value.get<double>()))
    fail(std::string("\"") + key + "\" must be a number");
  return value.get<double>();
}

double Fields::number_or(const char* key, double fallback) const {
  return has(key) ? number(key) : fallback;
}

int Fields::whole_number(const char* key) const {
  const double value = number(key);
  if (value != std::floor(value) || std::abs(value) > 1e6)
    fail(std::string("\"") + key + "\" must be a whole number");
  return static_cast<int>(value);
}

bool Fields::flag(const char* key) const {
  if (!has(key)) return false;
  const Json& value = raw(key);
  if (!value.is_boolean()) fail(std::string("\"") + key + "\" must be true or false");
  return value.get<bool>();
}

std::vector<double> Fields::numbers(const char* key) const {
  const Json& value = raw(key);
  std::vector<double> result;
  if (!value.is_array()) fail(std::string("\"") + key + "\" must be a list of numbers");
  for (const Json& element : value) {
    if (!element.is_number()) fail(std::string("\"") + key + "\" must be a list of numbers");
    result.push_back(element.get<double>());
  }
  return result;
}

std::vector<double> Fields::numbers_or_none(const char* key) const {
  return has(key) ? numbers(key) : std::vector<double>();
}

Vec3 Fields::point_mm(const char* key) const {
  return triple(raw(key), *this, key) * metres;
}

Vec3 Fields::direction(const char* key) const {
  const Vec3 vector = triple(raw(key), *this, key);
  if (!(std::abs(vector.norm() - 1.0) < 0.02))
    fail(std::string("\"") + key + "\" must be a direction of length 1");
  return vector.normalized();
}

std::vector<Vec3> Fields::points_mm(const char* key) const {
  const Json& value = raw(key);
  if (!value.is_array()) fail(std::string("\"") + key + "\" must be a list of points");
  std::vector<Vec3> points;
  for (const Json& element : value)
    points.push_back(triple(element, *this, key) * metres);
  return points;
}

std::vector<Fields> Fields::list(const char* key) const {
  const Json& value = raw(key);
  if (!value.is_array()) fail(std::string("\"") + key + "\" must be a list");
  std::vector<Fields> entries;
  for (size_t i = 0; i < value.size(); ++i) {
    const Json& element = value[i];
    std::string name = std::string(key) + "[" + std::to_string(i) + "]";
    if (element.is_object() && element.contains("name") && element["name"].is_string())
      name = element["name"].get<std::string>();
    entries.emplace_back(element, where_ + ", " + name);
  }
  return entries;
}

Fields Fields::object(const char* key) const {
  return Fields(raw(key), where_ + ", " + key);
}

Vec3 mirrored(const Vec3& point) {
  return Vec3(-point.x(), point.y(), point.z());
}

std::vector<Vec3> mirrored(std::vector<Vec3> points) {
  for (Vec3& point : points)
    point = mirrored(point);
  return points;
}

std::string with_side(const std::string& name, Side side) {
  if (side == Side::left) return name + "_left";
  if (side == Side::right) return name + "_right";
  return name;
}

std::vector<Side> sides_of(const Fields& fields) {
  if (fields.flag("midline")) return {Side::midline};
  return {Side::left, Side::right};
}

}  // namespace fascia::anatomy
