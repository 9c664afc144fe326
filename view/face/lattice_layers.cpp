#include "view/face/lattice_layers.h"

#include <algorithm>
#include <set>
#include <utility>

namespace fascia::view {

namespace {

/// Epidermis and dermis, as a share of the way from the skin's surface to the SMAS.
constexpr double dermis_share = 0.3;

}  // namespace

DrawSurface fat_surface(const Lattice& lattice) {
  DrawSurface fat;
  if (lattice.empty()) return fat;
  for (size_t c = 0; c < lattice.columns; ++c) {
    const Vec3 &skin = lattice.nodes[c], &smas = lattice.nodes[lattice.columns + c];
    fat.positions.push_back(skin + dermis_share * (smas - skin));
  }
  fat.triangles = lattice.prisms;
  fat.shading = Shading::bone;
  fat.roughness = 0.75;
  fat.colour = Vec3(0.90, 0.77, 0.52);
  return fat;
}

void add_lattice(const Lattice& lattice, DrawList& list) {
  if (lattice.empty()) return;
  std::set<std::pair<int, int>> edges;
  for (const Triangle& t : lattice.prisms)
    for (size_t k = 0; k < 3; ++k)
      edges.insert(std::minmax(t[k], t[(k + 1) % 3]));
  DrawLines skin{{}, Vec3(0.95, 0.75, 0.60), 1.5, false}, smas{{}, Vec3(0.80, 0.30, 0.26), 1.5, false},
      columns{{}, Vec3(0.55, 0.62, 0.72), 1.0, false};
  const size_t count = lattice.columns;
  for (const auto& [a, b] : edges) {
    const auto from = static_cast<size_t>(a), to = static_cast<size_t>(b);
    skin.lines.push_back({lattice.nodes[from], lattice.nodes[to]});
    smas.lines.push_back({lattice.nodes[count + from], lattice.nodes[count + to]});
  }
  for (size_t c = 0; c < count; ++c)
    columns.lines.push_back({lattice.nodes[c], lattice.nodes[count + c], lattice.nodes[2 * count + c]});
  for (DrawLines* lines : {&columns, &smas, &skin})
    list.lines.push_back(std::move(*lines));
}

}  // namespace fascia::view
