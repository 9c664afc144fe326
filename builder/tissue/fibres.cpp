#include <algorithm>
#include <cmath>

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
      for (size_t k = 0; k < kept.size(); ++k) {
        const rig::Vec3f& point = muscle.points[kept[k]];
        const rig::FibreEnd end = k == 0 ? muscle.origin : k + 1 == kept.size() ? muscle.insertion : rig::FibreEnd::smas;
        const SurfacePoint place = query.closest(point.cast<double>()).surface;
        const fascia::Triangle& t = outer.mesh.triangles[static_cast<size_t>(place.triangle)];
        const uint32_t layer = end == rig::FibreEnd::skin ? 0 : n;
        level.fibre_nodes.push_back({layer + static_cast<uint32_t>(t[0]), layer + static_cast<uint32_t>(t[1]),
                                     layer + static_cast<uint32_t>(t[2])});
        level.fibre_weights.push_back(place.barycentric.cast<float>());
        level.fibre_rest.push_back(point);
        level.fibre_anchor.push_back(end);
        // A free end takes up the pull over a few millimetres, so that no node is drawn out alone.
        const double middle = k + 1 < kept.size() ? 0.5 * (along[k] + along[k + 1]) : length;
        // A ring that hangs on one bone gives its pull to the skin all along its way.
        const bool hung_ring = muscle.kind == "sphincter_ring" && bony(muscle.origin) != bony(muscle.insertion);
        const double spread = hung_ring ? 0.9 * length : std::min(options.material.insertion_spread, 0.35 * length);
        double taper = 1.0;
        if (!bony(muscle.insertion)) taper = std::min(taper, (length - middle) / spread);
        if (!bony(muscle.origin)) taper = std::min(taper, middle / spread);
        level.fibre_taper.push_back(static_cast<float>(std::clamp(taper, 0.15, 1.0)));
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
  const Vec3 corner_left = landmark(inputs, "cheilion_left"), corner_right = landmark(inputs, "cheilion_right");
  const Vec3 mouth = 0.5 * (corner_left + corner_right);
  const double half = 0.5 * (corner_left - corner_right).norm();
  const double top = landmark(inputs, "subnasale").y() - mouth.y(), bottom = 0.75 * (landmark(inputs, "gnathion").y() - mouth.y());
  const auto falling = [](double from, double to, double x) {
    const double t = std::clamp((x - from) / (to - from), 0.0, 1.0);
    return 1.0 - t * t * (3.0 - 2.0 * t);
  };
  // The vestibule: one space behind lips and cheeks, from fold to fold, back to the masseter's front edge.
  const auto vestibule = [&](const Vec3& p) {
    const double out = std::abs(p.x() - mouth.x()) / half, up = p.y() - mouth.y();
    const double height = up > 0.0 ? up / top : up / bottom;
    return falling(1.5, 2.6, out) * falling(0.55, 1.15, height) * falling(0.0, 0.5, (mouth.z() - p.z()) / half - 1.1);
  };
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
      const double own = falling(-0.2, 0.2, -side * (centre.x() - mouth.x()) / half);
      const double share = outer ? own * vestibule(centre) : 0.0;
      if (share < 0.02) continue;
      level.pressure_channel.push_back(static_cast<uint32_t>(channel));
      level.pressure_prism.push_back(static_cast<uint32_t>(t));
      level.pressure.push_back(static_cast<float>(options.material.mouth_pressure * share));
    }
  }
}

}  // namespace fascia::tissue
