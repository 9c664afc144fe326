#include "cli/motion.h"

#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <mutex>

#include "cli/progress.h"

namespace fascia::cli {

namespace {

using Motions = std::vector<PrimitiveMotion>;

/// Takes what `less` moves off `from`.
void subtract(Motions& from, const Motions& less) {
  for (const PrimitiveMotion& part : less) {
    const auto same = [&](const PrimitiveMotion& motion) {
      return motion.mesh == part.mesh && motion.primitive == part.primitive;
    };
    auto found = std::find_if(from.begin(), from.end(), same);
    if (found == from.end()) {
      from.push_back({part.mesh, part.primitive, {}});
      from.back().displacement.assign(part.displacement.size(), rig::Vec3f::Zero());
      found = from.end() - 1;
    }
    for (size_t v = 0; v < part.displacement.size(); ++v)
      found->displacement[v] -= part.displacement[v];
  }
}

}  // namespace

std::vector<PrimitiveMotion> motion_from_rest(const Face& face) {
  std::vector<PrimitiveMotion> motions;
  for (size_t m = 0; m < face.meshes().size(); ++m) {
    const std::span<const float> now = face.positions(m), rest = face.rest(m);
    PrimitiveMotion motion{face.meshes()[m].mesh, face.meshes()[m].primitive, {}};
    bool moves = false;
    for (size_t i = 0; i + 2 < now.size(); i += 3) {
      motion.displacement.emplace_back(now[i] - rest[i], now[i + 1] - rest[i + 1], now[i + 2] - rest[i + 2]);
      moves |= !motion.displacement.back().isZero(0);
    }
    if (moves) motions.push_back(std::move(motion));
  }
  return motions;
}

void pose_shape(Face& face, const ShapeToBake& shape) {
  face.clear();
  face.reset();
  for (const std::string& name : shape.sets)
    face.set(name, 1.0);
  face.pose();
}

BakedShapes bake_shapes(const Common& common, const Face& face, const std::vector<ShapeToBake>& shapes) {
  BakedShapes baked;
  baked.shapes.resize(shapes.size());
  for (const ShapeToBake& shape : shapes)
    baked.names.push_back(shape.name);
  Progress progress(common, "bake", shapes.size());
  std::mutex progress_mutex;
  tbb::enumerable_thread_specific<Face> faces([&] { return face.sibling(); });
  tbb::parallel_for(size_t{0}, shapes.size(), [&](size_t s) {
    Face& own = faces.local();
    pose_shape(own, shapes[s]);
    baked.shapes[s] = motion_from_rest(own);
    const std::lock_guard lock(progress_mutex);
    progress.step();
  });
  for (size_t s = shapes.size(); s-- > 0;)
    for (const size_t part : shapes[s].corrects)
      subtract(baked.shapes[s], baked.shapes[part]);
  return baked;
}

}  // namespace fascia::cli
