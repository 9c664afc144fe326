#include "tests/skull/ct_head.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <set>

#include "builder/prepare/prepare.h"
#include "builder/skull/exterior.h"
#include "builder/spatial/surface_query.h"
#include "formats/landmark_file.h"
#include "formats/scene.h"

namespace fascia::testing {

namespace {

constexpr double deepest = 0.030;  // m; what lies deeper is not the bone of the face's surface

/// Which landmarks stand for which region of the facial skeleton; the others stand for soft parts.
const std::map<std::string, std::string>& regions() {
  static const std::map<std::string, std::string> all = [] {
    std::map<std::string, std::string> out;
    const auto add = [&](const std::string& region, const std::vector<std::string>& names) {
      for (const std::string& name : names)
        for (const char* side : {"", "_left", "_right"})
          out[name + side] = region;
    };
    add("forehead and brow", {"glabella", "supraglabella", "mid_supraorbital", "superciliare",
                              "superciliare_mediale", "superciliare_laterale", "superciliare_medium_mediale",
                              "superciliare_medium_laterale", "orbitale_superius"});
    add("nasal bones", {"nasion", "sellion", "mid_nasal", "rhinion", "maxillofrontale"});
    add("lower orbit and cheekbone", {"mid_infraorbital", "orbitale", "malare", "zygomaxillare_skin"});
    add("zygomatic arch", {"zygion"});
    add("maxilla", {"subspinale", "mid_philtrum", "alar_curvature", "subalare", "supracanine"});
    add("mandible body", {"mid_mandibular_border", "infracanine"});
    add("chin", {"supramentale", "pogonion", "gnathion", "menton", "sublabiale"});
    add("mandible ramus", {"gonion", "mid_ramus"});
    return out;
  }();
  return all;
}

Vec3 smooth_normal(const skull::Exterior& skin, const Vec3& at) {
  const spatial::ClosestPoint foot = skin.surface.closest(at);
  const Vec3 normal = skin.surface.smooth_normal(foot.surface);
  const Vec3 u = normal.unitOrthogonal(), v = normal.cross(u);
  Vec3 sum = normal;
  for (int k = 0; k < 8; ++k) {
    const double angle = k * std::numbers::pi / 4;
    const Vec3 beside = at + 0.005 * (std::cos(angle) * u + std::sin(angle) * v);
    sum += skin.surface.smooth_normal(skin.surface.closest(beside).surface);
  }
  return sum.normalized();
}

/// Distance from `point` to the mouth's tube, which hangs from the lips in front of the chin (frame of the
/// scan, mm).
double tube_distance(const Vec3& scan) {
  const Vec3 top(88.2, 45, -96), bottom(90.2, 45, -138);
  const double along = std::clamp((scan - top).dot(bottom - top) / (bottom - top).squaredNorm(), 0.0, 1.0);
  return (scan - top - along * (bottom - top)).norm();
}

Vec3 to_scan(const Mat4& scan_to_rig, const Vec3& rig) {
  return scan_to_rig.topLeftCorner<3, 3>().inverse() * (rig - scan_to_rig.topRightCorner<3, 1>());
}

}  // namespace

bool has_ct_head(const std::filesystem::path& measured) {
  return std::filesystem::exists(measured / "data/ct/headsq_skin.ply") &&
         std::filesystem::exists(measured / "data/ct/headsq_bone.ply");
}

std::map<std::string, skull::TargetLandmark> complete_targets(const TriangleMesh& skin,
                                                              const Landmarks& given,
                                                              const anatomy::GenericAnatomy& anatomy) {
  std::map<std::string, skull::TargetLandmark> out;
  for (const auto& [name, landmark] : landmarks::complete(given, anatomy, spatial::SurfaceQuery(skin)))
    out[name] = {landmark.position, landmark.confidence};
  return out;
}

CtHead read_ct_head(const std::filesystem::path& measured, const std::filesystem::path& landmark_file,
                    const anatomy::GenericAnatomy& anatomy) {
  Landmarks reference;
  for (const anatomy::Landmark& landmark : anatomy.landmarks)
    if (landmark.skin) reference[landmark.name] = *landmark.skin;
  const formats::Scene scene = formats::read(measured / "data/ct/headsq_skin.ply");
  prepare::PreparedHead prepared =
      prepare::prepare(scene, formats::read_landmarks(landmark_file), reference, {});
  const formats::Scene bones = formats::read(measured / "data/ct/headsq_bone.ply");
  CtHead out;
  out.skin = std::move(prepared.skin);
  out.bone = {bones.meshes.front().positions, bones.meshes.front().triangles};
  for (Vec3& v : out.bone.vertices)
    v = transform_point(prepared.input_to_metres, v);
  out.scan_to_rig = prepared.input_to_metres;
  out.given = std::move(prepared.landmarks);
  out.targets = complete_targets(out.skin, out.given, anatomy);
  return out;
}

std::vector<DepthSample> depth_samples(const CtHead& head) {
  const skull::Exterior skin = skull::exterior(head.skin);
  const spatial::SurfaceQuery bone(head.bone);
  std::vector<DepthSample> out;
  std::set<std::array<int, 3>> cells;
  const TriangleMesh& mesh = skin.surface.mesh();
  for (int t = 0; t < mesh.triangle_count(); ++t) {
    const Vec3 p = position(mesh, {t, Vec3::Constant(1.0 / 3)});
    const Vec3 scan = to_scan(head.scan_to_rig, p);
    if (tube_distance(scan) < 14 || scan.z() > -5 || scan.z() < -133) continue;
    std::string nearest;
    double distance = 0.02;
    for (const auto& [name, landmark] : head.targets)
      if (const double d = (landmark.skin - p).norm(); d < distance) distance = d, nearest = name;
    const auto region = regions().find(nearest);
    if (region == regions().end()) continue;
    const Vec3 cell = p / 0.004;
    if (!cells
             .insert({static_cast<int>(std::floor(cell.x())), static_cast<int>(std::floor(cell.y())),
                      static_cast<int>(std::floor(cell.z()))})
             .second)
      continue;
    DepthSample sample{region->second, p, -smooth_normal(skin, p), 0};
    const auto hit = bone.first_hit(p, sample.inward, deepest);
    if (!hit) continue;
    sample.depth = hit->distance;
    out.push_back(sample);
  }
  return out;
}

std::map<std::string, DepthError> depth_errors(const std::vector<DepthSample>& samples,
                                               const skull::FitResult& fit) {
  TriangleMesh all;
  for (const TriangleMesh* mesh : {&fit.cranium, &fit.mandible, &fit.teeth_upper, &fit.teeth_lower}) {
    const int base = all.vertex_count();
    all.vertices.insert(all.vertices.end(), mesh->vertices.begin(), mesh->vertices.end());
    for (const Triangle& t : mesh->triangles)
      all.triangles.push_back({t[0] + base, t[1] + base, t[2] + base});
  }
  const spatial::SurfaceQuery fitted(all);
  std::map<std::string, DepthError> out;
  std::map<std::string, std::vector<double>> errors;
  for (const DepthSample& sample : samples) {
    const auto hit = fitted.first_hit(sample.skin - 0.01 * sample.inward, sample.inward, deepest + 0.02);
    const double off = hit ? hit->distance - 0.01 - sample.depth
                           : fitted.closest(sample.skin + sample.depth * sample.inward).distance;
    for (const std::string& name : {sample.region, std::string("all")}) {
      DepthError& error = out[name];
      ++error.samples;
      error.missed += !hit;
      error.mean += std::abs(off);
      error.bias += off;
      errors[name].push_back(std::abs(off));
    }
  }
  for (auto& [name, error] : out) {
    error.mean /= error.samples;
    error.bias /= error.samples;
    std::vector<double>& all_errors = errors[name];
    std::sort(all_errors.begin(), all_errors.end());
    error.ninth_decile = all_errors[all_errors.size() * 9 / 10];
  }
  return out;
}

}  // namespace fascia::testing
