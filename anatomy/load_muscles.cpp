#include <algorithm>
#include <cmath>
#include <numbers>

#include "anatomy/fields.h"
#include "formats/files.h"
#include "geometry/json.h"

namespace fascia::anatomy {
namespace {

MuscleKind kind_of(const Fields& fields) {
  const std::string kind = fields.text("kind");
  if (kind == "strap") return MuscleKind::strap;
  if (kind == "sheet") return MuscleKind::sheet;
  if (kind == "fan") return MuscleKind::fan;
  if (kind == "sphincter_ring") return MuscleKind::sphincter_ring;
  if (kind == "compressor") return MuscleKind::compressor;
  fields.fail("\"kind\" must be strap, sheet, fan, sphincter_ring or compressor");
}

Attachment attachment_of(const Fields& fields) {
  static const std::pair<const char*, Attachment> names[] = {
      {"cranium", Attachment::cranium},   {"mandible", Attachment::mandible}, {"hyoid", Attachment::hyoid},
      {"galea", Attachment::galea},       {"smas", Attachment::smas},         {"skin", Attachment::skin},
      {"modiolus", Attachment::modiolus}, {"tarsus", Attachment::tarsus},     {"fascia", Attachment::fascia}};
  const std::string on = fields.text("on");
  for (const auto& [name, attachment] : names)
    if (on == name) return attachment;
  fields.fail("\"on\" must be cranium, mandible, hyoid, galea, smas, skin, modiolus, tarsus or fascia, not " +
              on);
}

Region region_of(const Fields& fields) {
  Region region;
  region.on = attachment_of(fields);
  region.polygon = fields.points_mm("polygon");
  if (region.polygon.size() < 3) fields.fail("\"polygon\" needs three corners or more");
  return region;
}

OrificeBand band_of(const Fields& fields) {
  constexpr double radians = std::numbers::pi / 180.0;
  OrificeBand band;
  band.orifice = fields.text("orifice");
  if (band.orifice != "mouth" && band.orifice != "eye") fields.fail("\"orifice\" must be mouth or eye");
  const std::vector<double> distance = fields.numbers("distance_mm");
  const std::vector<double> angles = fields.numbers("angles_deg");
  if (distance.size() != 2 || distance[0] < 0.0 || distance[0] >= distance[1])
    fields.fail("\"distance_mm\" must be the inner and the outer distance");
  if (angles.size() != 2 || angles[0] >= angles[1]) fields.fail("\"angles_deg\" must be two rising angles");
  band.inner = distance[0] * 1e-3;
  band.outer = distance[1] * 1e-3;
  band.begin_angle = angles[0] * radians;
  band.end_angle = angles[1] * radians;
  const std::string end = fields.text_or("medial_end", "free");
  if (end != "free" && end != "cranium") fields.fail("\"medial_end\" must be free or cranium");
  band.medial_on_bone = end == "cranium";
  return band;
}

Variant variant_of(const Fields& entry) {
  Variant variant;
  variant.name = entry.text("name");
  variant.prevalence = entry.number("prevalence");
  variant.note = entry.text_or("note", "");
  variant.is_absent = entry.flag("absent");
  variant.width = entry.number_or("width", 1.0);
  if (!(variant.width > 0.0)) entry.fail("\"width\" is a factor above 0");
  if (entry.has("insertion_offset_mm")) variant.insertion_offset = entry.point_mm("insertion_offset_mm");
  return variant;
}

}  // namespace

Muscle read_muscle(const Fields& fields) {
  Muscle muscle;
  muscle.name = fields.text("name");
  muscle.whole = fields.text_or("whole", muscle.name);
  muscle.title = fields.text("title");
  muscle.group = fields.text("group");
  muscle.kind = kind_of(fields);
  if (fields.has("band")) {
    muscle.band = band_of(fields.object("band"));
  } else {
    muscle.origin = region_of(fields.object("origin"));
    muscle.insertion = region_of(fields.object("insertion"));
  }
  const bool ring = muscle.kind == MuscleKind::sphincter_ring || muscle.kind == MuscleKind::compressor;
  if (ring != muscle.band.has_value())
    fields.fail("rings and compressors have a \"band\", all others regions");
  if (fields.has("waypoints")) muscle.waypoints = fields.points_mm("waypoints");
  muscle.depth_fraction = fields.numbers("depth_fraction");
  if (muscle.depth_fraction.empty()) fields.fail("\"depth_fraction\" needs a value or more");
  for (const double fraction : muscle.depth_fraction)
    if (!(fraction >= 0.0 && fraction <= 1.0)) fields.fail("\"depth_fraction\" lies in 0 .. 1");
  muscle.layer = fields.text("layer");
  muscle.peak_shortening = fields.number("peak_shortening");
  if (!(muscle.peak_shortening > 0.0 && muscle.peak_shortening <= 0.5))
    fields.fail("\"peak_shortening\" lies above 0 and up to 0.5");
  muscle.cross_section = fields.number("cross_section_mm2") * 1e-6;
  if (!(muscle.cross_section > 0.0)) fields.fail("\"cross_section_mm2\" must be positive");
  muscle.bundles = fields.has("bundles") ? std::max(1, fields.whole_number("bundles")) : 1;
  muscle.prevalence = fields.number_or("prevalence", 1.0);
  if (fields.has("variants"))
    for (const Fields& entry : fields.list("variants"))
      muscle.variants.push_back(variant_of(entry));
  for (const double unit : fields.numbers("action_units")) {
    if (unit != std::floor(unit)) fields.fail("\"action_units\" must be whole numbers");
    muscle.action_units.push_back(static_cast<int>(unit));
  }
  muscle.source = fields.text("source");
  return muscle;
}

namespace {

OrificeBand mirrored_band(OrificeBand band) {
  const double begin = std::numbers::pi - band.end_angle;
  const double end = std::numbers::pi - band.begin_angle;
  const double turn = begin + end > 2.0 * std::numbers::pi ? 2.0 * std::numbers::pi : 0.0;
  band.begin_angle = begin - turn;
  band.end_angle = end - turn;
  return band;
}

Muscle on_side(Muscle muscle, Side side) {
  muscle.side = side;
  muscle.name = with_side(muscle.name, side);
  muscle.whole = with_side(muscle.whole, side);
  if (muscle.band && side == Side::right) muscle.band = mirrored_band(*muscle.band);
  if (muscle.band && muscle.band->orifice == "eye") muscle.band->orifice = with_side("eye", side);
  if (side != Side::right) return muscle;
  muscle.origin.polygon = mirrored(muscle.origin.polygon);
  muscle.insertion.polygon = mirrored(muscle.insertion.polygon);
  // Mirroring turns the corners' order round; keep it as seen from outside.
  std::reverse(muscle.origin.polygon.begin(), muscle.origin.polygon.end());
  std::reverse(muscle.insertion.polygon.begin(), muscle.insertion.polygon.end());
  muscle.waypoints = mirrored(muscle.waypoints);
  for (Variant& variant : muscle.variants)
    variant.insertion_offset = mirrored(variant.insertion_offset);
  return muscle;
}

template <class Entry>
void put(std::vector<Entry>& entries, Entry entry) {
  for (Entry& known : entries)
    if (known.name == entry.name) {
      known = std::move(entry);
      return;
    }
  entries.push_back(std::move(entry));
}

/// Gives a muscle that is new its weight in the action units it lists: those of both sides and of its own.
void put_into_action_units(GenericAnatomy& anatomy, const Muscle& muscle) {
  const auto set = std::find_if(anatomy.expression_sets.begin(), anatomy.expression_sets.end(),
                                [](const ExpressionSet& known) { return known.name == "au"; });
  if (set == anatomy.expression_sets.end()) return;
  const std::string own = muscle.side == Side::left ? "L" : muscle.side == Side::right ? "R" : "";
  for (const int unit : muscle.action_units)
    for (Expression& expression : set->expressions) {
      const std::string number = std::to_string(std::abs(unit));
      if (expression.name == number || (!own.empty() && expression.name == own + number))
        expression.weights.emplace_back(muscle.name, unit < 0 ? -1.0 : 1.0);
    }
}

}  // namespace

void load_muscles(const DataFiles& files, GenericAnatomy& anatomy) {
  const Json document = files.json("muscles.json");
  const Fields root(document, files.place("muscles.json"));
  for (const Fields& entry : root.list("muscles")) {
    const Muscle muscle = read_muscle(entry);
    for (const Side side : sides_of(entry))
      anatomy.muscles.push_back(on_side(muscle, side));
  }
}

Actuator muscle_actuator(const Muscle& muscle) {
  Actuator actuator;
  actuator.name = muscle.name;
  actuator.group = "muscle";
  actuator.unit = "1";
  actuator.note = muscle.title;
  actuator.is_muscle = true;
  return actuator;
}

void add_muscle(GenericAnatomy& anatomy, Muscle muscle) {
  for (const Actuator& actuator : anatomy.actuators)
    if (actuator.name == muscle.name && !actuator.is_muscle)
      throw Error(muscle.name +
                  ": there is a channel of that name that is not a muscle's; choose another name");
  if (anatomy.whole(muscle.name))
    throw Error(muscle.name + ": this is the name of several parts together; choose another name");
  check_action_units(anatomy, muscle);
  if (!anatomy.actuator(muscle.name)) put_into_action_units(anatomy, muscle);
  put(anatomy.actuators, muscle_actuator(muscle));
  if (muscle.whole != muscle.name) {
    Whole whole{muscle.whole, {}};
    if (const Whole* known = anatomy.whole(muscle.whole)) whole = *known;
    if (std::find(whole.members.begin(), whole.members.end(), muscle.name) == whole.members.end())
      whole.members.push_back(muscle.name);
    put(anatomy.wholes, std::move(whole));
  }
  put(anatomy.muscles, std::move(muscle));
}

void add_muscles(GenericAnatomy& anatomy, const std::filesystem::path& file) {
  const std::string where = "'" + file.string() + "'";
  const Json document = parse_json<Json>(formats::read_bytes(file), where);
  if (document.is_discarded()) throw Error(where + " is not JSON");
  const Fields root(document, where);
  for (const Fields& entry : root.list("muscles")) {
    const Muscle muscle = read_muscle(entry);
    for (const Side side : sides_of(entry))
      add_muscle(anatomy, on_side(muscle, side));
  }
  check_references(anatomy);
}

}  // namespace fascia::anatomy
