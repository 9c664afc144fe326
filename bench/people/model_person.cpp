#include "bench/people/model_person.h"

#include <algorithm>
#include <random>

#include "bench/people/npz.h"
#include "tests/paths/paths.h"

namespace fascia::bench {

namespace {

/// The model's parts by their first vertices.
struct ModelPart {
  const char* name;
  int first;
};
constexpr ModelPart model_parts[] = {{"head", 0},     {"gums_tongue", 14062}, {"teeth", 17039},
                                     {"eyes", 21451}, {"lids", 24591},        {"lashes", 25351},
                                     {"end", 1 << 30}};

/// Those of `triangles` that `keeps` asks for, with their own vertices in the order of `vertices`.
template <class Keeps>
formats::SceneMesh part_mesh(const char* name, const std::vector<Vec3>& vertices,
                             const std::vector<Triangle>& triangles, Keeps keeps) {
  formats::SceneMesh mesh;
  mesh.name = name;
  std::vector<int> place(vertices.size(), -1);
  for (size_t v = 0; v < vertices.size(); ++v)
    if (keeps(static_cast<int>(v))) {
      place[v] = static_cast<int>(mesh.positions.size());
      mesh.positions.push_back(vertices[v]);
    }
  for (const Triangle& t : triangles)
    if (keeps(t[0]))
      mesh.triangles.push_back({place[static_cast<size_t>(t[0])], place[static_cast<size_t>(t[1])],
                                place[static_cast<size_t>(t[2])]});
  return mesh;
}

}  // namespace

FaceModel::FaceModel() {
  const std::filesystem::path file = test::measured_data() / "data/ict/ict_model.npz";
  const std::vector<double> base = read_npz(file, "base").numbers(), tri = read_npz(file, "tri").numbers();
  for (size_t i = 0; i + 2 < base.size(); i += 3)
    base_.push_back(0.01 * Vec3(base[i], base[i + 1], base[i + 2]));
  for (size_t i = 0; i + 2 < tri.size(); i += 3)
    triangles_.push_back(
        {static_cast<int>(tri[i]), static_cast<int>(tri[i + 1]), static_cast<int>(tri[i + 2])});
  modes_ = read_npz(file, "ids").numbers();
  scales_ = read_npz(file, "si").numbers();
}

std::vector<Vec3> FaceModel::vertices(uint32_t seed) const {
  std::vector<Vec3> all = base_;
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  for (size_t mode = 0; mode < scales_.size() && seed > 0; ++mode) {
    const double weight = 0.01 * scales_[mode] * std::clamp(normal(random), -2.2, 2.2);
    const double* shape = modes_.data() + 3 * all.size() * mode;
    for (size_t v = 0; v < all.size(); ++v)
      all[v] += weight * Vec3(shape[3 * v], shape[3 * v + 1], shape[3 * v + 2]);
  }
  return all;
}

formats::Scene FaceModel::scene(uint32_t seed) const {
  const std::vector<Vec3> all = vertices(seed);
  formats::Scene scene;
  scene.kind = formats::FileKind::obj;
  scene.path = "person_" + std::to_string(seed) + ".obj";
  for (size_t part = 0; part + 1 < std::size(model_parts); ++part) {
    const int first = model_parts[part].first, end = model_parts[part + 1].first;
    const auto is_here = [&](int v) { return v >= first && v < end; };
    if (std::string(model_parts[part].name) != "eyes") {
      scene.meshes.push_back(part_mesh(model_parts[part].name, all, triangles_, is_here));
      continue;
    }
    // Base, not person: which side an eyeball's vertex is on is a matter of the model.
    for (const bool is_left : {true, false})
      scene.meshes.push_back(part_mesh(is_left ? "eye_left" : "eye_right", all, triangles_, [&](int v) {
        return is_here(v) && (base_[static_cast<size_t>(v)][0] > 0.0) == is_left;
      }));
  }
  return scene;
}

}  // namespace fascia::bench
