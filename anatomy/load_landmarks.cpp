#include "anatomy/fields.h"
#include "formats/files.h"
#include "geometry/json.h"

namespace fascia::anatomy {
namespace {

Side side_named(const Fields& fields) {
  const std::string side = fields.text("side");
  if (side == "midline") return Side::midline;
  if (side == "left") return Side::left;
  if (side == "right") return Side::right;
  fields.fail("\"side\" must be midline, left or right");
}

Landmark landmark_of(const Fields& fields) {
  Landmark landmark;
  landmark.name = fields.text("name");
  landmark.abbreviation = fields.text("abbreviation");
  landmark.definition = fields.text("definition");
  landmark.side = side_named(fields);
  landmark.craniometric = fields.text("kind") == "craniometric";
  landmark.required = fields.flag("required");
  if (fields.has("skin")) {
    landmark.skin = fields.point_mm("skin");
    landmark.normal = fields.direction("normal");
    landmark.tangent = fields.direction("tangent");
  }
  if (fields.has("bone")) {
    landmark.bone = fields.point_mm("bone");
    landmark.bone_normal = fields.direction("bone_normal");
    landmark.bone_from_depth = fields.text("bone_source") == "depth";
  }
  landmark.depth = fields.text_or("depth", "");
  if (!landmark.skin && !landmark.bone) fields.fail("has neither a skin nor a bone point");
  if (landmark.required && !landmark.skin) fields.fail("is required but has no skin point to place");
  return landmark;
}

void add_curve(const Fields& fields, std::vector<Curve>& curves) {
  for (const Side side : sides_of(fields)) {
    Curve curve;
    curve.name = with_side(fields.text("name"), side);
    curve.definition = fields.text("definition");
    curve.side = side;
    curve.on = fields.text("on");
    curve.closed = fields.flag("closed");
    curve.points = fields.points_mm("points");
    if (curve.points.size() < 2) fields.fail("needs two points or more");
    if (side == Side::right) curve.points = mirrored(curve.points);
    curves.push_back(curve);
  }
}

}  // namespace

void load_landmarks(const DataFiles& files, GenericAnatomy& anatomy) {
  const Json document = files.json("landmarks.json");
  const Fields root(document, files.place("landmarks.json"));
  for (const Fields& entry : root.list("landmarks"))
    anatomy.landmarks.push_back(landmark_of(entry));
  if (root.has("curves"))
    for (const Fields& entry : root.list("curves"))
      add_curve(entry, anatomy.curves);
}

namespace {

TissueDepthTable depth_table_of(const Fields& entry) {
  TissueDepthTable table;
  table.name = entry.text("name");
  table.population = entry.text("population");
  table.source = entry.text("source");
  const auto word = [&](const char* name) { return entry.has(name) ? entry.text(name) : std::string(); };
  table.sex = word("sex");
  table.age = word("age");
  table.ancestry = word("ancestry");
  for (const Fields& row : entry.list("depths")) {
    TissueDepth depth;
    depth.key = row.text("key");
    depth.mean = row.number("mean_mm") * 1e-3;
    depth.deviation = row.number_or("sd_mm", 0.0) * 1e-3;
    if (!(depth.mean > 0.0 && depth.mean < 0.2) || depth.deviation < 0.0 || depth.deviation > 0.2)
      row.fail("depths lie between 0 and 200 mm");
    if (table.find(depth.key)) row.fail("the key \"" + depth.key + "\" occurs twice in " + table.name);
    table.depths.push_back(depth);
  }
  return table;
}

}  // namespace

void load_tissue_depths(const DataFiles& files, GenericAnatomy& anatomy) {
  const Json document = files.json("tissue_depths.json");
  const Fields root(document, files.place("tissue_depths.json"));
  for (const Fields& entry : root.list("tables"))
    anatomy.depth_tables.push_back(depth_table_of(entry));
  if (anatomy.depth_tables.empty()) root.fail("holds no table");
}

std::vector<std::string> add_depth_tables(GenericAnatomy& anatomy, const std::filesystem::path& file) {
  const std::string where = "'" + file.string() + "'";
  const Json document = parse_json<Json>(formats::read_bytes(file), where);
  if (document.is_discarded()) throw Error(where + " is not JSON");
  const Fields root(document, where);
  std::vector<std::string> names;
  for (const Fields& entry : root.list("tables")) {
    TissueDepthTable table = depth_table_of(entry);
    names.push_back(table.name);
    std::erase_if(anatomy.depth_tables,
                  [&](const TissueDepthTable& other) { return other.name == table.name; });
    anatomy.depth_tables.push_back(std::move(table));
  }
  if (names.empty()) root.fail("holds no table");
  return names;
}

}  // namespace fascia::anatomy
