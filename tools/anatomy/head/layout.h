#pragma once

#include <array>
#include <map>
#include <string>
#include <vector>

#include "geometry/mesh.h"

namespace fascia::head_maker {

using Quad = std::array<int, 4>;

/// The left half of the head while it is made: `vertices` in mm, `quads` counter-clockwise from outside (a
/// triangle repeats its last index), `region` one name a quad, `uv` four a quad.
struct HalfHead {
  std::vector<Vec3> vertices;
  std::vector<Quad> quads;
  std::vector<std::string> region;
  std::map<std::string, std::vector<int>> loops;  ///< named vertex loops and curves
  std::vector<char> midline;                      ///< vertex lies in the mirror plane

  int add_vertex(const Vec3& point, bool on_midline = false);
  void add_quad(const Quad& quad, const std::string& name);
};

/// The coarse layout of the outer skin: patches between named nodes, each refined to `kSplit` x `kSplit`
/// quads.
inline constexpr int kSplit = 4;

struct CageNode {
  std::string name;
  Vec3 guess;     ///< near the surface, mm
  bool anchored;  ///< an anatomical point that the relaxation keeps
};

struct CagePatch {
  std::array<std::string, 4> corners;  ///< counter-clockwise from outside
  std::string region;
};

/// The name of the `k`-th node of a row or loop: "E0".
std::string numbered(char letter, int k);

/// Nodes off the openings. Those of the openings are named E0..E7 (eye), M0..M6 (mouth), O0..O3 (nostril),
/// A0..A7 (ear) and come from the measured fans.
std::vector<CageNode> cage_nodes();
std::vector<CagePatch> cage_patches();

/// Refine the cage. `openings`: the fine loop of each opening by its letter, closed (E, O, A) or from the
/// upper to the lower midline (M); every `kSplit`-th point is a node. Sets loops "E", "M", "O", "A" and
/// "neck_end", and `fixed` (one a vertex): 2 an opening's vertex, 1 an anchored node, 0 free.
HalfHead refine_cage(const std::map<char, std::vector<Vec3>>& openings, std::vector<char>& fixed);

}  // namespace fascia::head_maker
