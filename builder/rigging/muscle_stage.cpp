#include <algorithm>

#include "builder/muscles/muscles.h"
#include "builder/rigging/stages.h"
#include "builder/spatial/surface_query.h"

namespace fascia::rigging {

namespace {

const char* kind_name(anatomy::MuscleKind kind) {
  constexpr const char* names[] = {"strap", "sheet", "fan", "sphincter_ring", "compressor"};
  return names[static_cast<int>(kind)];
}

/// The rig knows four kinds of ends; what hangs on the rest of the body stays with the cranium.
rig::FibreEnd fibre_end(anatomy::Attachment on) {
  switch (on) {
    case anatomy::Attachment::mandible:
      return rig::FibreEnd::mandible;
    case anatomy::Attachment::skin:
      return rig::FibreEnd::skin;
    case anatomy::Attachment::galea:
    case anatomy::Attachment::smas:
    case anatomy::Attachment::modiolus:
    case anatomy::Attachment::tarsus:
      return rig::FibreEnd::smas;
    default:
      return rig::FibreEnd::cranium;
  }
}

std::vector<rig::Vec3f> polygon(const std::vector<Vec3>& points) {
  std::vector<rig::Vec3f> out;
  for (const Vec3& p : points)
    out.push_back(p.cast<float>());
  return out;
}

rig::Muscle rig_muscle(const muscles::Muscle& muscle) {
  rig::Muscle out;
  out.name = muscle.name;
  out.group = muscle.whole;
  out.kind = kind_name(muscle.kind);
  out.origin = fibre_end(muscle.origin_on);
  out.insertion = fibre_end(muscle.insertion_on);
  out.origin_region = polygon(muscle.origin);
  out.insertion_region = polygon(muscle.insertion);
  out.strength = static_cast<float>(muscle.strength);
  out.peak_shortening = static_cast<float>(muscle.peak_shortening);
  out.fibre_offsets.push_back(0);
  for (const muscles::Fibre& fibre : muscle.fibres) {
    for (const muscles::FibrePoint& point : fibre.points) {
      out.points.push_back(point.position.cast<float>());
      out.triangles.push_back(static_cast<uint32_t>(std::max(0, point.smas.triangle)));
      out.barycentrics.push_back(point.smas.barycentric.cast<float>());
      out.offsets.push_back(static_cast<float>(point.offset));
    }
    out.fibre_offsets.push_back(static_cast<uint32_t>(out.points.size()));
  }
  return out;
}

BuildReport::MuscleFigures figures(const muscles::Muscle& muscle) {
  BuildReport::MuscleFigures out;
  out.name = muscle.name;
  out.whole = muscle.whole;
  out.fibres = static_cast<int>(muscle.fibres.size());
  out.crossings = muscle.crossings;
  out.length_mm = 1e3 * muscle.mean_length;
  out.shortest_mm = 1e3 * muscle.shortest;
  out.longest_mm = 1e3 * muscle.longest;
  out.area_mm2 = 1e6 * muscle.area;
  out.thickness_mm = 1e3 * muscle.thickness;
  out.volume_mm3 = 1e9 * muscle.volume;
  out.strength_n = muscle.strength;
  out.origin_distance_mm = 1e3 * muscle.origin_distance;
  out.insertion_distance_mm = 1e3 * muscle.insertion_distance;
  return out;
}

void report_edits(const Edits& edits, const muscles::Options& options, BuildReport& report) {
  report.edits.landmarks = static_cast<int>(edits.landmarks.size());
  report.edits.absent = options.absent;
  for (const anatomy::Muscle& muscle : edits.new_muscles)
    report.edits.added.push_back(muscle.name);
  const auto listed = [](const std::vector<std::string>& list, const std::string& name) {
    return std::find(list.begin(), list.end(), name) != list.end();
  };
  for (const auto& [name, edit] : options.edits)
    if (!listed(report.edits.absent, name) && !listed(report.edits.added, name))
      report.edits.changed.push_back(name);
}

/// Upper and lower teeth as one surface.
TriangleMesh joined(const TriangleMesh& a, const TriangleMesh& b) {
  TriangleMesh all = a;
  for (const Triangle& t : b.triangles)
    all.triangles.push_back({t[0] + a.vertex_count(), t[1] + a.vertex_count(), t[2] + a.vertex_count()});
  all.vertices.insert(all.vertices.end(), b.vertices.begin(), b.vertices.end());
  return all;
}

}  // namespace

std::vector<rig::Muscle> build_muscles(const anatomy::GenericAnatomy& anatomy,
                                       const prepare::PreparedHead& head, const skull::FitResult& skull,
                                       const smas::Result& smas, const Landmarks& landmarks,
                                       const Edits& edits, BuildReport& report) {
  const spatial::SurfaceQuery &skin = *head.surface, cranium(skull.cranium), mandible(skull.mandible);
  const TriangleMesh all_teeth = joined(skull.teeth_upper, skull.teeth_lower);
  const std::optional<spatial::SurfaceQuery> teeth =
      all_teeth.empty() ? std::nullopt : std::optional<spatial::SurfaceQuery>(all_teeth);
  muscles::Inputs inputs;
  inputs.smas = &smas.mesh;
  inputs.skin = &skin;
  inputs.cranium = &cranium;
  inputs.mandible = &mandible;
  inputs.teeth = teeth ? &*teeth : nullptr;
  inputs.warp = &skull.warp;
  inputs.landmarks = landmarks;
  inputs.muscles = anatomy.muscles;
  inputs.constants = anatomy.mechanics.muscles;
  const muscles::Options options = muscle_options(edits, anatomy, head.input_to_metres);
  const muscles::Result built = muscles::build(inputs, options);
  report_edits(edits, options, report);
  for (const muscles::Modiolus& node : built.modioli)
    report.modioli.push_back({node.name, node.centre, 1e3 * node.radius, node.muscles});
  report.warnings.insert(report.warnings.end(), built.warnings.begin(), built.warnings.end());
  std::vector<rig::Muscle> all;
  for (const muscles::Muscle& muscle : built.muscles) {
    report.muscles.push_back(figures(muscle));
    all.push_back(rig_muscle(muscle));
  }
  return all;
}

std::vector<float> floats(const std::vector<double>& numbers) {
  std::vector<float> result;
  for (const double number : numbers)
    result.push_back(static_cast<float>(number));
  return result;
}

rig::Actuation rig_actuation(const anatomy::GenericAnatomy& anatomy,
                             const std::vector<rig::Muscle>& muscles) {
  rig::Actuation out;
  std::map<std::string, uint32_t> channel_of;
  for (const anatomy::Actuator& actuator : anatomy.actuators) {
    rig::Channel channel;
    channel.name = actuator.name;
    channel.group = actuator.group;
    channel.minimum = static_cast<float>(actuator.minimum);
    channel.maximum = static_cast<float>(actuator.maximum);
    channel.rest = static_cast<float>(actuator.rest);
    channel.unit = actuator.unit;
    for (size_t m = 0; m < muscles.size(); ++m)
      if (muscles[m].name == actuator.name) channel.muscle = static_cast<int32_t>(m);
    channel_of[channel.name] = static_cast<uint32_t>(out.channels.size());
    out.channels.push_back(std::move(channel));
  }
  const auto add_entry = [&](rig::NamedSet& set, const std::string& channel, double weight) {
    set.member_indices.push_back(static_cast<uint32_t>(set.members.size() - 1));
    set.channel_indices.push_back(channel_of.at(channel));
    set.weights.push_back(static_cast<float>(weight));
  };
  rig::NamedSet wholes;
  wholes.name = "whole";
  for (const anatomy::Whole& whole : anatomy.wholes) {
    wholes.members.push_back(whole.name);
    for (const std::string& member : whole.members)
      add_entry(wholes, member, 1.0);
  }
  out.sets.push_back(std::move(wholes));
  for (const anatomy::ExpressionSet& vocabulary : anatomy.expression_sets) {
    rig::NamedSet set;
    set.name = vocabulary.name;
    set.response_weights = floats(vocabulary.response_weights);
    for (const anatomy::Expression& expression : vocabulary.expressions) {
      set.members.push_back(expression.name);
      const std::vector<float> response =
          expression.response.empty() ? set.response_weights : floats(expression.response);
      set.responses.insert(set.responses.end(), response.begin(), response.end());
      for (const auto& [channel, weight] : expression.weights)
        add_entry(set, channel, weight);
    }
    out.sets.push_back(std::move(set));
  }
  return out;
}

}  // namespace fascia::rigging
