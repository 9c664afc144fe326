#include <algorithm>
#include <cmath>
#include <set>

#include "anatomy/fields.h"

namespace fascia::anatomy {
namespace {

template <class Entry>
void unique_names(const std::vector<Entry>& entries, const char* file) {
  std::set<std::string> names;
  for (const Entry& entry : entries)
    if (!names.insert(entry.name).second)
      throw Error(std::string(file) + ": the name " + entry.name + " occurs twice; rename or remove one");
}

void check_landmarks(const GenericAnatomy& anatomy) {
  unique_names(anatomy.landmarks, "landmarks.json");
  unique_names(anatomy.curves, "landmarks.json");
  unique_names(anatomy.depth_tables, "tissue_depths.json");
  const TissueDepthTable& table = anatomy.depth_tables.front();
  for (const Landmark& landmark : anatomy.landmarks) {
    const std::string where = "landmarks.json, " + landmark.name + ": ";
    if (!landmark.depth.empty() && !table.find(landmark.depth))
      throw Error(where + "the depth \"" + landmark.depth + "\" is not in the table " + table.name);
    if (landmark.bone_from_depth && landmark.depth.empty())
      throw Error(where + "its bone point is said to come from a depth but names none");
  }
}

void check_channels(const GenericAnatomy& anatomy) {
  unique_names(anatomy.muscles, "muscles.json");
  unique_names(anatomy.actuators, "actuators.json");
  unique_names(anatomy.wholes, "actuators.json");
  for (const Muscle& muscle : anatomy.muscles)
    if (!anatomy.actuator(muscle.name))
      throw Error("actuators.json: lacks the muscle " + muscle.name + "; every muscle has a channel");
  for (const Whole& whole : anatomy.wholes) {
    if (anatomy.actuator(whole.name))
      throw Error("actuators.json, " + whole.name + ": is both a channel and a muscle group; rename one");
    for (const std::string& member : whole.members)
      if (!anatomy.actuator(member))
        throw Error("actuators.json, " + whole.name + ": no channel is called " + member);
  }
  for (const Muscle& muscle : anatomy.muscles)
    if (muscle.whole != muscle.name) {
      const Whole* whole = anatomy.whole(muscle.whole);
      if (!whole ||
          std::find(whole->members.begin(), whole->members.end(), muscle.name) == whole->members.end())
        throw Error("muscles.json, " + muscle.name + ": is not a member of its muscle group " + muscle.whole +
                    " in actuators.json");
    }
}

void check_expressions(const GenericAnatomy& anatomy) {
  unique_names(anatomy.expression_sets, "expressions");
  for (const ExpressionSet& set : anatomy.expression_sets)
    for (const Expression& expression : set.expressions) {
      const std::string where = "expressions, " + set.name + ":" + expression.name + ": ";
      if (!expression.corrects.empty() && !set.find(expression.corrects))
        throw Error(where + "corrects " + expression.corrects + ", which the set lacks");
      for (const auto& [name, weight] : expression.weights) {
        const Actuator* actuator = anatomy.actuator(name);
        if (!actuator) throw Error(where + "no channel is called " + name);
        if (!std::isfinite(weight) || weight == 0.0)
          throw Error(where + "the weight of " + name + " is zero");
      }
    }
}

void check_tissue(const GenericAnatomy& anatomy) {
  const Tissue& tissue = anatomy.tissue;
  unique_names(tissue.ligaments, "tissue.json");
  for (const std::vector<Zone>* zones : {&tissue.skin_attachments, &tissue.gliding_planes})
    unique_names(*zones, "tissue.json");
  if (tissue.smas_depths.empty()) throw Error("tissue.json: smas_depths has no sites");
  std::set<std::string> sites;
  for (const SmasDepth& site : tissue.smas_depths) {
    const Landmark* landmark = anatomy.landmark(site.landmark);
    if (!landmark) landmark = anatomy.landmark(site.landmark + "_left");
    if (!landmark || !landmark->skin)
      throw Error("tissue.json, smas_depths: no landmark on the skin is called " + site.landmark);
    if (!sites.insert(site.landmark).second)
      throw Error("tissue.json, smas_depths: " + site.landmark + " occurs twice");
  }
}

/// The generic head and skull are part of the anatomy: the builder cannot do without them.
void check_objects(const GenericAnatomy& anatomy) {
  for (const char* name : {"skin", "eye_left", "eye_right"})
    if (!anatomy.head_object(name)) throw Error(std::string("head.obj: lacks the object ") + name);
  for (const char* name : {"cranium", "mandible", "teeth_upper", "teeth_lower"})
    if (!anatomy.skull_object(name)) throw Error(std::string("skull.obj: lacks the object ") + name);
}

}  // namespace

void check_action_units(const GenericAnatomy& anatomy, const Muscle& muscle) {
  const ExpressionSet* units = anatomy.expression_set("au");
  for (const int unit : muscle.action_units)
    if (units && !units->find(std::to_string(std::abs(unit))))
      throw Error(muscle.name + ": no action unit " + std::to_string(std::abs(unit)) +
                  " is in expressions/facs.json; correct its \"action_units\"");
}

void check_references(const GenericAnatomy& anatomy) {
  check_landmarks(anatomy);
  check_channels(anatomy);
  check_expressions(anatomy);
  for (const Muscle& muscle : anatomy.muscles)
    check_action_units(anatomy, muscle);
  check_tissue(anatomy);
  check_objects(anatomy);
  unique_names(anatomy.head, "head.obj");
  unique_names(anatomy.skull, "skull.obj");
}

}  // namespace fascia::anatomy
