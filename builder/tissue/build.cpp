#include "builder/tissue/build.h"

#include <algorithm>

#include "builder/tissue/actuators.h"
#include "builder/tissue/bind.h"
#include "builder/tissue/elements.h"
#include "builder/tissue/lids.h"
#include "builder/tissue/mirror.h"
#include "geometry/error.h"
#include "sim/energies.h"
#include "sim/face_model.h"
#include "sim/lattice.h"

namespace fascia::tissue {
namespace {

TissueResult::Figures figures_of(const rig::TissueLevel& level) {
  TissueResult::Figures figures;
  figures.level = level.name;
  figures.nodes = static_cast<int>(level.rest.size());
  figures.springs = static_cast<int>(level.spring_nodes.size());
  figures.fibres = static_cast<int>(level.fibre_channel.size());
  figures.shortest_edge = 1e9;
  std::vector<Vec3> rest;
  for (const rig::Vec3f& p : level.rest)
    rest.push_back(p.cast<double>());
  const uint32_t n = level.columns;
  for (const auto& t : level.triangles) {
    for (size_t e = 0; e < 3; ++e) {
      const double length = (rest[t[e]] - rest[t[(e + 1) % 3]]).norm();
      figures.shortest_edge = std::min(figures.shortest_edge, length);
      figures.longest_edge = std::max(figures.longest_edge, length);
    }
    if (sim::prism_volume({t[0], t[1], t[2], n + t[0], n + t[1], n + t[2]}, rest.data()) <= 0.0)
      ++figures.turned_prisms;
  }
  return figures;
}

bool opens(const FaceRegion& region, Opening opening) {
  const std::vector<double>& distance = region.opening_distance[static_cast<size_t>(opening)];
  return std::any_of(distance.begin(), distance.end(), [](double d) { return d <= 0.0; });
}

/// What does not open, in words.
std::string closed_features(const FaceRegion& region) {
  std::string closed;
  for (const auto& [opening, name] :
       {std::pair(Opening::mouth, "the lips"), std::pair(Opening::eye_left, "the left eye's lids"),
        std::pair(Opening::eye_right, "the right eye's lids")})
    if (!opens(region, opening)) closed += (closed.empty() ? "" : ", ") + std::string(name);
  return closed;
}

/// What the solver needs to know of the anatomy beside the lattice.
rig::TissueMechanics solver_constants(const anatomy::Mechanics& anatomy) {
  const anatomy::mechanics::Contact& contact = anatomy.contact;
  const anatomy::mechanics::Dynamics& dynamics = anatomy.dynamics;
  rig::TissueMechanics out;
  out.stiffness_damping = dynamics.stiffness_damping;
  out.mass_damping = dynamics.mass_damping;
  out.activation_rise = dynamics.activation_rise;
  out.activation_decay = dynamics.activation_decay;
  out.initial_force_slope = dynamics.initial_force_slope;
  out.globe_stiffness = contact.globe_stiffness;
  out.bone_stiffness = contact.bone_stiffness;
  out.facing_stiffness = contact.facing_stiffness;
  out.contact_thickness = contact.thickness;
  out.lid_thickness = contact.lid_thickness;
  out.friction = contact.friction;
  out.sticky_reach = contact.sticky_reach;
  out.sticky_stiffness = contact.sticky_stiffness;
  out.lip_range = {contact.lip_range_before, contact.lip_range_behind, contact.lip_range_beside};
  out.lid_range = {contact.lid_range_before, contact.lid_range_behind, contact.lid_range_beside};
  return out;
}

/// A level with all that its columns carry. Throws Error when it came out unsound.
rig::TissueLevel complete_level(const TissueInputs& inputs, const FaceRegion& region, const Beneath& beneath,
                                const LevelOptions& wanted, const TissueOptions& options,
                                const Columns& columns) {
  rig::TissueLevel level = make_level(inputs, wanted, columns);
  add_fibres(inputs, columns, level);
  add_lip_seal(inputs, columns, level);
  add_lids(inputs, region, columns, level);
  add_lip_turns(inputs, region, beneath, columns, level);
  add_pressures(inputs, columns, level);
  if (options.contact) {
    add_ligaments(inputs, columns, level);
    add_contact(inputs, columns, level);
    add_facing(inputs, region, columns, level);
  }
  if (const char* fault = sim::lattice_fault(sim::lattice_of(level)))
    throw Error("the " + wanted.name + " tissue lattice came out unsound (" + fault +
                "): check the head's skin around lips and lids");
  return level;
}

}  // namespace

TissueResult build(const TissueInputs& given, const TissueOptions& options) {
  if (!(given.mechanics.tissue.density > 0.0))
    throw Error("the tissue needs the constants of the anatomy: fill TissueInputs::mechanics");
  TissueResult result;
  result.tissue.mechanics = solver_constants(given.mechanics);
  const sim::FaceModelOptions solver = sim::face_options_of(result.tissue);
  const FaceRegion region = find_region(given, options);
  const std::optional<Symmetry> symmetry = symmetry_of(given, region);
  const TissueInputs inputs = symmetry && symmetry->is_exact ? with_mirrored_sides(given, *symmetry) : given;
  if (const std::string closed = closed_features(region); !closed.empty())
    result.warnings.push_back(closed +
                              " are closed in the skin, so they do not part: cut the mesh open there");
  const Beneath beneath = find_beneath(inputs, region, options);
  const size_t levels = options.levels.size();
  result.tissue.levels.resize(levels);
  result.tissue.bindings.resize(levels);
  result.figures.resize(levels);
  run_each(options.for_each, levels, [&](size_t k) {
    // The finest first: it takes longest.
    const size_t at = levels - 1 - k;
    const LevelOptions& wanted = options.levels[at];
    const Columns columns = make_columns(inputs, region, beneath, symmetry, wanted, options);
    rig::TissueLevel level = complete_level(inputs, region, beneath, wanted, options, columns);
    const std::vector<Follow> skin = follow_skin(inputs, region, columns);
    settle_lids(inputs, region, columns, skin, symmetry && symmetry->is_exact, solver, level);
    result.tissue.bindings[at] = bind_parts(inputs, region, columns, skin);
    result.figures[at] = figures_of(level);
    result.tissue.levels[at] = std::move(level);
  });
  return result;
}

}  // namespace fascia::tissue
