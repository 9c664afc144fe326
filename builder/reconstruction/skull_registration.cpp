#include "builder/reconstruction/skull_registration.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "geometry/alignment.h"
#include "geometry/error.h"

namespace fascia::reconstruction {

namespace {

using landmarks::Anchor;
using landmarks::GenericFace;
using landmarks::Neighbours;
using landmarks::Placement;
using landmarks::Samples;

constexpr int generic_samples = 3600, scan_samples = 16000;
constexpr double too_far = 0.012;       // metres: a point farther off counts no more than this
constexpr double not_a_skull = 0.0055;  // mean distance, metres; skulls of other people stay below 3 mm
constexpr double poor_fit = 0.0022;  // mean distance, metres: of heads with skin, and of coarse scans of bone
constexpr double met = 0.006;        // metres: a point farther from the scan has not met it

TriangleMesh whole_skull(const anatomy::GenericAnatomy& anatomy) {
  TriangleMesh all;
  for (const anatomy::MeshObject& object : anatomy.skull) {
    const int first = all.vertex_count();
    all.vertices.insert(all.vertices.end(), object.mesh.vertices.begin(), object.mesh.vertices.end());
    for (const Triangle& t : object.mesh.triangles)
      all.triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
  }
  return all;
}

Vec3 centre_of(const Samples& samples) {
  Vec3 sum = Vec3::Zero();
  for (const Vec3& p : samples.points)
    sum += p / static_cast<double>(samples.size());
  return sum;
}

/// The scan's outer surface. Scans of bone have walls inside and may be wound the wrong way.
Samples outer_samples(const TriangleMesh& scan) {
  const spatial::SurfaceQuery surface(scan);
  Samples samples = landmarks::sample_evenly(scan, scan_samples);
  if (samples.size() < 100) throw Error("the skull has hardly any surface: give a mesh of the whole bone");
  if (landmarks::is_inside_out(samples, surface))
    for (Vec3& n : samples.normals)
      n = -n;
  Samples open = landmarks::open_samples(samples, surface);
  return open.size() < 100 ? samples : open;
}

/// Turns to begin from: the 24 of a cube, each also half-way to its neighbours about every axis.
std::vector<Mat3> turns() {
  std::vector<Mat3> all;
  for (int x = 0; x < 3; ++x)
    for (int y = 0; y < 3; ++y)
      for (int signs = 0; signs < 4 && x != y; ++signs) {
        Mat3 turn;
        turn.col(0) = (signs & 1 ? -1.0 : 1.0) * Vec3::Unit(x);
        turn.col(1) = (signs & 2 ? -1.0 : 1.0) * Vec3::Unit(y);
        turn.col(2) = turn.col(0).cross(turn.col(1));
        all.push_back(turn);
        for (int axis = 0; axis < 3; ++axis)
          all.push_back(turn *
                        Eigen::AngleAxisd(0.25 * std::numbers::pi, Vec3::Unit(axis)).toRotationMatrix());
      }
  return all;
}

/// How far the skull is from the scan and the scan from the skull, metres of the generic skull. Both ways,
/// since a part of a skull fits well anywhere in a scan with many walls.
double misfit(const GenericFace& skull, const Neighbours& scan, const Neighbours& generic, const Placement& p,
              size_t stride) {
  std::vector<size_t> some;
  for (size_t i = 0; i < skull.points.size(); i += stride)
    if (skull.weights[i] > 0.5) some.push_back(i);
  const double there = landmarks::distance_from(skull, some, scan, p);
  double back = 0.0;
  int count = 0;
  std::vector<size_t> near;
  std::vector<double> squared;
  for (size_t i = 0; i < scan.samples().size(); i += 4 * stride, ++count) {
    generic.nearest(p.inverse(scan.samples().points[i]), 1, near, squared);
    back += std::min(too_far, std::sqrt(squared.front()));
  }
  return there + back / count;
}

struct Start {
  Placement placement;
  double misfit = 0.0;
};

/// Places to begin from, best first, each brought closer in a few rounds.
std::vector<Start> starts(const GenericFace& skull, const Neighbours& scan, const Neighbours& generic,
                          double metres) {
  const Vec3 from = centre_of(skull.points), to = centre_of(scan.samples());
  std::vector<Start> all;
  for (const Mat3& turn : turns())
    for (double up : {-0.05, 0.0, 0.05}) {  // a scan may lack the vault, or have a neck
      Placement start;
      start.scale = 1.0 / metres;
      start.rotation = turn;
      start.shift = to - start.scale * (turn * (from + Vec3(0.0, up, 0.0)));
      start = landmarks::refine_placement(skull, scan, start, 8, 24);
      all.push_back({start, misfit(skull, scan, generic, start, 16)});
    }
  std::stable_sort(all.begin(), all.end(),
                   [](const Start& a, const Start& b) { return a.misfit < b.misfit; });
  return all;
}

Placement placement_of(const Mat4& similarity) {
  Placement placement;
  placement.scale = similarity.topLeftCorner<3, 1>().norm();
  placement.rotation = similarity.topLeftCorner<3, 3>() / placement.scale;
  placement.shift = similarity.topRightCorner<3, 1>();
  return placement;
}

Placement place(const GenericFace& skull, const Neighbours& scan, double metres,
                const std::vector<Anchor>& anchors) {
  if (anchors.size() >= 3) {
    std::vector<Vec3> from, to;
    for (const Anchor& anchor : anchors) {
      from.push_back(anchor.generic);
      to.push_back(anchor.target);
    }
    return landmarks::refine_placement(skull, scan, placement_of(similarity(from, to)), 30, 3, nullptr,
                                       anchors);
  }
  const Neighbours generic(skull.points);
  std::vector<Start> all = starts(skull, scan, generic, metres);
  all.resize(std::min<size_t>(all.size(), 12));
  for (Start& start : all) {
    start.placement = landmarks::refine_placement(skull, scan, start.placement, 40, 4);
    const double growth = std::abs(std::log(start.placement.scale * metres));
    // Skulls of one kind differ by a tenth or so in size: more speaks against a place.
    start.misfit = misfit(skull, scan, generic, start.placement, 4) + 0.01 * std::max(0.0, growth - 0.15);
  }
  return std::min_element(all.begin(), all.end(),
                          [](const Start& a, const Start& b) { return a.misfit < b.misfit; })
      ->placement;
}

/// How many of eyes and nose tip have something of the scan before them: none on a skull, which is open
/// there.
int covered_openings(const anatomy::GenericAnatomy& anatomy, const TriangleMesh& scan,
                     const landmarks::Registration& fit) {
  const spatial::SurfaceQuery surface(scan);
  const auto is_covered = [&](const Vec3& behind, const Vec3& before) {
    const Vec3 from = fit(behind), way = fit(before) - from;
    return surface.blocked(from, way, way.norm());
  };
  int covered = 0;
  for (const char* name : {"eye_left", "eye_right"})
    if (const anatomy::MeshObject* eye = anatomy.head_object(name); eye && !eye->mesh.empty()) {
      const Vec3 centre = bounds(eye->mesh.vertices).centre();
      covered += is_covered(centre, centre + Vec3(0.0, 0.0, 0.04));
    }
  const anatomy::Landmark* tip = anatomy.landmark("pronasale");
  const anatomy::Landmark* wing = anatomy.landmark("subnasale");
  if (tip && tip->skin && wing && wing->skin) {
    // From the piriform aperture, a little above the nasal spine, through the soft nose.
    const Vec3 inside(0.0, 0.5 * (tip->skin->y() + wing->skin->y()) + 0.006, wing->skin->z() - 0.008);
    covered += is_covered(inside, inside + Vec3(0.0, 0.0, 0.06));
  }
  return covered;
}

}  // namespace

GenericFace skull_points(const anatomy::GenericAnatomy& anatomy) {
  const TriangleMesh mesh = whole_skull(anatomy);
  const spatial::SurfaceQuery surface(mesh);
  GenericFace skull;
  skull.points = landmarks::open_samples(landmarks::sample_evenly(mesh, generic_samples), surface);
  const anatomy::Landmark* glabella = anatomy.landmark("glabella");
  const anatomy::Landmark* tragion = anatomy.landmark("tragion_left");
  if (!glabella || !glabella->skin || !tragion || !tragion->skin)
    throw Error("anatomy: glabella or tragion_left has no place on the skin");
  const double brow = glabella->skin->y() + 0.02, ear = tragion->skin->z() - 0.01;
  for (const Vec3& p : skull.points.points)
    skull.weights.push_back(p.y() < brow && p.z() > ear ? 1.0 : 0.3);
  return skull;
}

SkullRegistration register_skull(const anatomy::GenericAnatomy& anatomy, const TriangleMesh& scan,
                                 double metres, const Landmarks& known) {
  SkullRegistration out;
  out.points = skull_points(anatomy);
  const Samples outer = outer_samples(scan);
  std::vector<Anchor> anchors;
  for (const auto& [name, place_on_scan] : known) {
    const anatomy::Landmark* landmark = anatomy.landmark(name);
    if (landmark && landmark->bone)
      anchors.push_back({*landmark->bone, place_on_scan, 3.0});
    else
      out.warnings.push_back("landmark '" + name + "' is not known on bone: left out");
  }
  const Placement placement = place(out.points, Neighbours(outer), metres, anchors);
  landmarks::RegistrationOptions options;
  options.stages = {{10, 3, 3}, {3, 3, 3}, {1, 2, 3}, {0.3, 2, 3}};
  out.fit = landmarks::register_face(out.points, outer, placement, anchors, options);
  int count = 0;
  for (double residual : out.fit.residuals) {
    if (!(residual < met)) continue;
    out.mean_residual += residual;
    ++count;
  }
  out.covered_share = static_cast<double>(count) / static_cast<double>(out.fit.residuals.size());
  if (count > 0) out.mean_residual /= count;
  if (count < 50 || out.covered_share < 0.15 || out.mean_residual > not_a_skull)
    throw Error(
        anchors.size() >= 3
            ? "the generic skull does not come to lie on it: check that the landmarks lie on its bone, in "
              "the file's own axes"
            : "no skull was found in it: give craniometric landmarks on the bone with --landmarks (nasion, "
              "menton, zygion_left and zygion_right say enough)");
  const int covered = covered_openings(anatomy, scan, out.fit);
  if (covered >= 2 || (covered == 1 && out.mean_residual > poor_fit))
    throw Error(
        "it has eyes and a nose of flesh, so it is a head and no skull: give the bone alone, or make its rig "
        "with 'fascia build'");
  return out;
}

}  // namespace fascia::reconstruction
