#include "builder/landmarks/find_head.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <memory>

#include "builder/landmarks/eye_pairs.h"
#include "builder/landmarks/searched_surface.h"
#include "builder/landmarks/spheres.h"
#include "geometry/error.h"

namespace fascia::landmarks {

namespace {

/// Measured: people's faces score 0.35 and more (0.5 as a rule), stylised ones 0.15 and more; spheres, cubes,
/// lumps, limbs, the backs of heads and heads put on wrongly 0.14 and less.
constexpr double least_score = 0.15;  // below: nothing like a face
constexpr double plain_score = 0.25;  // above: a face, and no other surface needs to be searched
constexpr double sure_score = 0.40;   // above: no other place needs to be tried
/// Noses are looked for, which takes long, on so many surfaces.
constexpr size_t surfaces_for_noses = 10;
constexpr size_t least_samples = 50;  // of a surface that a head is looked for in

struct Candidate {
  Placement placement;
  Ball about;             ///< samples are taken about it until the head's own place is known
  double distance = 1.0;  ///< of the face from the mesh, metres of the generic head
  Likeness likeness;
  Registration fit;
  std::vector<Anchor> held;  ///< places it is held to; if none, the given ones
};

bool are_alike(const GenericFace& face, const Placement& a, const Placement& b) {
  const Vec3 apart = a(face.vault.centre) - b(face.vault.centre);
  return apart.norm() < 0.012 * a.scale && std::abs(std::log(a.scale / b.scale)) < 0.1 &&
         (a.rotation.transpose() * b.rotation).trace() > 1.0 + 2.0 * std::cos(12.0 * EIGEN_PI / 180.0);
}

void sort_and_keep(std::vector<Candidate>& all, const GenericFace& face, size_t count) {
  std::stable_sort(all.begin(), all.end(),
                   [](const Candidate& a, const Candidate& b) { return a.distance < b.distance; });
  std::vector<Candidate> kept;
  for (Candidate& candidate : all) {
    if (kept.size() == count) break;
    const bool is_known = std::any_of(kept.begin(), kept.end(), [&](const Candidate& other) {
      return are_alike(face, candidate.placement, other.placement);
    });
    if (!is_known) kept.push_back(std::move(candidate));
  }
  all = std::move(kept);
}

Ball vault_of(const GenericFace& face, const Placement& placement) {
  return {placement(face.vault.centre), face.vault.radius * placement.scale};
}

/// A step aside from a placement: radians of nod, growth, metres of the generic head upward.
struct Beside {
  double nod, growth, up;
};
constexpr Beside places_beside[] = {{0.2, 1, 0},   {-0.2, 1, 0},   {0, 1.12, 0},    {0, 0.89, 0},
                                    {0, 1, 0.012}, {0, 1, -0.012}, {0.12, 1, 0.01}, {-0.12, 1, -0.01}};

/// `placement` a step aside, about the middle of the face.
Placement moved_beside(const Placement& placement, const Beside& beside) {
  const Vec3 middle(0, 0, 0.09);
  Placement moved = placement;
  moved.scale *= beside.growth;
  moved.rotation = placement.rotation * Eigen::AngleAxisd(beside.nod, Vec3::UnitX()).toRotationMatrix();
  moved.shift = placement(middle + Vec3(0, beside.up, 0)) - moved.scale * (moved.rotation * middle);
  return moved;
}

/// Looks for one head in one surface.
class Search {
 public:
  Search(const GenericFace& face, SearchedSurface& surface, const HeadHints& hints, const ForEach& for_each)
      : face_(face), surface_(surface), hints_(hints), for_each_(for_each), few_(some_face_points(face, 4)) {}

  const Candidate& best() const { return best_; }
  bool has_face(double score) const { return best_.likeness.score() >= score; }

  void by_anchors() {
    const Ball all = surface_.all();
    try_all(guess_by_anchors(face_, hints_.given, surface_.about(all), 6), all, 6);
  }
  void by_lumps() {
    const std::vector<Ball> lumps = round_lumps(surface_.open(), 7);
    std::vector<std::vector<Guess>> guesses(lumps.size());
    run_each(for_each_, lumps.size(),
             [&](size_t k) { guesses[k] = guess_placements(face_, surface_.query(), lumps[k], 16); });
    std::vector<Candidate> candidates;
    for (size_t k = 0; k < lumps.size(); ++k)
      add(candidates, guesses[k], lumps[k]);
    try_all(candidates, 8);
  }
  void by_eyes() {
    const Ball all = surface_.all();
    try_all(guess_by_eyes(face_, surface_.mesh(), surface_.about(all), 24), all, 8);
  }
  const std::vector<EyePair>& pairs() {
    if (!pairs_) pairs_ = eye_pairs(surface_);
    return *pairs_;
  }
  /// Whether the best place has its eyes elsewhere than the surface has eyeballs.
  bool is_beside_eyes() {
    return !pairs().empty() && std::none_of(pairs().begin(), pairs().end(), [&](const EyePair& pair) {
      return !pair.are_balls || has_its_eyes(face_, best_.placement, pair);
    });
  }
  /// By two eyes with a nose below, held to where they are: for faces so unlike people's that closest points
  /// lead away. Whether there are any.
  bool by_eye_pairs() {
    std::vector<Candidate> candidates;
    for (const EyePair& pair : pairs()) {
      if (!pair.has_nose) continue;
      const std::vector<Guess> guesses = guess_by_eye_pair(face_, pair);
      const size_t before = candidates.size();
      add(candidates, guesses, vault_of(face_, guesses.front().placement));
      for (size_t k = before; k < candidates.size(); ++k)
        candidates[k].held = guesses.front().held;
    }
    if (candidates.empty()) return false;
    best_ = {};
    std::vector<Candidate*> refined;
    for (Candidate& candidate : candidates)
      refined.push_back(&candidate);
    refine(refined, 12, 2);
    bend(candidates);
    about_best();
    return true;
  }
  /// From beside the best place: nodding, larger and smaller, higher and lower. A fit may rest with lips on
  /// chin or nose on lips, and what is next to it is better; that the same head ends in the same place
  /// however it is turned depends on this too.
  void about_best() {
    for (int round = 0; round < 2 && !best_.fit.used.empty(); ++round) {
      if (has_face(sure_score)) return;
      const Candidate from = best_;
      std::vector<Candidate> candidates;
      for (const Beside& beside : places_beside)
        for (int k = 0; k < 2; ++k) {
          candidates.push_back(from);
          candidates.back().placement = moved_beside(from.placement, beside);
        }
      std::vector<Candidate*> refined;
      for (size_t k = 0; k < candidates.size(); k += 2)
        refined.push_back(&candidates[k]);
      refine(refined, 6, 3);
      bend(candidates);
      if (best_.likeness.score() < 1.02 * from.likeness.score()) return;
    }
  }
  void by_nose() {
    const Ball all = surface_.all();
    try_all(guess_by_nose(face_, surface_.about(all), 48, for_each_), all, 8);
  }

 private:
  const GenericFace& face_;
  SearchedSurface& surface_;
  const HeadHints& hints_;
  const ForEach& for_each_;
  std::vector<size_t> few_;
  Candidate best_;
  std::optional<std::vector<EyePair>> pairs_;

  const std::vector<Anchor>& held(const Candidate& candidate) const {
    return candidate.held.empty() ? hints_.given : candidate.held;
  }

  void add(std::vector<Candidate>& candidates, const std::vector<Guess>& guesses, const Ball& about) const {
    for (const Guess& guess : guesses) {
      if (hints_.up && guess.placement.rotation.col(1).dot(*hints_.up) < 0.5) continue;
      candidates.emplace_back();
      candidates.back().placement = guess.placement;
      candidates.back().about = about;
    }
  }

  void try_all(const std::vector<Guess>& guesses, const Ball& about, size_t kept) {
    std::vector<Candidate> candidates;
    add(candidates, guesses, about);
    try_all(candidates, kept);
  }

  /// Draws all of `candidates` near, bends the generic head onto the `kept` best of them: the best alone,
  /// which in plain heads is the face, then several at a time.
  void try_all(std::vector<Candidate>& candidates, size_t kept) {
    constexpr size_t at_a_time = 4;
    draw_near(candidates);
    sort_and_keep(candidates, face_, kept);
    for (size_t first = 0, count = 1; first < candidates.size(); first += count, count = at_a_time) {
      std::vector<Candidate> some;
      for (size_t k = first; k < std::min(first + count, candidates.size()); ++k)
        if (candidates[k].distance < 1.0) some.push_back(std::move(candidates[k]));
      std::vector<Candidate*> refined;
      for (Candidate& candidate : some)
        refined.push_back(&candidate);
      refine(refined, 12, 2);
      bend(some);
      if (has_face(sure_score)) return;
    }
  }

  /// Places every candidate on the samples about it and measures how far from them it ends.
  void draw_near(std::vector<Candidate>& candidates) {
    std::vector<const Neighbours*> samples;
    for (const Candidate& candidate : candidates)
      samples.push_back(&surface_.about(candidate.about));
    run_each(for_each_, candidates.size(), [&](size_t k) {
      if (samples[k]->samples().size() < least_samples) return;
      Candidate& candidate = candidates[k];
      const double guessed = candidate.placement.scale;
      candidate.placement =
          refine_placement(face_, *samples[k], candidate.placement, 8, 6, nullptr, held(candidate));
      // A head shrunk to nothing fits anywhere.
      if (std::abs(std::log(candidate.placement.scale / guessed)) > std::log(1.8)) return;
      candidate.distance = distance_from(face_, few_, *samples[k], candidate.placement);
    });
  }

  /// The samples about the head of each candidate. Which samples there are depends on which were asked for
  /// before, so they are always asked for in this order, whatever runs side by side.
  std::vector<const Neighbours*> samples_about(const std::vector<Candidate*>& candidates) {
    std::vector<const Neighbours*> samples;
    for (const Candidate* candidate : candidates)
      samples.push_back(&surface_.about(vault_of(face_, candidate->placement)));
    return samples;
  }

  void refine(const std::vector<Candidate*>& candidates, int rounds, int stride) {
    const std::vector<const Neighbours*> samples = samples_about(candidates);
    run_each(for_each_, candidates.size(), [&](size_t k) {
      if (samples[k]->samples().size() < least_samples) return;
      candidates[k]->placement = refine_placement(face_, *samples[k], candidates[k]->placement, rounds,
                                                  stride, nullptr, held(*candidates[k]));
    });
  }

  /// Bends the generic head onto the surface, from where each candidate stands and once more from where that
  /// brought it.
  void bend(std::vector<Candidate>& candidates) {
    std::vector<Candidate*> left;
    for (Candidate& candidate : candidates)
      left.push_back(&candidate);
    for (int round = 0; round < 2; ++round) {
      const std::vector<const Neighbours*> samples = samples_about(left);
      run_each(for_each_, left.size(), [&](size_t k) {
        if (samples[k]->samples().size() < least_samples) return;
        left[k]->fit = register_face(face_, samples[k]->samples(), left[k]->placement, held(*left[k]));
        left[k]->likeness = likeness(face_, left[k]->fit, *samples[k]);
      });
      std::vector<Candidate*> again;
      for (size_t k = 0; k < left.size(); ++k) {
        if (samples[k]->samples().size() < least_samples) continue;
        const double score = left[k]->likeness.score();
        if (score > best_.likeness.score() || best_.fit.used.empty()) best_ = *left[k];
        if (score >= sure_score) continue;
        left[k]->placement = similarity_of(face_, left[k]->fit);
        again.push_back(left[k]);
      }
      left = std::move(again);
    }
  }
};

[[noreturn]] void refuse(const std::string& path, size_t surfaces) {
  throw Error("'" + path + "': no face was found at any scale or orientation" +
              (surfaces > 1 ? ", neither in all of it nor mesh by mesh" : "") +
              ". If there is one, say where: --landmarks FILE with the two outer corners of the eyes, "
              "exocanthion_left and exocanthion_right (left is the subject's)");
}

}  // namespace

FoundHead find_head(const GenericFace& face, std::span<const TriangleMesh> surfaces, const std::string& path,
                    const HeadHints& hints, const ForEach& for_each) {
  struct Looked {
    std::unique_ptr<SearchedSurface> surface;
    std::unique_ptr<Search> search;
    size_t index;
  };
  std::vector<Looked> looked;
  const bool is_told = hints.given.size() >= 2;
  Looked* best = nullptr;
  const auto judge = [&](Looked& one) {
    if (!one.search->best().fit.used.empty() &&
        (!best || one.search->best().likeness.score() > best->search->best().likeness.score()))
      best = &one;
    return best && best->search->has_face(plain_score);
  };
  looked.reserve(surfaces.size());
  bool is_plain = false;
  for (size_t s = 0; s < surfaces.size() && !is_plain; ++s) {
    auto surface = std::make_unique<SearchedSurface>(surfaces[s]);
    if (surface->open().size() < least_samples) continue;
    auto search = std::make_unique<Search>(face, *surface, hints, for_each);
    looked.push_back({std::move(surface), std::move(search), s});
    if (is_told) {
      looked.back().search->by_anchors();
      looked.back().search->about_best();
    } else {
      looked.back().search->by_lumps();
      if (looked.back().search->has_face(0.5 * least_score)) looked.back().search->about_best();
      if (!looked.back().search->has_face(plain_score)) looked.back().search->by_eyes();
    }
    is_plain = judge(looked.back());
  }
  for (size_t s = 0; s < std::min(looked.size(), surfaces_for_noses) && !is_plain && !is_told; ++s) {
    looked[s].search->by_nose();
    if (looked[s].search->has_face(0.5 * least_score)) looked[s].search->about_best();
    is_plain = judge(looked[s]);
  }
  if (!is_told && best && !is_plain &&
      (!best->search->has_face(least_score) || best->search->is_beside_eyes()))
    best = nullptr;
  const bool is_by_eyes = !is_told && !best && std::any_of(looked.begin(), looked.end(), [&](Looked& one) {
    if (one.search->by_eye_pairs()) best = &one;
    return best != nullptr;
  });
  if (!best) refuse(path, surfaces.size());
  FoundHead found;
  found.fit = best->search->best().fit;
  found.likeness = best->search->best().likeness;
  found.surface = best->index;
  found.is_inside_out = best->surface->is_inside_out();
  found.is_doubtful = is_by_eyes || !best->search->has_face(plain_score);
  if (is_by_eyes) found.eyes = best->search->best().held;
  return found;
}

FoundHead find_head(const GenericFace& face, const TriangleMesh& mesh, const std::string& path,
                    const HeadHints& hints, const ForEach& for_each) {
  return find_head(face, std::span<const TriangleMesh>(&mesh, 1), path, hints, for_each);
}

}  // namespace fascia::landmarks
