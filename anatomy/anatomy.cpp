#include "anatomy/anatomy.h"

#include "anatomy/fields.h"

namespace fascia::anatomy {
namespace {

template <class Entry>
const Entry* named(const std::vector<Entry>& entries, std::string_view name) {
  for (const Entry& entry : entries)
    if (entry.name == name) return &entry;
  return nullptr;
}

GenericAnatomy load(const DataFiles& files) {
  GenericAnatomy anatomy;
  load_landmarks(files, anatomy);
  load_tissue_depths(files, anatomy);
  load_muscles(files, anatomy);
  load_tissue(files, anatomy);
  load_mechanics(files, anatomy);
  load_actuation(files, anatomy);
  anatomy.head = load_objects(files, "head.obj");
  anatomy.head_source = files.read("head.obj");
  load_skin_regions(files, anatomy);
  anatomy.skull = load_objects(files, "skull.obj");
  check_references(anatomy);
  return anatomy;
}

}  // namespace

const TissueDepth* TissueDepthTable::find(std::string_view key) const {
  for (const TissueDepth& depth : depths)
    if (depth.key == key) return &depth;
  return nullptr;
}

const Expression* ExpressionSet::find(std::string_view expression) const {
  return named(expressions, expression);
}

const Landmark* GenericAnatomy::landmark(std::string_view name) const {
  return named(landmarks, name);
}
const Curve* GenericAnatomy::curve(std::string_view name) const {
  return named(curves, name);
}
const TissueDepthTable* GenericAnatomy::depth_table(std::string_view name) const {
  return named(depth_tables, name);
}
const MeshObject* GenericAnatomy::head_object(std::string_view name) const {
  return named(head, name);
}
const MeshObject* GenericAnatomy::skull_object(std::string_view name) const {
  return named(skull, name);
}
const Muscle* GenericAnatomy::muscle(std::string_view name) const {
  return named(muscles, name);
}
const Actuator* GenericAnatomy::actuator(std::string_view name) const {
  return named(actuators, name);
}
const Whole* GenericAnatomy::whole(std::string_view name) const {
  return named(wholes, name);
}
const ExpressionSet* GenericAnatomy::expression_set(std::string_view name) const {
  return named(expression_sets, name);
}

GenericAnatomy load_generic() {
  return load(DataFiles());
}

GenericAnatomy load_generic(const std::filesystem::path& directory) {
  if (!std::filesystem::is_directory(directory))
    throw Error(directory.string() + ": is not a directory; name a copy of anatomy/data");
  const DataFiles files(directory);
  files.check_directory();
  return load(files);
}

std::vector<std::string> corrected_files(const std::filesystem::path& directory) {
  const DataFiles files(directory);
  std::vector<std::string> corrected;
  for (const std::string& name : embedded_files())
    if (files.read(name) != embedded_file(name)) corrected.push_back(name);
  return corrected;
}

}  // namespace fascia::anatomy
