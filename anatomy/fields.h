#pragma once

#include <initializer_list>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "anatomy/anatomy.h"
#include "geometry/error.h"

/// Checked access to the data files: errors name the file and the entry.
namespace fascia::anatomy {

using Json = nlohmann::json;

/// The data files by name, from the library itself or from a directory.
class DataFiles {
 public:
  DataFiles() = default;  ///< those built in
  explicit DataFiles(std::filesystem::path directory) : directory_(std::move(directory)) {}
  /// Texts by file name that replace the built-in ones.
  explicit DataFiles(std::map<std::string, std::string> texts) : texts_(std::move(texts)) {}
  /// Throws fascia::Error if the directory contains no data file, or one of an unknown name.
  void check_directory() const;
  /// The bytes of file `name`, of the directory's or, where it has none, the built-in one; throws
  /// fascia::Error when there is neither.
  std::string read(const std::string& name) const;
  /// Path of file `name`, for messages.
  std::string place(const std::string& name) const;
  Json json(const std::string& name) const;

 private:
  std::filesystem::path directory_;  // empty: built in
  std::map<std::string, std::string> texts_;
};

/// A JSON object and its location, for messages such as "muscles.json, risorius: ...".
class Fields {
 public:
  Fields(const Json& object, std::string where);
  const std::string& where() const { return where_; }
  bool has(const char* key) const { return object_->contains(key); }
  std::string text(const char* key) const;
  std::string text_or(const char* key, const std::string& fallback) const;
  double number(const char* key) const;
  double number_or(const char* key, double fallback) const;
  int whole_number(const char* key) const;
  bool flag(const char* key) const;
  std::vector<double> numbers(const char* key) const;
  std::vector<double> numbers_or_none(const char* key) const;
  Vec3 point_mm(const char* key) const;  ///< millimetres in the file, metres here
  Vec3 direction(const char* key) const;
  std::vector<Vec3> points_mm(const char* key) const;  ///< millimetres in the file, metres here
  /// The objects of the list `key`, each placed at its name.
  std::vector<Fields> list(const char* key) const;
  Fields object(const char* key) const;
  const Json& raw(const char* key) const;
  std::vector<std::string> keys() const;
  /// Throws fascia::Error if there is a key that is not among `known`: correcting an unused value would have
  /// no effect.
  void allow_only(std::initializer_list<const char*> known) const;
  [[noreturn]] void fail(const std::string& what) const;

 private:
  const Json* object_;
  std::string where_;
};

/// (x, y, z) -> (-x, y, z), in the list's order.
Vec3 mirrored(const Vec3& point);
std::vector<Vec3> mirrored(std::vector<Vec3> points);

/// `name` with the ending _left, _right or none.
std::string with_side(const std::string& name, Side side);

/// The sides a list entry stands for: left and right, or midline when it says "midline": true.
std::vector<Side> sides_of(const Fields& fields);

/// A muscle of muscles.json as it stands there: on the left side or the midline, its name without a side.
Muscle read_muscle(const Fields& fields);

/// The channel of `muscle`.
Actuator muscle_actuator(const Muscle& muscle);

/// Readers of one file each, into `anatomy`.
void load_landmarks(const DataFiles& files, GenericAnatomy& anatomy);
void load_tissue_depths(const DataFiles& files, GenericAnatomy& anatomy);
void load_muscles(const DataFiles& files, GenericAnatomy& anatomy);
void load_tissue(const DataFiles& files, GenericAnatomy& anatomy);
void load_mechanics(const DataFiles& files, GenericAnatomy& anatomy);
void load_actuation(const DataFiles& files, GenericAnatomy& anatomy);
std::vector<MeshObject> load_objects(const DataFiles& files, const std::string& name);
void load_skin_regions(const DataFiles& files, GenericAnatomy& anatomy);

/// Throws fascia::Error when a name is used twice or a reference does not resolve.
void check_references(const GenericAnatomy& anatomy);

/// Throws fascia::Error when an action unit of `muscle` is not an expression of the set of action units.
void check_action_units(const GenericAnatomy& anatomy, const Muscle& muscle);

}  // namespace fascia::anatomy
