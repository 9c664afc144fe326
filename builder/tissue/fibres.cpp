#include <algorithm>
#include <cmath>
#include <optional>

#include "builder/spatial/surface_query.h"
#include "builder/tissue/actuators.h"

namespace fascia::tissue {
namespace {

/// The SMAS layer under the outer skin: what fibres are laid on.
struct OuterSmas {
  TriangleMesh mesh;            // vertices: all columns' SMAS places
  explicit OuterSmas(const Columns& c) {
    mesh.vertices = c.smas;
    for (const fascia::Triangle& t : c.mesh.triangles) {
      bool outer = true;
      for (const int v : t) outer = outer && c.outer[static_cast<size_t>(v)];
      if (outer) mesh.triangles.push_back(t);
    }
  }
};

/// `points` thinned so that steps are at least `spacing` long; both ends stay.
std::vector<size_t> thinned(const std::vector<rig::Vec3f>& points, size_t first, size_t last, double spacing) {
  std::vector<size_t> kept = {first};
  double run = 0.0;
  for (size_t p = first + 1; p < last; ++p) {
    run += static_cast<double>((points[p] - points[p - 1]).norm());
    if (run >= spacing || p + 1 == last) {
      if (p + 1 == last && run < 0.4 * spacing && kept.size() > 2) kept.back() = p;
      else kept.push_back(p);
      run = 0.0;
    }
  }
  return kept;
}

/// Whether a fibre from bone ends across the midline, where its fellow of the other side begins.
bool meets_fellow(const rig::Muscle& muscle, size_t first, size_t last) {
  const rig::Vec3f way = muscle.points[last - 1] - muscle.points[last - 2];
  return (muscle.origin == rig::FibreEnd::cranium || muscle.origin == rig::FibreEnd::mandible) && last > first + 2 &&
         std::abs(muscle.points[last - 1].x()) < 0.006F && std::abs(way.x()) > 0.5F * way.norm();
}

/// The lining of the lips as triangles of columns.
TriangleMesh lip_lining(const Columns& c) {
  TriangleMesh mesh;
  mesh.vertices = c.mesh.vertices;
  for (const fascia::Triangle& t : c.mesh.triangles) {
    bool lining = true;
    for (const int v : t)
      lining = lining && !c.outer[static_cast<size_t>(v)] && c.opening_distance[static_cast<size_t>(Opening::mouth)][static_cast<size_t>(v)] < 0.03;
    if (lining) mesh.triangles.push_back(t);
  }
  return mesh;
}

/// Adds one point of a fibre that lies on `triangle` of the layer that begins at node `layer`.
void add_point(uint32_t layer, const fascia::Triangle& t, const Vec3& barycentric, const rig::Vec3f& place, rig::FibreEnd end, double taper,
               rig::TissueLevel& level) {
  level.fibre_nodes.push_back({layer + static_cast<uint32_t>(t[0]), layer + static_cast<uint32_t>(t[1]), layer + static_cast<uint32_t>(t[2])});
  level.fibre_weights.push_back(barycentric.cast<float>());
  level.fibre_rest.push_back(place);
  level.fibre_anchor.push_back(end);
  level.fibre_taper.push_back(static_cast<float>(std::clamp(taper, 0.15, 1.0)));
}

}  // namespace

int channel_index(const std::vector<rig::Channel>& channels, const std::string& name) {
  for (size_t c = 0; c < channels.size(); ++c)
    if (channels[c].name == name) return static_cast<int>(c);
  return -1;
}

void add_fibres(const TissueInputs& inputs, const TissueOptions& options, const Columns& c, rig::TissueLevel& level) {
  const OuterSmas outer(c);
  level.fibre_offsets.assign(1, 0);
  if (outer.mesh.empty()) return;
  const spatial::SurfaceQuery query(outer.mesh);
  const TriangleMesh lining = lip_lining(c);
  std::optional<spatial::SurfaceQuery> inside;
  if (!lining.empty()) inside.emplace(lining);
  const auto n = static_cast<uint32_t>(c.count());
  for (size_t m = 0; m < inputs.muscles.size(); ++m) {
    const rig::Muscle& muscle = inputs.muscles[m];
    const int channel = channel_index(inputs.channels, muscle.name);
    if (channel < 0 || muscle.fibre_offsets.size() < 2) continue;
    const auto bony = [](rig::FibreEnd end) { return end == rig::FibreEnd::cranium || end == rig::FibreEnd::mandible; };
    if (bony(muscle.origin) && bony(muscle.insertion)) continue;  // moves the jaw, not the fascia it lies under
    const size_t fibres = muscle.fibre_offsets.size() - 1;
    for (size_t f = 0; f < fibres; ++f) {
      const size_t first = muscle.fibre_offsets[f], last = muscle.fibre_offsets[f + 1];
      if (last < first + 2) continue;
      const std::vector<size_t> kept = thinned(muscle.points, first, last, 0.004);
      std::vector<double> along(kept.size(), 0.0);
      for (size_t k = 1; k < kept.size(); ++k)
        along[k] = along[k - 1] + static_cast<double>((muscle.points[kept[k]] - muscle.points[kept[k - 1]]).norm());
      const double length = along.back();
      if (!(length > 1e-4)) continue;
      // Compressors run through the lip from its skin to its lining.
      const bool is_through = muscle.kind == "compressor" && inside;
      for (size_t k = 0; k < kept.size(); ++k) {
        if (is_through && k > 0 && k + 1 < kept.size()) continue;
        const rig::Vec3f& point = muscle.points[kept[k]];
        const bool is_last = k + 1 == kept.size();
        if (is_through) {
          const SurfacePoint place = (is_last ? *inside : query).closest(point.cast<double>()).surface;
          add_point(0, (is_last ? lining : outer.mesh).triangles[static_cast<size_t>(place.triangle)], place.barycentric, point, rig::FibreEnd::skin, 1.0, level);
          continue;
        }
        const rig::FibreEnd end = k == 0 ? muscle.origin : is_last ? muscle.insertion : rig::FibreEnd::smas;
        const SurfacePoint place = query.closest(point.cast<double>()).surface;
        // A free end takes up the pull over a few millimetres, so that no node is drawn out alone.
        const double middle = is_last ? length : 0.5 * (along[k] + along[k + 1]);
        // A ring that hangs on one bone gives its pull to the skin all along its way.
        const bool hung_ring = muscle.kind == "sphincter_ring" && bony(muscle.origin) != bony(muscle.insertion);
        const double spread = hung_ring ? 0.9 * length : std::min(options.material.insertion_spread, 0.35 * length);
        double taper = 1.0;
        // Slung over the bridge of the nose, a muscle ends on its fellow of the other side, which holds it.
        if (!bony(muscle.insertion) && !meets_fellow(muscle, first, last)) taper = std::min(taper, (length - middle) / spread);
        if (!bony(muscle.origin)) taper = std::min(taper, middle / spread);
        add_point(end == rig::FibreEnd::skin ? 0 : n, outer.mesh.triangles[static_cast<size_t>(place.triangle)], place.barycentric, point, end, taper, level);
      }
      level.fibre_offsets.push_back(static_cast<uint32_t>(level.fibre_nodes.size()));
      level.fibre_muscle.push_back(static_cast<uint32_t>(m));
      level.fibre_channel.push_back(static_cast<uint32_t>(channel));
      level.fibre_strength.push_back(muscle.strength / static_cast<float>(fibres));
      level.fibre_shortest.push_back(static_cast<float>(
          std::clamp(1.0 - options.material.fibre_shortest_factor * static_cast<double>(muscle.peak_shortening), 0.3, 0.95)));
    }
  }
}

void add_pressures(const TissueInputs& inputs, const TissueOptions& options, const Columns& c, rig::TissueLevel& level) {
  const Vestibule vestibule(inputs);
  for (const double side : {1.0, -1.0}) {
    const int channel = channel_index(inputs.channels, side > 0 ? "buccal_pressure_left" : "buccal_pressure_right");
    if (channel < 0) continue;
    for (size_t t = 0; t < c.mesh.triangles.size(); ++t) {
      Vec3 centre = Vec3::Zero();
      bool outer = true;
      for (const int v : c.mesh.triangles[t]) {
        centre += c.mesh.vertices[static_cast<size_t>(v)] / 3.0;
        outer = outer && c.outer[static_cast<size_t>(v)];
      }
      // The two sides share the middle of the lips.
      const double own = vestibule.side(centre, side > 0.0);
      const double share = outer ? own * vestibule.share(centre) : 0.0;
      if (share < 0.02) continue;
      level.pressure_channel.push_back(static_cast<uint32_t>(channel));
      level.pressure_prism.push_back(static_cast<uint32_t>(t));
      level.pressure.push_back(static_cast<float>(options.material.mouth_pressure * share));
    }
  }
}

}  // namespace fascia::tissue
