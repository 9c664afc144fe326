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
    throw Error("muscles: counts of fibres and points must rise from fewest (1 fibre, 2 points or more) to most");
  std::set<std::string> names;
  for (const anatomy::Muscle& muscle : inputs.muscles) {
    if (!names.insert(muscle.name).second) throw Error("muscles: two are named " + muscle.name + "; rename one");
    if (!muscle.band && (muscle.origin.polygon.empty() || muscle.insertion.polygon.empty()))
      throw Error(muscle.name + ": neither regions nor a band around an orifice; give it one");
  }
  for (const RegionEdit& edit : options.regions)
    if (!names.count(edit.muscle)) throw Error("region for " + edit.muscle + ": there is no muscle of that name");
}

std::vector<Vec3> carried(const Inputs& inputs, const std::vector<Vec3>& generic) {
  return inputs.warp ? (*inputs.warp)(std::span<const Vec3>(generic)) : generic;
}

Place make_place(const Inputs& inputs, const Options& options, const anatomy::Muscle& muscle, bool origin) {
  const anatomy::Region& region = origin ? muscle.origin : muscle.insertion;
  Place place;
  place.on = region.on;
  if (region.on == Attachment::cranium) place.bone = inputs.cranium;
  if (region.on == Attachment::mandible) place.bone = inputs.mandible;
  place.polygon = carried(inputs, region.polygon);
  for (const RegionEdit& edit : options.regions)
    if (edit.muscle == muscle.name && edit.origin == origin) place.polygon = edit.polygon;
  for (const Vec3& p : place.polygon)
    if (!p.allFinite()) throw Error(muscle.name + ": a region has a point that is not finite; check landmarks and warp");
  return place;
}

/// True when the muscle lies too deep or too far away to follow the SMAS.
bool runs_through_space(const Carrier& smas, const Course& course) {
  if (course.muscle.group == "masticatory" || course.muscle.group == "lid") return true;
  for (const Place* place : {&course.origin, &course.insertion})
    if (place->on == Attachment::hyoid || smas.query.closest(place->centre()).distance > kFarFromSmas) return true;
  return false;
}

/// How far around each orifice the bands reach.
std::map<std::string, double> orifice_reach(std::span<const anatomy::Muscle> muscles, const Options& options) {
  std::map<std::string, double> reach;
  for (const anatomy::Muscle& muscle : muscles)
    if (muscle.band && is_wanted(muscle, options))
      reach[muscle.band->orifice] = std::max(reach[muscle.band->orifice], muscle.band->outer);
  return reach;
}

Muscle described(const anatomy::Muscle& from, const Options& options) {
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
  const auto scale = options.strength_scale.find(from.name);
  muscle.strength = from.cross_section * options.stress * (scale == options.strength_scale.end() ? 1.0 : scale->second);
  if (!from.band) {
    muscle.origin_on = from.origin.on;
    muscle.insertion_on = from.insertion.on;
  }
  return muscle;
}

}  // namespace

void measure(Muscle& muscle) {
  muscle.mean_length = muscle.longest = muscle.area = 0.0;
  muscle.shortest = muscle.fibres.empty() ? 0.0 : 1e300;
  for (Fibre& fibre : muscle.fibres) {
    fibre.rest_length = 0.0;
    for (size_t k = 0; k + 1 < fibre.points.size(); ++k)
      fibre.rest_length += (fibre.points[k + 1].position - fibre.points[k].position).norm();
    muscle.mean_length += fibre.rest_length / double(muscle.fibres.size());
    muscle.shortest = std::min(muscle.shortest, fibre.rest_length);
    muscle.longest = std::max(muscle.longest, fibre.rest_length);
  }
  // Strips between neighbouring fibres; half a strip more on either edge, as fibres stand for a width.
  for (size_t i = 0; i + 1 < muscle.fibres.size(); ++i) {
    const auto &a = muscle.fibres[i].points, &b = muscle.fibres[i + 1].points;
    double width = 0.0;
    const int samples = 9;
    for (int k = 0; k < samples; ++k) {
      const double share = double(k) / (samples - 1);
      const auto at = [&](const std::vector<FibrePoint>& points) {
        const double place = share * double(points.size() - 1);
        const size_t n = std::min(static_cast<size_t>(place), points.size() - 2);
        return Vec3(points[n].position + (place - double(n)) * (points[n + 1].position - points[n].position));
      };
      width += (at(a) - at(b)).norm() / samples;
    }
    const double length = 0.5 * (muscle.fibres[i].rest_length + muscle.fibres[i + 1].rest_length);
    muscle.area += width * length;
  }
  if (muscle.fibres.size() > 1) muscle.area *= double(muscle.fibres.size()) / double(muscle.fibres.size() - 1);
  muscle.volume = muscle.cross_section * muscle.mean_length;
  muscle.thickness = muscle.area > 0.0 ? muscle.volume / muscle.area : 0.0;
}

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
  const Depths depths(smas, *inputs.skin, floors);
  std::map<std::string, OrificeNet> nets;
  for (const auto& [orifice, reach] : orifice_reach(inputs.muscles, options))
    nets[orifice] = orifice_net(smas, inputs.landmarks, orifice, reach);

  Result result;
  for (const anatomy::Muscle& from : inputs.muscles) {
    if (!is_wanted(from, options)) continue;
    Muscle muscle = described(from, options);
    if (from.band) {
      const OrificeNet& net = nets.at(from.band->orifice);
      muscle.fibres = from.kind == MuscleKind::compressor ? lay_compressors(depths, net, from, options)
                                                          : lay_rings(depths, net, from, options);
      if (from.band->medial_on_bone) muscle.origin_on = Attachment::cranium;
    } else {
      const Course course{from, make_place(inputs, options, from, true), make_place(inputs, options, from, false),
                          carried(inputs, from.waypoints)};
      muscle.origin = course.origin.polygon;
      muscle.insertion = course.insertion.polygon;
      muscle.fibres = runs_through_space(smas, course) ? lay_through_space(smas, course, bones, options)
                                                       : lay_on_smas(smas, depths, course, options);
    }
    measure(muscle);
    if (muscle.shortest < 1e-3)
      result.warnings.push_back(muscle.name + ": a fibre is shorter than 1 mm; its regions lie on each other");
    result.muscles.push_back(std::move(muscle));
  }
  return result;
}

}  // namespace fascia::muscles
