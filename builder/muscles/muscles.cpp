#include "builder/muscles/muscles.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "builder/muscles/parts.h"
#include "geometry/error.h"

namespace fascia::muscles {

namespace {

using anatomy::Attachment;
using anatomy::MuscleKind;

/// From here on away from the SMAS a region is reached through space.
constexpr double kFarFromSmas = 0.028;

bool is_wanted(const anatomy::Muscle& muscle, const Options& options) {
  const auto named = [&](const std::string& name) {
    return std::find(options.absent.begin(), options.absent.end(), name) != options.absent.end();
  };
  return muscle.prevalence >= options.least_prevalence && !named(muscle.name) && !named(muscle.whole);
}

void check(const Inputs& inputs, const Options& options) {
  if (!inputs.smas || inputs.smas->empty()) throw Error("muscles: no SMAS surface; build the SMAS first");
  if (!inputs.skin) throw Error("muscles: no skin surface to measure depths from");
  if (!(options.spacing > 0.0) || !(options.point_spacing > 0.0))
    throw Error("muscles: spacings must be above 0 metres");
  if (options.fewest_fibres < 1 || options.most_fibres < options.fewest_fibres || options.fewest_points < 2 ||
      options.most_points < options.fewest_points)
    throw Error(
        "muscles: counts of fibres and points must rise from fewest (1 fibre, 2 points or more) to most");
  std::set<std::string> names;
  for (const anatomy::Muscle& muscle : inputs.muscles) {
    if (!names.insert(muscle.name).second)
      throw Error("muscles: two are named " + muscle.name + "; rename one");
    if (!muscle.band && (muscle.origin.polygon.empty() || muscle.insertion.polygon.empty()))
      throw Error(muscle.name + ": neither regions nor a band around an orifice; give it one");
  }
  for (const auto& [name, edit] : options.edits) {
    if (!names.count(name)) throw Error("edit of " + name + ": there is no muscle of that name");
    if (!(edit.strength >= 0.0 && edit.strength <= 100.0))
      throw Error(name + ": the strength is a factor from 0 to 100");
    if (!(edit.width > 0.0 && edit.width <= 10.0))
      throw Error(name + ": the width is a factor above 0 and up to 10");
    if (edit.spacing && !(*edit.spacing > 0.0)) throw Error(name + ": the spacing of fibres must be above 0");
    if (edit.bundles && *edit.bundles < 1) throw Error(name + ": a muscle has one bundle or more");
    if (edit.peak_shortening && !(*edit.peak_shortening > 0.0 && *edit.peak_shortening <= 0.5))
      throw Error(name + ": the peak shortening lies above 0 and up to 0.5");
  }
}

const Edit& edit_of(const std::string& name, const Options& options) {
  static const Edit none;
  const auto found = options.edits.find(name);
  return found == options.edits.end() ? none : found->second;
}

std::vector<Vec3> carried(const Inputs& inputs, const std::vector<Vec3>& generic) {
  return inputs.warp ? (*inputs.warp)(std::span<const Vec3>(generic)) : generic;
}

/// `region` of this head, `width` times as wide across the course from `from` to `to`.
void widen(std::vector<Vec3>& region, const Vec3& from, const Vec3& to, double width) {
  if (width == 1.0 || region.empty()) return;
  Vec3 middle = Vec3::Zero();
  for (const Vec3& p : region)
    middle += p / double(region.size());
  const Vec3 axis = (to - from).normalized();
  for (Vec3& p : region) {
    const Vec3 off = p - middle;
    p += (width - 1.0) * (off - axis * axis.dot(off));
  }
}

Place make_place(const Inputs& inputs, const Edit& edit, const spatial::SurfaceQuery& smas,
                 const anatomy::Muscle& muscle, bool origin) {
  const anatomy::Region& region = origin ? muscle.origin : muscle.insertion;
  Place place;
  place.on = region.on;
  if (region.on == Attachment::cranium) place.bone = inputs.cranium;
  if (region.on == Attachment::mandible) place.bone = inputs.mandible;
  const std::optional<Sketch>& sketch = origin ? edit.origin : edit.insertion;
  place.is_sketched = sketch.has_value();
  place.polygon = sketch ? sketched_region(*sketch, place, inputs, smas,
                                           muscle.name + (origin ? ": origin" : ": insertion"))
                         : carried(inputs, region.polygon);
  for (const Vec3& p : place.polygon)
    if (!p.allFinite()) throw Error("a region has a point that is not finite; check landmarks and warp");
  return place;
}

Course make_course(const Inputs& inputs, const Options& options, const spatial::SurfaceQuery& smas,
                   const anatomy::Muscle& muscle) {
  const Edit& edit = edit_of(muscle.name, options);
  Course course{muscle,
                make_place(inputs, edit, smas, muscle, true),
                make_place(inputs, edit, smas, muscle, false),
                {}};
  for (Vec3& p : course.insertion.polygon)
    p += edit.insertion_offset;
  const Vec3 from = course.origin.centre(), to = course.insertion.centre();
  widen(course.origin.polygon, from, to, edit.width);
  widen(course.insertion.polygon, from, to, edit.width);
  course.waypoints = edit.waypoints ? *edit.waypoints : carried(inputs, muscle.waypoints);
  return course;
}

/// The muscle with the user's changes that are not about places on this head.
anatomy::Muscle edited(anatomy::Muscle muscle, const Options& options) {
  const Edit& edit = edit_of(muscle.name, options);
  if (muscle.band && (edit.origin || edit.insertion || edit.waypoints))
    throw Error(muscle.name +
                ": it runs around an orifice and has no regions; change its width or its strength");
  muscle.bundles = edit.bundles.value_or(muscle.bundles);
  muscle.peak_shortening = edit.peak_shortening.value_or(muscle.peak_shortening);
  if (muscle.band)
    muscle.band->outer = muscle.band->inner + edit.width * (muscle.band->outer - muscle.band->inner);
  return muscle;
}

/// True when the muscle lies too deep or too far away to follow the SMAS.
bool runs_through_space(const Carrier& smas, const Course& course) {
  if (course.muscle.group == "masticatory" || course.muscle.group == "lid") return true;
  for (const Place* place : {&course.origin, &course.insertion})
    if (place->on == Attachment::hyoid || smas.query.closest(place->centre()).distance > kFarFromSmas)
      return true;
  return false;
}

/// How far around each orifice the bands reach.
std::map<std::string, double> orifice_reach(const std::vector<anatomy::Muscle>& muscles) {
  std::map<std::string, double> reach;
  for (const anatomy::Muscle& muscle : muscles)
    if (muscle.band) reach[muscle.band->orifice] = std::max(reach[muscle.band->orifice], muscle.band->outer);
  return reach;
}

Muscle described(const anatomy::Muscle& from, double stress, const Options& options) {
  Muscle muscle;
  muscle.name = from.name;
  muscle.whole = from.whole;
  muscle.title = from.title;
  muscle.group = from.group;
  muscle.layer = from.layer;
  muscle.side = from.side;
  muscle.kind = from.kind;
  muscle.bundles = from.bundles;
  muscle.peak_shortening = from.peak_shortening;
  muscle.cross_section = from.cross_section;
  muscle.strength = from.cross_section * stress * edit_of(from.name, options).strength;
  if (!from.band) {
    muscle.origin_on = from.origin.on;
    muscle.insertion_on = from.insertion.on;
  }
  return muscle;
}

/// Farthest end of a fibre from the surface it is fastened to.
double attachment_distance(const Inputs& inputs, const Muscle& muscle, bool origin) {
  Attachment on = origin ? muscle.origin_on : muscle.insertion_on;
  // A compressor runs from the skin to the mucosa, which is no surface of its own.
  if (muscle.kind == MuscleKind::compressor) on = origin ? Attachment::skin : Attachment::fascia;
  const spatial::SurfaceQuery* surface = nullptr;
  if (on == Attachment::cranium) surface = inputs.cranium;
  if (on == Attachment::mandible) surface = inputs.mandible;
  if (on == Attachment::skin) surface = inputs.skin;
  const bool on_smas = on == Attachment::smas || on == Attachment::modiolus;
  double farthest = 0.0;
  for (const Fibre& fibre : muscle.fibres) {
    const FibrePoint& end = origin ? fibre.points.front() : fibre.points.back();
    if (surface)
      farthest = std::max(farthest, surface->closest(end.position).distance);
    else if (on_smas)
      farthest = std::max(farthest, std::abs(end.offset));
  }
  return farthest;
}

/// Farthest end of a fibre in the node from its centre, along the SMAS.
double measured_radius(const Modiolus& node, const std::vector<Muscle>& muscles,
                       const spatial::SurfaceQuery& smas) {
  const Vec3 normal = smas.smooth_normal(smas.closest(node.centre).surface);
  double farthest = 0.0;
  for (const Muscle& muscle : muscles) {
    if (std::find(node.muscles.begin(), node.muscles.end(), muscle.name) == node.muscles.end()) continue;
    for (const Fibre& fibre : muscle.fibres) {
      double nearer = 1e300;  // of the two ends: the other lies elsewhere
      for (const FibrePoint* end : {&fibre.points.front(), &fibre.points.back()}) {
        const Vec3 off = end->position - node.centre;
        nearer = std::min(nearer, (off - normal * normal.dot(off)).norm());
      }
      farthest = std::max(farthest, nearer);
    }
  }
  return farthest;
}

/// Notes a ring that ends in the nodes on either side.
void join_modioli(std::vector<Modiolus>& modioli, Muscle& ring) {
  for (Modiolus& node : modioli) {
    const auto ends_in = [&](bool first) {
      return std::all_of(ring.fibres.begin(), ring.fibres.end(), [&](const Fibre& fibre) {
        const Vec3& end = first ? fibre.points.front().position : fibre.points.back().position;
        return (end - node.centre).norm() < 3.0 * node.radius;
      });
    };
    const bool begins = ends_in(true), ends = ends_in(false);
    if (begins) ring.origin_on = Attachment::modiolus;
    if (ends) ring.insertion_on = Attachment::modiolus;
    if (begins || ends) node.muscles.push_back(ring.name);
  }
}

/// What all muscles of a head are laid with, and what became of them so far.
struct Workshop {
  const Inputs& inputs;
  const Options& options;
  Carrier& smas;
  const Depths& depths;
  std::vector<const spatial::SurfaceQuery*> bones;
  std::map<std::string, OrificeNet> nets;
  std::map<std::string, Course> courses;
  Result result;

  /// Runs `make` for the muscle `name`. A failing muscle is omitted with a warning; errors in user edits are
  /// reported.
  template <class Make>
  bool attempt(const std::string& name, Make make) {
    try {
      make();
      return true;
    } catch (const Error& fault) {
      if (options.edits.count(name)) throw;
      result.warnings.push_back(name + " was omitted (" + fault.what() +
                                "); place the landmarks near it with --landmarks, or draw it in --edits");
      return false;
    }
  }

  /// Along the SMAS where the muscle can lie on it, else straight from region to region.
  std::vector<Fibre> lay(const Course& course) {
    std::vector<Fibre> fibres;
    if (!runs_through_space(smas, course)) {
      try {
        fibres = lay_on_smas(smas, depths, course, options, result.warnings);
      } catch (const Error& fault) {
        result.warnings.push_back(course.muscle.name +
                                  " could not follow the SMAS and was built as a straight line (" +
                                  fault.what() + "); check the landmarks near it");
      }
    }
    return fibres.empty() ? lay_through_space(smas, course, bones, options) : fibres;
  }

  std::vector<Fibre> lay_around(const anatomy::Muscle& from) {
    const auto net = nets.find(from.band->orifice);
    if (net == nets.end()) throw Error("the rings around " + from.band->orifice + " could not be laid");
    return from.kind == MuscleKind::compressor
               ? lay_compressors(depths, net->second, from, options)
               : lay_rings(depths, net->second, from, result.modioli, options);
  }

  Muscle made(const anatomy::Muscle& from) {
    Muscle muscle = described(from, inputs.constants.stress, options);
    if (from.band) {
      muscle.fibres = lay_around(from);
      if (from.band->medial_on_bone) muscle.origin_on = Attachment::cranium;
    } else {
      const Course& course = courses.at(from.name);
      muscle.origin = course.origin.polygon;
      muscle.insertion = course.insertion.polygon;
      muscle.fibres = lay(course);
    }
    for (const Fibre& fibre : muscle.fibres)
      for (const FibrePoint& point : fibre.points)
        if (!point.position.allFinite()) throw Error("a fibre has a point that is not finite");
    if (from.kind == MuscleKind::sphincter_ring && from.band) join_modioli(result.modioli, muscle);
    measure(muscle);
    muscle.crossings = crossings(muscle.fibres, smas.query);
    muscle.origin_distance = attachment_distance(inputs, muscle, true);
    muscle.insertion_distance = attachment_distance(inputs, muscle, false);
    return muscle;
  }

  void add(Muscle muscle) {
    if (muscle.shortest < 1e-3)
      result.warnings.push_back(muscle.name +
                                ": a fibre is shorter than 1 mm; its regions lie on each other");
    if (muscle.crossings > 0)
      result.warnings.push_back(muscle.name + ": its fibres cross in " + std::to_string(muscle.crossings) +
                                " places; its regions or landmarks near it may be misplaced");
    result.muscles.push_back(std::move(muscle));
  }
};

/// Nets around the orifices and the courses of what has regions, without those that cannot be made.
void prepare_courses(Workshop& shop, const std::vector<anatomy::Muscle>& wanted) {
  for (const auto& [orifice, reach] : orifice_reach(wanted))
    shop.attempt("orbicularis of " + orifice, [&, name = orifice, band = reach] {
      shop.nets[name] = orifice_net(shop.smas, shop.inputs.landmarks, name, band);
    });
  std::vector<Course> courses;
  for (const anatomy::Muscle& muscle : wanted)
    if (!muscle.band)
      shop.attempt(muscle.name, [&] {
        courses.push_back(make_course(shop.inputs, shop.options, shop.smas.query, muscle));
      });
  shop.result.modioli = gather_modioli(shop.smas, courses, shop.inputs.constants.modiolus_radius);
  for (Course& course : courses)
    shop.courses.emplace(course.muscle.name, std::move(course));
}

}  // namespace

Result build(const Inputs& inputs, const Options& options) {
  check(inputs, options);
  const geodesics::Surface surface = geodesics::make_surface(*inputs.smas, "SMAS");
  const spatial::SurfaceQuery query(*inputs.smas);
  Carrier smas{surface, query, {}, {}};
  std::vector<const spatial::SurfaceQuery*> bones;
  if (inputs.cranium) bones.push_back(inputs.cranium);
  if (inputs.mandible) bones.push_back(inputs.mandible);
  std::vector<const spatial::SurfaceQuery*> floors = bones;
  if (inputs.teeth) floors.push_back(inputs.teeth);
  const Depths depths(smas, *inputs.skin, floors, inputs.constants.tissue_depth);
  std::vector<anatomy::Muscle> wanted;
  for (const anatomy::Muscle& muscle : inputs.muscles)
    if (is_wanted(muscle, options)) wanted.push_back(edited(muscle, options));

  Workshop shop{inputs, options, smas, depths, bones, {}, {}, {}};
  prepare_courses(shop, wanted);
  for (const anatomy::Muscle& muscle : wanted) {
    if (!muscle.band && !shop.courses.count(muscle.name)) continue;  // said already
    const bool is_made = shop.attempt(muscle.name, [&] { shop.add(shop.made(muscle)); });
    if (is_made) continue;
    for (Modiolus& node : shop.result.modioli)
      std::erase(node.muscles, muscle.name);
  }
  for (Modiolus& node : shop.result.modioli)
    node.radius = measured_radius(node, shop.result.muscles, query);
  return std::move(shop.result);
}

}  // namespace fascia::muscles
