#include "builder/landmarks/find_head.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>

#include "builder/landmarks/spheres.h"
#include "geometry/error.h"

namespace fascia::landmarks {

namespace {

/// Measured: whole faces fit by 0.52 and more (0.7 as a rule); spheres, cubes, limbs, lumps and the backs of
/// heads by 0.49 and less.
constexpr double least_likeness = 0.51;
constexpr double sure_likeness = 0.62;

/// Of a face that is cut off somewhere less fits in all, but what there is fits better than anything else
/// does.
constexpr double least_on_mesh = 0.6;
constexpr double least_coverage = 0.85;

bool is_face(const Likeness& likeness) {
  return likeness.coverage >= least_coverage &&
         std::max(likeness.share - least_likeness, likeness.on_mesh - least_on_mesh) >= 0.0;
}

bool is_better(const Likeness& a, const Likeness& b) {
  return a.on_mesh * std::min(a.coverage, least_coverage) > b.on_mesh * std::min(b.coverage, least_coverage);
}

struct Candidate {
  Placement placement;
  size_t lump = 0;
  double residual = 1.0;  ///< metres of the generic head
  Likeness likeness;
  Registration fit;
};

bool are_alike(const GenericFace& face, const Placement& a, const Placement& b) {
  const Vec3 apart = a(face.vault.centre) - b(face.vault.centre);
  return apart.norm() < 0.012 * a.scale && std::abs(std::log(a.scale / b.scale)) < 0.1 &&
         (a.rotation.transpose() * b.rotation).trace() > 1.0 + 2.0 * std::cos(12.0 * EIGEN_PI / 180.0);
}

/// A small face on a patch of a face alone: nothing of a true one's size is half as large again as a bust and
/// yet no body.
bool may_be_patch(const Candidate& best, double extent) {
  const double metres = extent / best.placement.scale;
  return best.likeness.on_mesh < 0.74 && metres > 0.5 && metres < 1.4;
}

void sort_and_keep(std::vector<Candidate>& all, const GenericFace& face, size_t count) {
  std::stable_sort(all.begin(), all.end(),
                   [](const Candidate& a, const Candidate& b) { return a.residual < b.residual; });
  std::vector<Candidate> kept;
  for (const Candidate& candidate : all) {
    if (kept.size() == count) break;
    const bool is_known = std::any_of(kept.begin(), kept.end(), [&](const Candidate& other) {
      return are_alike(face, candidate.placement, other.placement);
    });
    if (!is_known) kept.push_back(candidate);
  }
  all = std::move(kept);
}

/// The samples about each lump, made when first asked for.
class LumpSamples {
 public:
  LumpSamples(const TriangleMesh& mesh, const spatial::SurfaceQuery& surface, const std::vector<Ball>& lumps)
      : mesh_(mesh), surface_(surface), lumps_(lumps) {}
  const Neighbours& operator()(size_t lump) {
    std::optional<Neighbours>& samples = samples_[lump];
    if (!samples) {
      const Ball about{lumps_[lump].centre, 1.9 * lumps_[lump].radius};
      samples.emplace(open_samples(sample_evenly(mesh_, 5000, about), surface_));
    }
    return *samples;
  }

 private:
  const TriangleMesh& mesh_;
  const spatial::SurfaceQuery& surface_;
  const std::vector<Ball>& lumps_;
  std::map<size_t, std::optional<Neighbours>> samples_;
};

/// Draws all of `candidates` near, bends the generic head onto the best of them; the one most like a face, or
/// null.
const Candidate* fit_best(const GenericFace& face, LumpSamples& near, std::vector<Candidate>& candidates) {
  for (Candidate& candidate : candidates) {
    if (near(candidate.lump).samples().size() < 50) continue;
    const double guessed = candidate.placement.scale;
    candidate.placement =
        refine_placement(face, near(candidate.lump), candidate.placement, 8, 6, &candidate.residual);
    // A head shrunk to nothing fits anywhere.
    if (std::abs(std::log(candidate.placement.scale / guessed)) > std::log(1.8)) candidate.residual = 1.0;
  }
  sort_and_keep(candidates, face, 8);
  const Candidate* best = nullptr;
  for (Candidate& candidate : candidates) {
    if (candidate.residual >= 1.0) continue;
    candidate.placement =
        refine_placement(face, near(candidate.lump), candidate.placement, 12, 2, &candidate.residual);
    candidate.fit =
        register_face(face, near(candidate.lump).samples(), candidate.placement, {}, coarse_fit());
    candidate.likeness = likeness(face, candidate.fit);
    if (!best || is_better(candidate.likeness, best->likeness)) best = &candidate;
    if (best->likeness.share > sure_likeness && is_face(best->likeness)) break;
  }
  return best;
}

void add_candidates(std::vector<Candidate>& candidates, const std::vector<Guess>& guesses, size_t lump,
                    const std::optional<Vec3>& up) {
  for (const Guess& guess : guesses) {
    if (up && guess.placement.rotation.col(1).dot(*up) < 0.5) continue;
    candidates.emplace_back();
    candidates.back().placement = guess.placement;
    candidates.back().lump = lump;
  }
}

TriangleMesh turned_over(TriangleMesh mesh) {
  for (Triangle& t : mesh.triangles)
    std::swap(t[1], t[2]);
  return mesh;
}

}  // namespace

FoundHead find_head(const GenericFace& face, const TriangleMesh& input, const std::string& path,
                    const std::optional<Placement>& hint, const std::optional<Vec3>& up) {
  const int sample_count = 8000;
  FoundHead found;
  TriangleMesh mesh = input;
  spatial::SurfaceQuery surface(mesh);
  Samples even = sample_evenly(mesh, sample_count);
  found.is_inside_out = is_inside_out(even, surface);
  if (found.is_inside_out) {
    mesh = turned_over(std::move(mesh));
    surface = spatial::SurfaceQuery(mesh);
    even = sample_evenly(mesh, sample_count);
  }
  std::vector<Ball> lumps;
  std::vector<Candidate> candidates;
  if (hint) {
    lumps = {{(*hint)(face.vault.centre), face.vault.radius * hint->scale}};
    candidates.resize(1);
    candidates.front().placement = *hint;
  } else {
    lumps = round_lumps(open_samples(even, surface), 7);
    for (size_t l = 0; l < lumps.size(); ++l)
      add_candidates(candidates, guess_placements(face, surface, lumps[l], 16), l, up);
  }
  LumpSamples near(mesh, surface, lumps);
  const Candidate* best = fit_best(face, near, candidates);
  std::vector<Candidate> partial;
  const double extent = bounds(even.points).size().norm();
  if (!hint && !lumps.empty() && (!best || !is_face(best->likeness) || may_be_patch(*best, extent))) {
    const size_t whole = lumps.size() - 1;
    add_candidates(partial, guess_by_nose(face, near(whole), 48), whole, up);
    const Candidate* by_nose = fit_best(face, near, partial);
    if (by_nose && (!best || is_better(by_nose->likeness, best->likeness))) best = by_nose;
  }
  if (!best || !is_face(best->likeness))
    throw Error(
        "'" + path +
        "': no face was found in it. If there is one, give --landmarks FILE with at least four points on the "
        "skin that are not in one plane, such as pronasale, menton, exocanthion_left and exocanthion_right; "
        "if it is one mesh among many, name it with --skin");
  found.fit = best->fit;
  found.likeness = best->likeness.share;
  return found;
}

}  // namespace fascia::landmarks
