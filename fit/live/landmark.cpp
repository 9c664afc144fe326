#include "fit/live/landmark.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "geometry/error.h"
#include "sim/closest_point.h"

namespace fascia::fit {
namespace {

/// The binding of a primitive, or null.
const rig::Binding* binding_of(const rig::RigFile& file, size_t level, size_t primitive) {
  for (const rig::Binding& binding : file.rig.tissue.bindings[level])
    if (file.primitive_of(binding) == primitive) return &binding;
  return nullptr;
}

Vec3 place_in_metres(const rig::Binding& binding, const rig::Vec3f& position) {
  return transform_point(binding.to_rig.cast<double>(), position.cast<double>());
}

}  // namespace

std::optional<SkinPlace> nearest_skin(const rig::RigFile& file, size_t level, const Vec3& point,
                                      double farthest) {
  std::optional<SkinPlace> best;
  double best_distance = farthest;
  for (const rig::Binding& binding : file.rig.tissue.bindings[level]) {
    if (binding.part != "skin") continue;
    const size_t p = file.primitive_of(binding);
    const rig::Primitive& primitive = file.primitives[p];
    std::vector<Vec3> places;
    places.reserve(primitive.positions.size());
    for (const rig::Vec3f& position : primitive.positions)
      places.push_back(place_in_metres(binding, position));
    for (const rig::Triangle& t : primitive.triangles) {
      const Vec3 &a = places[t[0]], &b = places[t[1]], &c = places[t[2]];
      const double reach = best_distance + std::sqrt(std::max((b - a).squaredNorm(), (c - a).squaredNorm()));
      if ((a - point).squaredNorm() > reach * reach) continue;
      const Vec3 shares = sim::closest_weights(point, a, b, c);
      const double distance = (shares[0] * a + shares[1] * b + shares[2] * c - point).norm();
      if (!(distance < best_distance)) continue;
      best_distance = distance;
      best = SkinPlace{static_cast<uint32_t>(p), t, {shares[0], shares[1], shares[2]}};
    }
  }
  return best;
}

Landmark landmark_at(const rig::RigFile& file, size_t level, const SkinPlace& place) {
  const rig::Binding* binding = binding_of(file, level, place.primitive);
  if (binding == nullptr)
    throw Error("the rig moves no primitive " + std::to_string(place.primitive) + " at this level");
  Landmark landmark;
  std::map<uint32_t, double> influences;
  for (size_t k = 0; k < 3; ++k) {
    const size_t vertex = place.vertices[k];
    if (vertex >= binding->vertex_count)
      throw Error("a landmark names vertex " + std::to_string(vertex) + ", and its primitive has " +
                  std::to_string(binding->vertex_count));
    if (place.shares[k] == 0.0) continue;
    if (binding->eye[vertex] != 0) throw Error("a landmark lies on an eye: give places on the skin");
    landmark.rest +=
        place.shares[k] * place_in_metres(*binding, file.primitives[place.primitive].positions[vertex]);
    landmark.jaw_share += place.shares[k] * static_cast<double>(binding->jaw_weights[vertex]);
    for (size_t i = vertex * binding->influences; i < (vertex + 1) * binding->influences; ++i)
      if (binding->weights[i] != 0.0F)
        influences[binding->nodes[i]] += place.shares[k] * static_cast<double>(binding->weights[i]);
  }
  landmark.influences.assign(influences.begin(), influences.end());
  return landmark;
}

std::optional<SkinPlace> place_of_landmark(const rig::RigFile& file, size_t level, std::string_view name) {
  for (const rig::Landmark& landmark : file.rig.skull.landmarks)
    if (landmark.name == name) return nearest_skin(file, level, landmark.skin.cast<double>());
  return {};
}

}  // namespace fascia::fit
