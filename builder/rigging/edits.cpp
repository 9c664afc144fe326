#include "builder/rigging/edits.h"

#include <algorithm>

#include "geometry/error.h"
#include "geometry/nearest_names.h"

namespace fascia::rigging {

namespace {

std::string in_file(const Edits& edits) {
  return edits.file.empty() ? "" : "'" + edits.file + "': ";
}

/// The muscles that `name` stands for: one, the parts of a whole, or both sides of either.
std::vector<const anatomy::Muscle*> named(const anatomy::GenericAnatomy& anatomy, const std::string& name) {
  std::vector<const anatomy::Muscle*> found;
  for (const char* side : {"", "_left", "_right"})
    for (const anatomy::Muscle& muscle : anatomy.muscles)
      if (muscle.name == name + side || muscle.whole == name + side) found.push_back(&muscle);
  return found;
}

[[noreturn]] void refuse_unknown(const Edits& edits, const anatomy::GenericAnatomy& anatomy,
                                 const std::string& name) {
  std::vector<std::string> known;
  for (const anatomy::Muscle& muscle : anatomy.muscles)
    for (const std::string& word : {muscle.name, muscle.whole})
      if (std::find(known.begin(), known.end(), word) == known.end()) known.push_back(word);
  throw Error(in_file(edits) + "there is no muscle '" + name + "'" + did_you_mean(name, known) +
              "; 'fascia info RIG.glb --channels' lists them");
}

const anatomy::Variant* variant_of(const Edits& edits, const anatomy::Muscle& muscle,
                                   const std::string& name) {
  std::string known = "absent, present";
  for (const anatomy::Variant& variant : muscle.variants) {
    if (variant.name == name) return &variant;
    if (variant.name != "absent") known += ", " + variant.name;
  }
  if (name == "absent" || name == "present") return nullptr;
  throw Error(in_file(edits) + muscle.name + ": there is no variant '" + name + "'; there are " + known);
}

std::vector<Vec3> in_metres(std::vector<Vec3> points, double ratio, const Mat4& input_to_metres) {
  for (Vec3& p : points)
    p = transform_point(input_to_metres, ratio * p);
  return points;
}

void apply(const Edits& edits, const MuscleEdit& from, const anatomy::Muscle& muscle, double ratio,
           const Mat4& input_to_metres, muscles::Options& options) {
  muscles::Edit& edit = options.edits[muscle.name];
  bool present = true;
  if (from.variant) {
    const anatomy::Variant* variant = variant_of(edits, muscle, *from.variant);
    present = variant ? !variant->is_absent : *from.variant != "absent";
    if (variant) {
      edit.width *= variant->width;
      edit.insertion_offset += variant->insertion_offset;
    }
  }
  present = from.is_present.value_or(present);
  if (!present) options.absent.push_back(muscle.name);
  if (from.strength) edit.strength *= *from.strength;
  if (from.width) edit.width *= *from.width;
  if (from.peak_shortening) edit.peak_shortening = from.peak_shortening;
  if (from.bundles) edit.bundles = from.bundles;
  if (from.fibre_spacing) edit.spacing = from.fibre_spacing;
  if (from.insertion_offset)
    edit.insertion_offset += ratio * (input_to_metres.topLeftCorner<3, 3>() * *from.insertion_offset);
  for (const auto& [sketch, target] :
       {std::pair(&from.origin, &edit.origin), std::pair(&from.insertion, &edit.insertion)})
    if (*sketch)
      *target = muscles::Sketch{in_metres((*sketch)->points, ratio, input_to_metres), (*sketch)->is_curve};
  if (from.waypoints) edit.waypoints = in_metres(*from.waypoints, ratio, input_to_metres);
}

}  // namespace

double unit_ratio(const std::string& units, const Mat4& input_to_metres) {
  if (units.empty()) return 1.0;
  const double metres = units == "m" ? 1.0 : units == "cm" ? 0.01 : units == "mm" ? 0.001 : std::stod(units);
  return metres / input_to_metres.topLeftCorner<3, 1>().norm();
}

void set_variant(Edits& edits, const std::string& assignment) {
  const size_t equals = assignment.find('=');
  if (equals == std::string::npos || equals == 0 || equals + 1 == assignment.size())
    throw Error("--variant '" + assignment + "': give MUSCLE=VARIANT, such as risorius=absent");
  edits.muscles[assignment.substr(0, equals)].variant = assignment.substr(equals + 1);
}

anatomy::GenericAnatomy with_new_muscles(const anatomy::GenericAnatomy& anatomy, const Edits& edits) {
  anatomy::GenericAnatomy all = anatomy;
  for (const std::filesystem::path& file : edits.muscle_files)
    anatomy::add_muscles(all, file);
  for (const anatomy::Muscle& muscle : edits.new_muscles) {
    if (all.muscle(muscle.name))
      throw Error(in_file(edits) + "new muscle " + muscle.name +
                  ": there is one of that name; change that one in \"muscles\"");
    anatomy::add_muscle(all, muscle);
  }
  return all;
}

muscles::Options muscle_options(const Edits& edits, const anatomy::GenericAnatomy& anatomy,
                                const Mat4& input_to_metres) {
  muscles::Options options;
  options.spacing = edits.fibre_spacing;
  options.least_prevalence = edits.least_prevalence;
  const double ratio = unit_ratio(edits.units, input_to_metres);
  // What is said of a whole comes first, what is said of one part last.
  std::vector<std::pair<std::vector<const anatomy::Muscle*>, const std::pair<const std::string, MuscleEdit>*>>
      order;
  for (const auto& entry : edits.muscles) {
    order.emplace_back(named(anatomy, entry.first), &entry);
    const auto& targets = order.back().first;
    if (targets.empty()) refuse_unknown(edits, anatomy, entry.first);
    const MuscleEdit& edit = entry.second;
    if (targets.size() > 1 && (edit.origin || edit.insertion || edit.waypoints || edit.insertion_offset)) {
      std::string names;
      for (const anatomy::Muscle* muscle : targets)
        names += (names.empty() ? "" : ", ") + muscle->name;
      throw Error(in_file(edits) + entry.first + ": stands for several muscles; give the places of one of " +
                  names);
    }
  }
  std::stable_sort(order.begin(), order.end(),
                   [](const auto& a, const auto& b) { return a.first.size() > b.first.size(); });
  for (const auto& [targets, entry] : order)
    for (const anatomy::Muscle* muscle : targets)
      apply(edits, entry->second, *muscle, ratio, input_to_metres, options);
  return options;
}

}  // namespace fascia::rigging
