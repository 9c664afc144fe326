#include "cli/motion.h"

#include <tbb/concurrent_queue.h>
#include <tbb/global_control.h>
#include <tbb/parallel_pipeline.h>

#include <algorithm>
#include <memory>

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

void for_each_shape(const Common& common, const Face& face, const std::vector<ShapeToBake>& shapes,
                    const std::function<void(size_t shape, const Face& posed)>& visit) {
  struct Posed {
    size_t shape = 0;
    std::shared_ptr<Face> face;
  };
  Progress progress(common, "bake", shapes.size());
  tbb::concurrent_queue<std::shared_ptr<Face>> idle;
  size_t next = 0;
  const auto take = [&](tbb::flow_control& flow) {
    if (next == shapes.size()) {
      flow.stop();
      return Posed();
    }
    Posed posed{next++, nullptr};
    if (!idle.try_pop(posed.face)) posed.face = std::make_shared<Face>(face.sibling());
    return posed;
  };
  const auto pose = [&](Posed posed) {
    pose_shape(*posed.face, shapes[posed.shape]);
    return posed;
  };
  const auto show = [&](const Posed& posed) {
    visit(posed.shape, *posed.face);
    progress.step();
    idle.push(posed.face);
  };
  // Shapes take unequal times: twice as many are under way as threads can work on.
  const size_t most = 2 * tbb::global_control::active_value(tbb::global_control::max_allowed_parallelism);
  tbb::parallel_pipeline(most, tbb::make_filter<void, Posed>(tbb::filter_mode::serial_in_order, take) &
                                   tbb::make_filter<Posed, Posed>(tbb::filter_mode::parallel, pose) &
                                   tbb::make_filter<Posed, void>(tbb::filter_mode::serial_in_order, show));
}

BakedShapes bake_shapes(const Common& common, const Face& face, const std::vector<ShapeToBake>& shapes) {
  BakedShapes baked;
  baked.shapes.resize(shapes.size());
  for (const ShapeToBake& shape : shapes)
    baked.names.push_back(shape.name);
  for_each_shape(common, face, shapes,
                 [&](size_t s, const Face& posed) { baked.shapes[s] = motion_from_rest(posed); });
  for (size_t s = shapes.size(); s-- > 0;)
    for (const size_t part : shapes[s].corrects)
      subtract(baked.shapes[s], baked.shapes[part]);
  return baked;
}

}  // namespace fascia::cli
