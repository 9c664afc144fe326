#include "builder/landmarks/generic_face.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <sstream>

#include "builder/landmarks/likeness.h"
#include "builder/landmarks/spheres.h"
#include "geometry/error.h"

namespace fascia::landmarks {

namespace {

Vec3 place(const anatomy::GenericAnatomy& anatomy, const char* name) {
  const anatomy::Landmark* landmark = anatomy.landmark(name);
  if (!landmark || !landmark->skin) throw Error(std::string("the anatomy has no skin point '") + name + "'");
  return *landmark->skin;
}

/// Where faces differ and features are small: corners and margins of eyes and mouth, the nose.
std::vector<Vec3> feature_points(const anatomy::GenericAnatomy& anatomy) {
  std::vector<Vec3> features;
  for (const char* name :
       {"pronasale", "subnasale", "labiale_superius", "labiale_inferius", "stomion", "columella"})
    features.push_back(place(anatomy, name));
  for (const char* name : {"exocanthion", "endocanthion", "palpebrale_superius", "palpebrale_inferius",
                           "cheilion", "alare", "labiale_superius_laterale", "labiale_inferius_laterale"})
    for (const char* side : {"_left", "_right"})
      features.push_back(place(anatomy, (std::string(name) + side).c_str()));
  return features;
}

double spacing_at(const Vec3& p, const std::vector<Vec3>& features) {
  double nearest = 1e300;
  for (const Vec3& f : features)
    nearest = std::min(nearest, (p - f).norm());
  return std::clamp(0.0035 + 0.2 * nearest, 0.0035, 0.020);
}

Vec3 mirrored(const Vec3& v) {
  return {-v[0], v[1], v[2]};
}

/// Outer skin of the left half and the midline: from these the surface is free to be left along the normal
/// and away from the head's middle. The first `landmark_count` are the landmarks.
Samples outer_left(const anatomy::GenericAnatomy& anatomy, const TriangleMesh& skin, size_t& landmark_count) {
  const spatial::SurfaceQuery surface(skin);
  const std::vector<Vec3> normals = vertex_normals(skin);
  const Vec3 middle = 0.5 * (place(anatomy, "tragion_left") + place(anatomy, "tragion_right"));
  Samples outer;
  const auto add = [&](const Vec3& p, const Vec3& n, bool is_trusted) {
    if (p[0] < -1e-6) return;
    const Vec3 from = p + 2e-4 * n;
    const Vec3 away = (p - middle).normalized();
    if (is_trusted || (!surface.blocked(from, n) && !surface.blocked(from, away) && n.dot(away) > -0.2))
      outer.add(p, n);
  };
  for (const anatomy::Landmark& landmark : anatomy.landmarks)
    if (landmark.skin && landmark.name.rfind("pupilla", 0) != 0) add(*landmark.skin, landmark.normal, true);
  landmark_count = outer.size();
  for (size_t v = 0; v < skin.vertices.size(); ++v)
    if (normals[v].norm() > 0.5) add(skin.vertices[v], normals[v], false);
  return outer;
}

Ball eyeball(const anatomy::GenericAnatomy& anatomy, const char* name) {
  const anatomy::MeshObject* eye = anatomy.head_object(name);
  return eye ? fit_ball(eye->mesh.vertices) : Ball{};
}

/// First triangle of each polygon of the object `skin` in `head`, an OBJ file, as fans, and one past the
/// last.
std::vector<size_t> first_triangles(const std::string& head) {
  std::istringstream lines{head};
  std::vector<size_t> first = {0};
  bool is_skin = false;
  for (std::string line; std::getline(lines, line);) {
    if (line.rfind("o ", 0) == 0) is_skin = line.rfind("o skin", 0) == 0;
    if (!is_skin || line.rfind("f ", 0) != 0) continue;
    std::istringstream corners(line.substr(2));
    const auto count =
        std::distance(std::istream_iterator<std::string>(corners), std::istream_iterator<std::string>());
    first.push_back(first.back() + static_cast<size_t>(count) - 2);
  }
  return first;
}

/// Takes over which polygons of the skin make up which region.
void take_regions(const anatomy::GenericAnatomy& anatomy, GenericFace& face) {
  const std::vector<size_t> first = first_triangles(anatomy.head_source);
  face.region_of_triangle.assign(face.skin.triangles.size(), -1);
  for (const anatomy::SkinRegion& region : anatomy.skin_regions) {
    const size_t end = region.first + region.count;
    if (end >= first.size() || first.back() != face.skin.triangles.size())
      throw Error("head_regions.json, " + region.name +
                  ": does not belong to the skin of head.obj; make both with tools/anatomy/make_head");
    for (size_t t = first[region.first]; t < first[end]; ++t)
      face.region_of_triangle[t] = static_cast<int>(face.region_names.size());
    face.region_names.push_back(region.name);
  }
}

}  // namespace

GenericFace generic_face(const anatomy::GenericAnatomy& anatomy) {
  const anatomy::MeshObject* object = anatomy.head_object("skin");
  if (!object) throw Error("the anatomy's head has no object 'skin'");
  GenericFace face;
  face.skin = object->mesh;
  face.eye_left = eyeball(anatomy, "eye_left");
  face.eye_right = eyeball(anatomy, "eye_right");
  face.nose_tip = place(anatomy, "pronasale");
  take_regions(anatomy, face);
  const std::vector<Vec3> features = feature_points(anatomy);
  size_t landmark_count = 0;
  const Samples outer = outer_left(anatomy, face.skin, landmark_count);
  Samples chosen;
  for (size_t i = 0; i < outer.size(); ++i) {
    const Vec3& p = outer.points[i];
    // Landmarks come first and may be close together; nothing repeats one point.
    const bool is_landmark = i < landmark_count;
    const double spacing = is_landmark ? std::min(0.002, spacing_at(p, features)) : spacing_at(p, features);
    if (p[0] > 1e-6 && p[0] < 0.4 * spacing) continue;
    const bool is_crowded = std::any_of(chosen.points.begin(), chosen.points.end(), [&](const Vec3& q) {
      return (q - p).squaredNorm() < spacing * spacing;
    });
    if (!is_crowded) chosen.add(p, outer.normals[i].normalized());
  }
  const Vec3 menton = place(anatomy, "menton"), tragion = place(anatomy, "tragion_left"),
             trichion = place(anatomy, "trichion");
  for (size_t i = 0; i < chosen.size(); ++i) {
    const Vec3 p = chosen.points[i], n = chosen.normals[i];
    const bool is_midline = std::abs(p[0]) < 1e-6;
    // The chin's underside belongs to the face, the neck does not.
    const bool is_neck = p[1] < menton[1] + 0.3 * (0.09 - p[2]) - 0.004;
    const bool is_ear = std::abs(p[0]) > 0.072 && p[2] < 0.02 && p[1] < 0.045;
    const bool is_face = !is_neck && p[2] > tragion[2] + 0.015 && p[1] < trichion[1];
    const double weight = is_neck ? 0.0 : is_face ? 1.0 : is_ear ? 0.3 : 0.4;
    for (const bool is_right : {false, true}) {
      if (is_right && is_midline) continue;
      const int self = static_cast<int>(face.points.size());
      face.mirror.push_back(is_midline ? self : is_right ? self - 1 : self + 1);
      face.points.add(is_right ? mirrored(p) : p, is_right ? mirrored(n) : n);
      face.weights.push_back(weight);
      face.is_face.push_back(is_face);
      face.is_feature.push_back(is_face && spacing_at(p, features) < 0.0055);
    }
  }
  // Found as they will be found on other meshes, so that the two are alike.
  const spatial::SurfaceQuery surface(face.skin);
  face.vault = round_lumps(open_samples(sample_evenly(face.skin, 3000), surface), 2).front();
  face.relief = relief(Neighbours(open_samples(sample_evenly(face.skin, 5000), surface)), face.points.points,
                       face.points.normals, 1.0);
  return face;
}

}  // namespace fascia::landmarks
