#include <algorithm>
#include <initializer_list>

#include "anatomy/fields.h"
#include "builder/rigging/edits.h"
#include "formats/files.h"
#include "geometry/error.h"
#include "geometry/json.h"

namespace fascia::rigging {

namespace {

using anatomy::Fields;
using anatomy::Json;

void only(const Json& object, const Fields& fields, std::initializer_list<const char*> known) {
  for (const auto& [key, value] : object.items()) {
    if (std::find(known.begin(), known.end(), key) != known.end()) continue;
    std::string names;
    for (const char* name : known)
      names += (names.empty() ? "" : ", ") + std::string(name);
    fields.fail("\"" + key + "\" is not known here; there are " + names);
  }
}

double in_range(const Fields& fields, const char* key, double least, double most, const char* range) {
  const double value = fields.number(key);
  if (!(value >= least && value <= most)) fields.fail(std::string("\"") + key + "\" must be " + range);
  return value;
}

/// A list of points as they stand in the file; `Fields` takes them for millimetres.
std::vector<Vec3> points(const Fields& fields, const char* key) {
  std::vector<Vec3> list = fields.points_mm(key);
  for (Vec3& p : list)
    p *= 1e3;
  return list;
}

muscles::Sketch sketch_of(const Json& object, const Fields& fields) {
  if (fields.has("points") == fields.has("curve"))
    fields.fail("a region is either \"points\" that lie anywhere in it or a closed \"curve\" around it");
  muscles::Sketch sketch;
  sketch.is_curve = fields.has("curve");
  const char* key = sketch.is_curve ? "curve" : "points";
  if (!object.at(key).is_array() || object.at(key).size() < 3)
    fields.fail(std::string("\"") + key + "\" needs three points or more");
  sketch.points = points(fields, key);
  return sketch;
}

MuscleEdit muscle_edit(const Json& object, const Fields& fields) {
  only(object, fields,
       {"present", "variant", "strength", "width", "peak_shortening", "bundles", "fibre_spacing_mm",
        "insertion_offset", "origin", "insertion", "waypoints"});
  MuscleEdit edit;
  if (fields.has("present")) edit.is_present = fields.flag("present");
  if (fields.has("variant")) edit.variant = fields.text("variant");
  if (fields.has("strength"))
    edit.strength = in_range(fields, "strength", 0.0, 100.0, "a factor from 0 to 100");
  if (fields.has("width")) edit.width = in_range(fields, "width", 0.05, 10.0, "a factor from 0.05 to 10");
  if (fields.has("peak_shortening"))
    edit.peak_shortening =
        in_range(fields, "peak_shortening", 0.01, 0.5, "a share of the length from 0.01 to 0.5");
  if (fields.has("bundles"))
    edit.bundles = static_cast<int>(in_range(fields, "bundles", 1, 50, "from 1 to 50"));
  if (fields.has("fibre_spacing_mm"))
    edit.fibre_spacing = 1e-3 * in_range(fields, "fibre_spacing_mm", 0.1, 20.0, "from 0.1 to 20");
  if (fields.has("insertion_offset")) edit.insertion_offset = 1e3 * fields.point_mm("insertion_offset");
  for (const auto& [key, region] :
       {std::pair("origin", &edit.origin), std::pair("insertion", &edit.insertion)})
    if (fields.has(key)) {
      const Fields entry = fields.object(key);
      only(object.at(key), entry, {"points", "curve"});
      *region = sketch_of(object.at(key), entry);
    }
  if (fields.has("waypoints")) edit.waypoints = points(fields, "waypoints");
  return edit;
}

anatomy::Side side_of(const std::string& name) {
  if (name.ends_with("_left")) return anatomy::Side::left;
  return name.ends_with("_right") ? anatomy::Side::right : anatomy::Side::midline;
}

/// A muscle of the user's own: as in muscles.json, but with its side in its name and sketched regions.
void add_new_muscle(Edits& edits, Json entry, const std::string& where) {
  const Fields fields(entry, where);
  const std::string name = fields.text("name");
  only(entry, fields,
       {"name", "whole", "title", "group", "kind", "origin", "insertion", "waypoints", "depth_fraction",
        "layer", "peak_shortening", "cross_section_mm2", "bundles", "action_units", "source"});
  if (edits.muscles.count(name)) fields.fail("it is in \"muscles\" too; say all there is to say here");
  MuscleEdit edit;
  for (const auto& [key, region] :
       {std::pair("origin", &edit.origin), std::pair("insertion", &edit.insertion)}) {
    const Fields end = fields.object(key);
    only(entry.at(key), end, {"on", "points", "curve"});
    *region = sketch_of(entry.at(key), end);
    entry[key]["polygon"] = entry[key][(*region)->is_curve ? "curve" : "points"];
  }
  edit.waypoints = fields.has("waypoints") ? points(fields, "waypoints") : std::vector<Vec3>();
  const Json defaults = {{"title", name},
                         {"group", "mimic"},
                         {"kind", "strap"},
                         {"layer", "F2"},
                         {"peak_shortening", 0.2},
                         {"depth_fraction", {0.5}},
                         {"cross_section_mm2", 15},
                         {"action_units", Json::array()},
                         {"source", "drawn by the user"}};
  for (const auto& [key, value] : defaults.items())
    if (!entry.contains(key)) entry[key] = value;
  anatomy::Muscle muscle = anatomy::read_muscle(Fields(entry, where));
  muscle.side = side_of(name);
  edits.new_muscles.push_back(std::move(muscle));
  edits.muscles[name] = std::move(edit);
}

}  // namespace

Edits read_edits(const std::filesystem::path& path) {
  const std::string where = "'" + path.string() + "'";
  const Json document = parse_json<Json>(formats::read_bytes(path), where);
  if (document.is_discarded()) throw Error(where + " is not JSON");
  const Fields root(document, where);
  only(document, root,
       {"$schema", "units", "landmarks", "fibre_spacing_mm", "least_prevalence", "muscles", "new_muscles"});
  if (document.empty()) root.fail("it changes nothing; give \"landmarks\", \"muscles\" or \"new_muscles\"");
  Edits edits;
  edits.file = path.string();
  if (root.has("units")) {
    const Json& units = root.raw("units");
    if (units.is_number() && units.get<double>() > 0.0)
      edits.units = units.dump();
    else if (units == "m" || units == "cm" || units == "mm")
      edits.units = units.get<std::string>();
    else
      root.fail("\"units\" must be \"m\", \"cm\", \"mm\" or the metres of one unit");
  }
  if (root.has("landmarks")) {
    const Fields landmarks = root.object("landmarks");
    for (const auto& [name, value] : document["landmarks"].items())
      edits.landmarks[name] = 1e3 * landmarks.point_mm(name.c_str());
  }
  if (root.has("fibre_spacing_mm"))
    edits.fibre_spacing = 1e-3 * in_range(root, "fibre_spacing_mm", 0.1, 20.0, "from 0.1 to 20");
  if (root.has("least_prevalence"))
    edits.least_prevalence = in_range(root, "least_prevalence", 0.0, 1.0, "a share from 0 to 1");
  if (root.has("muscles")) {
    const Fields muscles = root.object("muscles");
    for (const auto& [name, value] : document["muscles"].items())
      edits.muscles[name] = muscle_edit(value, muscles.object(name.c_str()));
  }
  if (root.has("new_muscles"))
    for (const Fields& entry : root.list("new_muscles")) {
      const size_t at = edits.new_muscles.size();
      add_new_muscle(edits, document["new_muscles"][at], entry.where());
    }
  return edits;
}

}  // namespace fascia::rigging
