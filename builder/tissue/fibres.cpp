#include <algorithm>
#include <cmath>
#include <optional>

#include "builder/spatial/surface_query.h"
#include "builder/tissue/actuators.h"

namespace fascia::tissue {
namespace {

/// `points` thinned so that steps are at least `spacing` long; both ends stay.
std::vector<size_t> thinned(const std::vector<rig::Vec3f>& points, size_t first, size_t last,
                            double spacing) {
  std::vector<size_t> kept = {first};
  double run = 0.0;
  for (size_t p = first + 1; p < last; ++p) {
    run += static_cast<double>((points[p] - points[p - 1]).norm());
    if (run >= spacing || p + 1 == last) {
      if (p + 1 == last && run < 0.4 * spacing && kept.size() > 2)
        kept.back() = p;
      else
        kept.push_back(p);
      run = 0.0;
    }
  }
  return kept;
}

/// Whether a fibre from bone ends across the midline, where its fellow of the other side begins.
bool meets_fellow(const TissueInputs& inputs, const rig::Muscle& muscle, size_t first, size_t last) {
  const auto reach = static_cast<float>(inputs.mechanics.fibres.midline_reach);
  const rig::Vec3f way = muscle.points[last - 1] - muscle.points[last - 2];
  return (muscle.origin == rig::FibreEnd::cranium || muscle.origin == rig::FibreEnd::mandible) &&
         last > first + 2 && std::abs(muscle.points[last - 1].x()) < reach &&
         std::abs(way.x()) > 0.5F * way.norm();
}

/// Whether a fibre comes from behind the globe to a lid, as the levator's do.
bool is_from_orbit(const TissueInputs& inputs, const rig::Muscle& muscle, size_t first, size_t last) {
  const rig::Vec3f &begin = muscle.points[first], &end = muscle.points[last - 1];
  const rig::Eye eye = eye_of(inputs, end.x() > 0.0F);
  return muscle.origin == rig::FibreEnd::cranium && begin.z() < eye.centre.z() - eye.radius &&
         (end - eye.centre).norm() < eye.radius + static_cast<float>(inputs.mechanics.fibres.orbit_reach);
}

bool is_bony(rig::FibreEnd end) {
  return end == rig::FibreEnd::cranium || end == rig::FibreEnd::mandible;
}

/// A layer of the lattice, to find what a fibre's points go with.
struct LayerSurface {
  TriangleMesh mesh;  ///< vertices: all columns' places
  std::optional<spatial::SurfaceQuery> query;
  template <class Has>
  LayerSurface(const std::vector<Vec3>& places, const Columns& c, const Has& has) {
    mesh.vertices = places;
    for (const fascia::Triangle& t : c.mesh.triangles)
      if (std::all_of(t.begin(), t.end(), [&](int v) { return has(static_cast<size_t>(v)); }))
        mesh.triangles.push_back(t);
    if (!mesh.triangles.empty()) query.emplace(mesh);
  }
};

/// What fibres are laid on: the SMAS under the outer skin, the lining of the lips, and the SMAS layer of the
/// lids with their lining, where the tarsal plates are.
struct Surfaces {
  LayerSurface outer, lips, lids;
  Surfaces(const Columns& c, const anatomy::Mechanics& m)
      : outer(c.smas, c, [&](size_t v) { return c.outer[v]; }),
        lips(c.mesh.vertices, c,
             [&](size_t v) {
               return !c.outer[v] &&
                      c.opening_distance[static_cast<size_t>(Opening::mouth)][v] < m.lips.lining_reach;
             }),
        lids(c.smas, c, [&](size_t v) {
          return std::min(c.opening_distance[static_cast<size_t>(Opening::eye_left)][v],
                          c.opening_distance[static_cast<size_t>(Opening::eye_right)][v]) <
                 m.fibres.lid_reach;
        }) {}
};

/// Adds one point of a fibre that follows the point nearest to it on `surface`, whose nodes begin at
/// `layer`.
void add_point(const LayerSurface& surface, uint32_t layer, const rig::Vec3f& point, rig::FibreEnd end,
               double taper, rig::TissueLevel& level) {
  const SurfacePoint place = surface.query->closest(point.cast<double>()).surface;
  const fascia::Triangle& t = surface.mesh.triangles[static_cast<size_t>(place.triangle)];
  level.fibre_nodes.push_back({layer + static_cast<uint32_t>(t[0]), layer + static_cast<uint32_t>(t[1]),
                               layer + static_cast<uint32_t>(t[2])});
  level.fibre_weights.push_back(place.barycentric.cast<float>());
  level.fibre_rest.push_back(point);
  level.fibre_anchor.push_back(end);
  level.fibre_taper.push_back(static_cast<float>(taper));
}

/// A fibre of a compressor runs through the lip from its skin to its lining.
void lay_through(const rig::Muscle& muscle, const std::vector<size_t>& kept, const Surfaces& surfaces,
                 rig::TissueLevel& level) {
  add_point(surfaces.outer, 0, muscle.points[kept.front()], rig::FibreEnd::skin, 1.0, level);
  add_point(surfaces.lips, 0, muscle.points[kept.back()], rig::FibreEnd::skin, 1.0, level);
}

/// A fibre from the orbit goes over the globe as over a pulley and ends on the tarsal plate, which takes its
/// pull whole.
void lay_from_orbit(const rig::Muscle& muscle, const std::vector<size_t>& kept, uint32_t smas,
                    const Surfaces& surfaces, rig::TissueLevel& level) {
  for (const size_t k : kept)
    add_point(surfaces.lids, smas, muscle.points[k], k == kept.back() ? rig::FibreEnd::smas : muscle.origin,
              1.0, level);
}

/// A fibre along the fascia. `spread`: metres over which its pull comes in at a free end.
void lay_along(const rig::Muscle& muscle, const std::vector<size_t>& kept, const std::vector<double>& along,
               double spread, bool meets_fellow, uint32_t smas, const anatomy::mechanics::Fibres& m,
               const Surfaces& surfaces, rig::TissueLevel& level) {
  const double length = along.back();
  bool is_deep = is_bony(muscle.origin);
  for (size_t k = 0; k < kept.size(); ++k) {
    const rig::Vec3f& point = muscle.points[kept[k]];
    const bool is_last = k + 1 == kept.size();
    // Where it still runs far beneath the fascia its sheath holds it by the bone.
    is_deep =
        is_deep && !is_last && surfaces.outer.query->closest(point.cast<double>()).distance > m.deep_course;
    const rig::FibreEnd end = k == 0 || is_deep ? muscle.origin
                              : is_last         ? muscle.insertion
                                                : rig::FibreEnd::smas;
    // A free end takes up the pull over a few millimetres, so that no node is drawn out alone.
    const double middle = is_last ? length : 0.5 * (along[k] + along[k + 1]);
    double taper = 1.0;
    // Slung over the bridge of the nose, a muscle ends on its fellow of the other side, which holds it.
    if (!is_bony(muscle.insertion) && !meets_fellow) taper = std::min(taper, (length - middle) / spread);
    if (!is_bony(muscle.origin)) taper = std::min(taper, middle / spread);
    taper = std::clamp(taper, m.least_tension, 1.0);
    add_point(surfaces.outer, end == rig::FibreEnd::skin ? 0 : smas, point, end, taper, level);
  }
}

}  // namespace

int channel_index(const std::vector<rig::Channel>& channels, const std::string& name) {
  for (size_t c = 0; c < channels.size(); ++c)
    if (channels[c].name == name) return static_cast<int>(c);
  return -1;
}

void add_fibres(const TissueInputs& inputs, const Columns& c, rig::TissueLevel& level) {
  constexpr double spacing = 0.004;  // metres between a fibre's points
  const anatomy::mechanics::Fibres& constants = inputs.mechanics.fibres;
  level.fibre_offsets.assign(1, 0);
  const Surfaces surfaces(c, inputs.mechanics);
  if (!surfaces.outer.query) return;
  const auto smas = static_cast<uint32_t>(c.count());
  for (size_t m = 0; m < inputs.muscles.size(); ++m) {
    const rig::Muscle& muscle = inputs.muscles[m];
    const int channel = channel_index(inputs.channels, muscle.name);
    if (channel < 0 || muscle.fibre_offsets.size() < 2) continue;
    if (is_bony(muscle.origin) && is_bony(muscle.insertion))
      continue;  // moves the jaw, not the fascia it lies under
    const size_t fibres = muscle.fibre_offsets.size() - 1;
    for (size_t f = 0; f < fibres; ++f) {
      const size_t first = muscle.fibre_offsets[f], last = muscle.fibre_offsets[f + 1];
      if (last < first + 2) continue;
      const std::vector<size_t> kept = thinned(muscle.points, first, last, spacing);
      std::vector<double> along(kept.size(), 0.0);
      for (size_t k = 1; k < kept.size(); ++k)
        along[k] =
            along[k - 1] + static_cast<double>((muscle.points[kept[k]] - muscle.points[kept[k - 1]]).norm());
      const double length = along.back();
      if (!(length > 1e-4)) continue;
      // A ring that hangs on one bone gives its pull to the skin all along its way.
      const bool hung_ring =
          muscle.kind == "sphincter_ring" && is_bony(muscle.origin) != is_bony(muscle.insertion);
      const double spread =
          hung_ring ? constants.ring_spread_share * length
                    : std::min(constants.insertion_spread, constants.insertion_spread_share * length);
      if (muscle.kind == "compressor" && surfaces.lips.query)
        lay_through(muscle, kept, surfaces, level);
      else if (surfaces.lids.query && is_from_orbit(inputs, muscle, first, last))
        lay_from_orbit(muscle, kept, smas, surfaces, level);
      else
        lay_along(muscle, kept, along, spread, meets_fellow(inputs, muscle, first, last), smas, constants,
                  surfaces, level);
      level.fibre_offsets.push_back(static_cast<uint32_t>(level.fibre_nodes.size()));
      level.fibre_muscle.push_back(static_cast<uint32_t>(m));
      level.fibre_channel.push_back(static_cast<uint32_t>(channel));
      level.fibre_strength.push_back(muscle.strength / static_cast<float>(fibres));
      level.fibre_shortest.push_back(static_cast<float>(
          std::clamp(1.0 - constants.shortest_factor * static_cast<double>(muscle.peak_shortening),
                     constants.shortest_least, constants.shortest_most)));
    }
  }
}

void add_pressures(const TissueInputs& inputs, const Columns& c, rig::TissueLevel& level) {
  const Vestibule vestibule(inputs);
  for (const double side : {1.0, -1.0}) {
    const int channel =
        channel_index(inputs.channels, side > 0 ? "buccal_pressure_left" : "buccal_pressure_right");
    if (channel < 0) continue;
    for (size_t t = 0; t < c.mesh.triangles.size(); ++t) {
      Vec3 centre = Vec3::Zero();
      double outer = 0.0;  // on the lips' edge part of a triangle
      for (const int v : c.mesh.triangles[t]) {
        centre += c.mesh.vertices[static_cast<size_t>(v)] / 3.0;
        outer += c.outer[static_cast<size_t>(v)] ? 1.0 / 3.0 : 0.0;
      }
      // The two sides share the middle of the lips.
      const double own = vestibule.side(centre, side > 0.0);
      const double share = outer * own * vestibule.share(centre);
      if (share < 0.02) continue;
      level.pressure_channel.push_back(static_cast<uint32_t>(channel));
      level.pressure_prism.push_back(static_cast<uint32_t>(t));
      level.pressure.push_back(static_cast<float>(inputs.mechanics.vestibule.pressure * share));
    }
  }
}

}  // namespace fascia::tissue
