#include <algorithm>
#include <numbers>
#include <set>

#include "anatomy/fields.h"

namespace fascia::anatomy {
namespace {

/// What one of `unit` is in metres, seconds, radians and pascal. Divided by: 12 mm are then 0.012 m to the
/// last bit.
double parts_of_unit(const std::string& unit) {
  if (unit == "mm" || unit == "ms") return 1e3;
  if (unit == "deg") return 180.0 / std::numbers::pi;
  return 1.0;
}

/// One section of the file, which must hold what is asked of it and no more.
class Section {
 public:
  explicit Section(const Fields& fields) : fields_(fields) { fields.text("means"); }

  void value(const char* name, const std::string& unit, double& out) const {
    const Fields entry = entry_of(name, unit);
    out = entry.number("value");
    check_range(entry, {out});
    out /= parts_of_unit(unit);
  }

  void value(const char* name, const std::string& unit, Ramp& out) const {
    const Fields entry = entry_of(name, unit);
    const std::vector<double> ends = entry.numbers("value");
    if (ends.size() != 2 || !(ends[0] < ends[1])) entry.fail("\"value\" must be two rising numbers");
    check_range(entry, ends);
    out = {ends[0] / parts_of_unit(unit), ends[1] / parts_of_unit(unit)};
  }

  /// A key that nothing reads is an error: a correction of it would have no effect.
  void refuse_unknown() const {
    for (const std::string& key : fields_.keys())
      if (key != "means" && known_.count(key) == 0)
        fields_.fail("\"" + key + "\" is not a constant that anything reads; remove it or correct its name");
  }

 private:
  Fields entry_of(const char* name, const std::string& unit) const {
    known_.insert(name);
    const Fields entry = fields_.object(name);
    if (entry.text("unit") != unit) entry.fail("\"unit\" must be \"" + unit + "\"");
    entry.text("means");
    if (entry.text("source").size() < 3) entry.fail("\"source\" must say where the value comes from");
    return entry;
  }

  static void check_range(const Fields& entry, const std::vector<double>& values) {
    const std::vector<double> range = entry.numbers("range");
    if (range.size() != 2 || !(range[0] < range[1])) entry.fail("\"range\" must be two rising numbers");
    for (const double value : values)
      if (!(value >= range[0] && value <= range[1]))
        entry.fail("\"value\" " + short_text(value) + " lies outside its range " + short_text(range[0]) +
                   " .. " + short_text(range[1]) + "; correct the one that is wrong");
  }

  static std::string short_text(double value) { return Json(value).dump(); }

  Fields fields_;
  mutable std::set<std::string> known_;
};

void read(const Section& in, mechanics::Tissue& out) {
  in.value("density", "kg/m3", out.density);
  in.value("poisson_ratio", "1", out.poisson_ratio);
  in.value("bending_factor", "1", out.bending_factor);
  in.value("volume_modulus", "Pa", out.volume_modulus);
  in.value("inner_volume_modulus", "Pa", out.inner_volume_modulus);
  in.value("inner_layer_thickness", "mm", out.inner_layer_thickness);
  in.value("limit_strain", "1", out.limit_strain);
  in.value("stiffening", "1", out.stiffening);
}

void read(const Section& in, mechanics::Skin& out) {
  in.value("young_modulus", "Pa", out.young_modulus);
  in.value("thickness", "mm", out.thickness);
  in.value("mucosa_stretch_share", "1", out.mucosa_stretch_share);
  in.value("mucosa_bending_share", "1", out.mucosa_bending_share);
}

void read(const Section& in, mechanics::Smas& out) {
  in.value("young_modulus", "Pa", out.young_modulus);
  in.value("thickness", "mm", out.thickness);
  in.value("submucosa_stretch_share", "1", out.submucosa_stretch_share);
  in.value("submucosa_bending_share", "1", out.submucosa_bending_share);
}

void read(const Section& in, mechanics::Fat& out) {
  in.value("across_modulus", "Pa", out.across_modulus);
  in.value("shear_modulus", "Pa", out.shear_modulus);
  in.value("deep_across_share", "1", out.deep_across_share);
  in.value("deep_shear_share", "1", out.deep_shear_share);
  in.value("lining_volume_share", "1", out.lining_volume_share);
}

void read(const Section& in, mechanics::Glide& out) {
  in.value("shear_modulus", "Pa", out.shear_modulus);
  in.value("normal_modulus", "Pa", out.normal_modulus);
  in.value("least_depth", "mm", out.least_depth);
  in.value("pressing_depth", "mm", out.pressing_depth);
}

void read(const Section& in, mechanics::Attachment& out) {
  in.value("free_factor", "1", out.free_factor);
  in.value("firm_factor", "1", out.firm_factor);
  in.value("zone_share", "1", out.zone_share);
  in.value("lip_fade", "mm", out.lip_fade);
  in.value("lip_share", "1", out.lip_share);
  in.value("lid_fade", "mm", out.lid_fade);
  in.value("lid_share", "1", out.lid_share);
  in.value("air_depth", "mm", out.air_depth);
  in.value("air_shear_loss", "1", out.air_shear_loss);
  in.value("air_normal_loss", "1", out.air_normal_loss);
  in.value("free_travel", "mm", out.free_travel);
}

void read(const Section& in, mechanics::Lids& out) {
  in.value("softness_share", "1", out.softness_share);
  in.value("softness_fade", "mm", out.softness_fade);
  in.value("reach", "mm", out.reach);
  in.value("canthal_fade", "1", out.canthal_fade);
  in.value("upper_plate", "mm", out.upper_plate);
  in.value("lower_plate", "mm", out.lower_plate);
  in.value("unfolding", "mm", out.unfolding);
  in.value("crease", "mm", out.crease);
  in.value("hold", "Pa/m", out.hold);
  in.value("closing", "1", out.closing);
  in.value("opening", "1", out.opening);
  in.value("raising", "1", out.raising);
  in.value("canthal_turn", "deg", out.canthal_turn);
  in.value("canthal_outer_share", "1", out.canthal_outer_share);
  in.value("upper_follows_up", "1", out.upper_follows_up);
  in.value("upper_follows_down", "1", out.upper_follows_down);
  in.value("lower_follows_up", "1", out.lower_follows_up);
  in.value("lower_follows_down", "1", out.lower_follows_down);
  in.value("follows_yaw", "1", out.follows_yaw);
  in.value("upper_drawn", "deg", out.upper_drawn);
  in.value("lower_drawn", "deg", out.lower_drawn);
  in.value("cornea_radius_share", "1", out.cornea_radius_share);
  in.value("cornea_crease_reach", "mm", out.cornea_crease_reach);
  in.value("cornea_crease_depth", "mm", out.cornea_crease_depth);
  in.value("globe_radius_share", "1", out.globe_radius_share);
  in.value("globe_depth_share", "1", out.globe_depth_share);
  in.value("cornea_apex_limit", "1", out.cornea_apex_limit);
  in.value("cornea_clearance", "mm", out.cornea_clearance);
}

void read(const Section& in, mechanics::Lips& out) {
  in.value("softness_share", "1", out.softness_share);
  in.value("softness_fade", "mm", out.softness_fade);
  in.value("lining_reach", "mm", out.lining_reach);
  in.value("body_spread", "mm", out.body_spread);
  in.value("body_reach", "mm", out.body_reach);
  in.value("gum_hold", "Pa", out.gum_hold);
  in.value("roll_drive", "Pa/m", out.roll_drive);
  in.value("roll_fade", "mm", out.roll_fade);
  in.value("roll_lateral_fade", "1", out.roll_lateral_fade);
  in.value("roll_depth", "mm", out.roll_depth);
  in.value("roll_in", "deg", out.roll_in);
  in.value("roll_out", "deg", out.roll_out);
  in.value("protrusion_height", "mm", out.protrusion_height);
  in.value("protrusion_upper", "deg", out.protrusion_upper);
  in.value("protrusion_lower", "deg", out.protrusion_lower);
  in.value("protrusion_drive", "Pa/m", out.protrusion_drive);
  in.value("protrusion_fade", "mm", out.protrusion_fade);
  in.value("side_blend", "mm", out.side_blend);
  in.value("seal_hold", "N/m", out.seal_hold);
  in.value("seal_reach", "mm", out.seal_reach);
  in.value("seal_shortest", "1", out.seal_shortest);
}

void read(const Section& in, mechanics::Vestibule& out) {
  in.value("back", "1", out.back);
  in.value("height", "1", out.height);
  in.value("lower_fold", "1", out.lower_fold);
  in.value("midline_blend", "1", out.midline_blend);
  in.value("pressure", "Pa", out.pressure);
}

void read(const Section& in, mechanics::Fibres& out) {
  in.value("shortest_factor", "1", out.shortest_factor);
  in.value("shortest_least", "1", out.shortest_least);
  in.value("shortest_most", "1", out.shortest_most);
  in.value("insertion_spread", "mm", out.insertion_spread);
  in.value("insertion_spread_share", "1", out.insertion_spread_share);
  in.value("ring_spread_share", "1", out.ring_spread_share);
  in.value("least_tension", "1", out.least_tension);
  in.value("deep_course", "mm", out.deep_course);
  in.value("midline_reach", "mm", out.midline_reach);
  in.value("orbit_reach", "mm", out.orbit_reach);
  in.value("lid_reach", "mm", out.lid_reach);
}

void read(const Section& in, mechanics::Muscles& out) {
  in.value("stress", "Pa", out.stress);
  in.value("modiolus_radius", "mm", out.modiolus_radius);
  in.value("tissue_depth", "mm", out.tissue_depth);
}

void read(const Section& in, mechanics::Ligaments& out) {
  in.value("reach", "mm", out.reach);
  in.value("tuft", "mm", out.tuft);
}

void read(const Section& in, mechanics::Depths& out) {
  in.value("bone_reach", "mm", out.bone_reach);
  in.value("rim_reach", "mm", out.rim_reach);
  in.value("rim_depth", "mm", out.rim_depth);
  in.value("flesh_share", "1", out.flesh_share);
  in.value("smas_share", "1", out.smas_share);
  in.value("smas_limits", "mm", out.smas_limits);
  in.value("smas_most_share", "1", out.smas_most_share);
  in.value("lining_smas_share", "1", out.lining_smas_share);
  in.value("lining_smas_most", "mm", out.lining_smas_most);
  in.value("behind_smas", "mm", out.behind_smas);
  in.value("lining_share", "1", out.lining_share);
  in.value("lining_most", "mm", out.lining_most);
}

void read(const Section& in, mechanics::JawInfluence& out) {
  in.value("spread", "mm", out.spread);
  in.value("certain_ratio", "1", out.certain_ratio);
  in.value("bone_distance", "mm", out.bone_distance);
  in.value("lip_fade", "mm", out.lip_fade);
  in.value("lip_passage", "1", out.lip_passage);
}

void read(const Section& in, mechanics::Region& out) {
  in.value("above_hairline", "1", out.above_hairline);
  in.value("below_chin", "1", out.below_chin);
  in.value("before_ear", "1", out.before_ear);
  in.value("back_below_jaw", "1", out.back_below_jaw);
  in.value("jaw_angle", "1", out.jaw_angle);
}

void read(const Section& in, mechanics::JawMotion& out) {
  in.value("open_angle", "deg", out.open_angle);
  in.value("open_forward", "mm", out.open_forward);
  in.value("open_down", "mm", out.open_down);
  in.value("protrusion_forward", "mm", out.protrusion_forward);
  in.value("protrusion_down", "mm", out.protrusion_down);
  in.value("lateral_angle", "deg", out.lateral_angle);
  in.value("lateral_glide", "mm", out.lateral_glide);
  in.value("travel_time", "ms", out.travel_time);
}

void read(const Section& in, mechanics::Contact& out) {
  in.value("lip_reach", "mm", out.lip_reach);
  in.value("lid_reach", "mm", out.lid_reach);
  in.value("globe_stiffness", "N/m", out.globe_stiffness);
  in.value("bone_stiffness", "N/m", out.bone_stiffness);
  in.value("facing_stiffness", "N/m", out.facing_stiffness);
  in.value("thickness", "mm", out.thickness);
  in.value("lid_thickness", "mm", out.lid_thickness);
  in.value("friction", "1", out.friction);
  in.value("sticky_reach", "mm", out.sticky_reach);
  in.value("sticky_stiffness", "N/m", out.sticky_stiffness);
  in.value("lip_range_before", "mm", out.lip_range_before);
  in.value("lip_range_behind", "mm", out.lip_range_behind);
  in.value("lip_range_beside", "mm", out.lip_range_beside);
  in.value("lid_range_before", "mm", out.lid_range_before);
  in.value("lid_range_behind", "mm", out.lid_range_behind);
  in.value("lid_range_beside", "mm", out.lid_range_beside);
}

void read(const Section& in, mechanics::Dynamics& out) {
  in.value("stiffness_damping", "ms", out.stiffness_damping);
  in.value("mass_damping", "1/s", out.mass_damping);
  in.value("activation_rise", "ms", out.activation_rise);
  in.value("activation_decay", "ms", out.activation_decay);
  in.value("initial_force_slope", "1", out.initial_force_slope);
}

void read(const Section& in, mechanics::SmasShape& out) {
  in.value("adult_width", "mm", out.adult_width);
  in.value("adult_height", "mm", out.adult_height);
  in.value("galea", "1", out.galea);
  in.value("neck", "mm", out.neck);
  in.value("ear_gap", "mm", out.ear_gap);
  in.value("lid_margin", "mm", out.lid_margin);
  in.value("lip_part", "1", out.lip_part);
  in.value("lip_corner", "mm", out.lip_corner);
  in.value("nostril_width", "1", out.nostril_width);
  in.value("nostril_height", "1", out.nostril_height);
  in.value("region_blend", "mm", out.region_blend);
  in.value("depth_limits", "1", out.depth_limits);
  in.value("clearance", "mm", out.clearance);
}

Vec3 share_of(const Fields& part) {
  if (part.raw("share").is_number()) return Vec3::Constant(part.number("share"));
  const std::vector<double> share = part.numbers("share");
  if (share.size() != 3) part.fail("\"share\" must be one number, or three for x, y and z");
  return Vec3(share[0], share[1], share[2]);
}

/// A landmark's name, with the side when it has one.
std::string landmark_on(const Fields& part, Side side, const GenericAnatomy& anatomy) {
  const std::string name = part.text("landmark");
  for (const std::string& candidate : {name, with_side(name, side)})
    if (const Landmark* landmark = anatomy.landmark(candidate); landmark && landmark->skin) return candidate;
  part.fail("there is no landmark \"" + name + "\" on the skin in landmarks.json");
}

FacePlace place_of(const Fields& entry, Side side, const GenericAnatomy& anatomy) {
  FacePlace place;
  for (const Fields& part : entry.list("centre"))
    place.parts.push_back({landmark_on(part, side, anatomy), share_of(part)});
  const std::vector<double> offset = entry.numbers("offset");
  if (offset.size() != 3) entry.fail("\"offset\" must be three numbers");
  place.offset = Vec3(offset[0], offset[1], offset[2]);
  if (side == Side::right) place.offset = mirrored(place.offset);
  place.radius = entry.number("radius");
  if (place.parts.empty() || !(place.radius > 0.0))
    entry.fail("\"centre\" needs a landmark or more, and \"radius\" must be positive");
  if (entry.text("source").size() < 3) entry.fail("\"source\" must say where the values come from");
  return place;
}

double factor_of(const Fields& entry, const char* key) {
  const double factor = entry.number(key);
  if (!(factor > 0.0)) entry.fail("\"" + std::string(key) + "\" must be positive");
  return factor;
}

}  // namespace

void load_mechanics(const DataFiles& files, GenericAnatomy& anatomy) {
  const Json document = files.json("mechanics.json");
  const Fields root(document, files.place("mechanics.json"));
  const Fields sections = root.object("sections");
  Mechanics& m = anatomy.mechanics;
  std::set<std::string> known;
  const auto load = [&](const char* name, auto& out) {
    known.insert(name);
    const Section section(sections.object(name));
    read(section, out);
    section.refuse_unknown();
  };
  load("tissue", m.tissue);
  load("skin", m.skin);
  load("smas", m.smas);
  load("fat", m.fat);
  load("glide", m.glide);
  load("attachment", m.attachment);
  load("lids", m.lids);
  load("lips", m.lips);
  load("vestibule", m.vestibule);
  load("fibres", m.fibres);
  load("muscles", m.muscles);
  load("ligaments", m.ligaments);
  load("depths", m.depths);
  load("jaw_influence", m.jaw_influence);
  load("region", m.region);
  load("jaw", m.jaw);
  load("contact", m.contact);
  load("dynamics", m.dynamics);
  load("smas_shape", m.smas_shape);
  for (const std::string& name : sections.keys())
    if (known.count(name) == 0) sections.fail("nothing reads the section \"" + name + "\"; remove it");
  for (const Fields& entry : root.list("attachment_regions"))
    for (const Side side : sides_of(entry))
      m.attachment_regions.push_back({with_side(entry.text("name"), side), place_of(entry, side, anatomy),
                                      factor_of(entry, "bone"), factor_of(entry, "skin")});
  for (const Fields& entry : root.list("holds"))
    for (const Side side : sides_of(entry))
      m.holds.push_back(
          {with_side(entry.text("name"), side), place_of(entry, side, anatomy), factor_of(entry, "factor")});
}

}  // namespace fascia::anatomy
