#include "view/face/joint_normals.h"

#include <algorithm>
#include <map>

#include "view/smooth_normals.h"

namespace fascia::view {

namespace {

/// Vertices at one place by place alone, told apart again where `own` normals face away from each other.
std::vector<int> seams_that_agree(const std::vector<int>& places, const std::vector<Vec3>& own) {
  std::vector<int> seams(places.size());
  std::map<int, std::vector<int>> firsts;  // by place
  for (size_t v = 0; v < places.size(); ++v) {
    std::vector<int>& here = firsts[places[v]];
    const auto agrees = [&](int first) { return own[static_cast<size_t>(first)].dot(own[v]) > 0.0; };
    const auto found = std::find_if(here.begin(), here.end(), agrees);
    seams[v] = found != here.end() ? *found : static_cast<int>(v);
    if (found == here.end()) here.push_back(static_cast<int>(v));
  }
  return seams;
}

}  // namespace

JointNormals::JointNormals(const std::vector<std::vector<Vec3>>& rest,
                           const std::vector<std::vector<Triangle>>& triangles) {
  int offset = 0;
  std::vector<Vec3> own;
  for (size_t m = 0; m < rest.size(); ++m) {
    for (const Triangle& t : triangles[m])
      triangles_.push_back({t[0] + offset, t[1] + offset, t[2] + offset});
    offset += static_cast<int>(rest[m].size());
    const std::vector<Vec3> normals = smooth_normals(rest[m], triangles[m], seams_of(rest[m]));
    own.insert(own.end(), normals.begin(), normals.end());
  }
  seams_ = seams_that_agree(seams_of(joined(rest)), own);
}

std::vector<std::vector<Vec3>> JointNormals::of(const std::vector<std::vector<Vec3>>& positions) const {
  const std::vector<Vec3> all = smooth_normals(joined(positions), triangles_, seams_);
  std::vector<std::vector<Vec3>> normals;
  auto at = all.begin();
  for (const std::vector<Vec3>& mesh : positions) {
    const auto end = at + static_cast<std::ptrdiff_t>(mesh.size());
    normals.emplace_back(at, end);
    at = end;
  }
  return normals;
}

std::vector<Vec3> JointNormals::joined(const std::vector<std::vector<Vec3>>& lists) const {
  std::vector<Vec3> all;
  for (const std::vector<Vec3>& list : lists)
    all.insert(all.end(), list.begin(), list.end());
  return all;
}

}  // namespace fascia::view
