#include "snapshot/face_regions.h"

#include <algorithm>
#include <limits>
#include <map>

#include "geometry/error.h"
#include "geometry/landmarks.h"
#include "geometry/mesh.h"

namespace fascia::snapshot {

namespace {

/// Which landmarks lie in which region; a name that ends in '_' stands for both sides.
const std::vector<std::pair<std::string, std::vector<std::string>>>& landmarks_of_regions() {
  static const std::vector<std::pair<std::string, std::vector<std::string>>> table = {
      {"forehead", {"trichion", "metopion", "supraglabella"}},
      {"glabella", {"glabella", "sellion"}},
      {"temple_", {"frontotemporale_", "frontomalare_temporale_"}},
      {"brow_medial_", {"superciliare_mediale_", "superciliare_medium_mediale_"}},
      {"brow_lateral_", {"superciliare_laterale_", "superciliare_medium_laterale_", "superciliare_"}},
      {"lid_upper_", {"palpebrale_superius_", "sulcus_palpebralis_superior_"}},
      {"lid_lower_", {"palpebrale_inferius_"}},
      {"canthus_lateral_", {"exocanthion_"}},
      {"canthus_medial_", {"endocanthion_"}},
      {"nose", {"mid_nasal", "rhinion", "pronasale", "columella"}},
      {"ala_", {"alare_", "subalare_", "alar_groove_", "alar_curvature_"}},
      {"cheek_upper_", {"orbitale_", "malare_", "zygomaxillare_skin_", "mid_infraorbital_"}},
      {"cheek_lower_", {"buccale_", "ectomolare_superius_", "ectomolare_inferius_"}},
      {"philtrum", {"subnasale", "mid_philtrum", "crista_philtri_left", "crista_philtri_right"}},
      {"lip_upper",
       {"labiale_superius", "labiale_superius_laterale_left", "labiale_superius_laterale_right"}},
      {"lip_lower",
       {"labiale_inferius", "labiale_inferius_laterale_left", "labiale_inferius_laterale_right"}},
      {"mouth_corner_", {"cheilion_", "modiolus_"}},
      {"chin", {"sublabiale", "supramentale", "pogonion", "gnathion", "menton"}},
      {"jaw_", {"mid_mandibular_border_", "gonion_", "mid_ramus_"}},
      {"neck", {"cervicale"}},
  };
  return table;
}

using Points = std::vector<Vec3>;

/// A vertex and where it lies at rest, metres.
struct Place {
  Vertex vertex;
  Vec3 at = Vec3::Zero();
};

std::vector<Place> places_of(const std::vector<PlayedMesh>& meshes, size_t mesh) {
  std::vector<Place> places;
  const std::vector<float>& rest = meshes[mesh].rest;
  for (uint32_t v = 0; v < rest.size() / 3; ++v)
    places.push_back({{static_cast<uint32_t>(mesh), v}, Vec3(rest[3 * v], rest[3 * v + 1], rest[3 * v + 2])});
  return places;
}

double distance(const Vec3& p, const Points& points) {
  double least = std::numeric_limits<double>::infinity();
  for (const Vec3& q : points)
    least = std::min(least, (p - q).norm());
  return least;
}

/// `count` of the places, each as far from those before it as can be (Gonzalez, Clustering to minimize the
/// maximum intercluster distance, 1985); the first is the one nearest to `start`.
std::vector<Place> spread(const std::vector<Place>& places, size_t count, const Points& start) {
  if (places.empty()) return {};
  std::vector<double> away(places.size());
  size_t next = 0;
  for (size_t i = 0; i < places.size(); ++i) {
    away[i] = distance(places[i].at, start);
    if (away[i] < away[next]) next = i;
  }
  std::fill(away.begin(), away.end(), std::numeric_limits<double>::infinity());
  std::vector<Place> chosen;
  while (chosen.size() < count && away[next] > 0.0) {
    chosen.push_back(places[next]);
    for (size_t i = 0; i < places.size(); ++i)
      away[i] = std::min(away[i], (places[i].at - chosen.back().at).norm());
    next = static_cast<size_t>(std::max_element(away.begin(), away.end()) - away.begin());
  }
  return chosen;
}

void add(std::vector<Region>& regions, const std::string& name, const std::vector<Place>& places,
         double tolerance_mm) {
  if (places.empty()) return;
  Region region{name, {}, tolerance_mm};
  for (const Place& place : places)
    region.vertices.push_back(place.vertex);
  std::sort(region.vertices.begin(), region.vertices.end());
  region.vertices.erase(std::unique(region.vertices.begin(), region.vertices.end()), region.vertices.end());
  regions.push_back(std::move(region));
}

/// Every region's name and its landmarks' places, those that the rig has.
std::vector<std::pair<std::string, Points>> places(const std::vector<rig::Landmark>& landmarks) {
  Landmarks known;
  for (const rig::Landmark& landmark : landmarks)
    known[landmark.name] = landmark.skin.cast<double>();
  std::vector<std::pair<std::string, Points>> list;
  for (const auto& [region, names] : landmarks_of_regions())
    for (const char* side : {"left", "right"}) {
      const bool is_paired = region.back() == '_';
      if (!is_paired && std::string(side) == "right") continue;
      Points points;
      for (const std::string& name : names)
        if (const auto found = known.find(name.back() == '_' ? name + side : name); found != known.end())
          points.push_back(found->second);
      if (!points.empty()) list.emplace_back(is_paired ? region + side : region, points);
    }
  return list;
}

/// Vertices of the mesh that `want` names by their numbers.
std::vector<Place> named_places(const WantedRegion& want, const std::vector<PlayedMesh>& meshes) {
  for (size_t m = 0; m < meshes.size(); ++m) {
    if (meshes[m].mesh != want.mesh || meshes[m].primitive != want.primitive) continue;
    const std::vector<Place> all = places_of(meshes, m);
    std::vector<Place> places;
    for (const uint32_t v : want.vertices) {
      if (v >= all.size())
        throw Error("region '" + want.name + "': its mesh has no vertex " + std::to_string(v) + ", only " +
                    std::to_string(all.size()));
      places.push_back(all[v]);
    }
    return places;
  }
  throw Error("region '" + want.name + "': the rig moves no mesh " + std::to_string(want.mesh) +
              ", primitive " + std::to_string(want.primitive) + "; 'fascia info RIG' lists what it moves");
}

/// Skin about the landmarks that `want` names.
std::vector<Place> places_about(const WantedRegion& want, const std::vector<PlayedMesh>& meshes,
                                const std::vector<rig::Landmark>& landmarks, size_t count) {
  Points centres;
  for (const std::string& name : want.landmarks) {
    const auto found = std::find_if(landmarks.begin(), landmarks.end(),
                                    [&](const rig::Landmark& landmark) { return landmark.name == name; });
    if (found == landmarks.end())
      throw Error("region '" + want.name + "': the rig has no landmark '" + name + "'");
    centres.push_back(found->skin.cast<double>());
  }
  std::vector<Place> near;
  for (size_t m = 0; m < meshes.size(); ++m)
    if (meshes[m].part == "skin")
      for (const Place& place : places_of(meshes, m))
        if (distance(place.at, centres) <= 1e-3 * want.radius_mm) near.push_back(place);
  if (near.empty())
    throw Error("region '" + want.name + "': no vertex of the skin lies in it; widen radius_mm");
  return spread(near, count, centres);
}

}  // namespace

std::vector<Region> face_regions(const std::vector<PlayedMesh>& meshes,
                                 const std::vector<rig::Landmark>& landmarks, const RegionOptions& options) {
  const auto centres = places(landmarks);
  std::vector<std::vector<Place>> members(centres.size());
  std::vector<Region> regions;
  for (size_t m = 0; m < meshes.size(); ++m) {
    if (meshes[m].part != "skin") continue;
    for (const Place& place : places_of(meshes, m)) {
      double least = 1e-3 * options.reach_mm;
      size_t nearest = members.size();
      for (size_t r = 0; r < members.size(); ++r)
        if (const double away = distance(place.at, centres[r].second); away < least) {
          least = away;
          nearest = r;
        }
      if (nearest < members.size()) members[nearest].push_back(place);
    }
  }
  for (size_t r = 0; r < members.size(); ++r)
    add(regions, centres[r].first, spread(members[r], options.vertices, centres[r].second),
        options.tolerance_mm);
  std::map<std::string, std::vector<Place>> parts;
  for (size_t m = 0; m < meshes.size(); ++m)
    if (meshes[m].part != "skin")
      for (const Place& place : places_of(meshes, m))
        parts[meshes[m].part].push_back(place);
  for (const auto& [part, members_of_part] : parts)
    add(regions, part, spread(members_of_part, options.vertices, {members_of_part[0].at}),
        options.tolerance_mm);
  return regions;
}

std::vector<Region> own_regions(const std::vector<WantedRegion>& wanted,
                                const std::vector<PlayedMesh>& meshes,
                                const std::vector<rig::Landmark>& landmarks, const RegionOptions& options) {
  std::vector<Region> regions;
  for (const WantedRegion& want : wanted)
    add(regions, want.name,
        want.landmarks.empty() ? named_places(want, meshes)
                               : places_about(want, meshes, landmarks, options.vertices),
        want.tolerance_mm > 0.0 ? want.tolerance_mm : options.tolerance_mm);
  return regions;
}

}  // namespace fascia::snapshot
