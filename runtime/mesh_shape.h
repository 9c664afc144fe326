#pragma once

#include <memory>
#include <mutex>
#include <vector>

#include "fascia/fascia.h"
#include "rig/read/read.h"
#include "runtime/tangents.h"

namespace fascia::runtime {

/// One primitive of the file at rest in one space and what its vertices follow at one level of detail; shared
/// by all faces.
class MeshShape {
 public:
  /// `binding` may be null: nothing then moves the mesh. Both references must outlive this.
  MeshShape(const rig::Primitive& primitive, const rig::Binding* binding, const rig::Mat4f& input_to_metres,
            fascia_space space);

  /// What moves a vertex.
  struct Follower {
    uint32_t vertex = 0;
    uint32_t first = 0, end = 0;  ///< into `nodes` and `weights`
    float jaw_share = 0.0F;
    uint8_t eye = 0;  ///< 0 none, 1 left, 2 right
  };

  const rig::Primitive& primitive() const { return primitive_; }
  const std::vector<Vec3f>& rest() const {
    return rest_;
  }  ///< #vertices, in the space: the file's own, to the last bit
  const Vec3f& rest_metres(uint32_t vertex) const { return rest_metres_[vertex]; }
  const Eigen::Matrix3f& from_metres() const {
    return from_metres_;
  }  ///< displacement in metres to one in the space
  const std::vector<Follower>& followers() const { return followers_; }  ///< vertices that anything moves
  const std::vector<uint32_t>& nodes() const { return nodes_; }
  const std::vector<float>& weights() const { return weights_; }

  /// Normals at rest, made on first use; any thread may ask.
  struct Normals {
    std::vector<uint32_t> welded;      ///< #vertices: the first vertex at the same place
    std::vector<Vec3f> rest, surface;  ///< the file's own, or else the surface's; the surface's
  };
  const Normals& normals() const;

  /// Tangents, made on first use; any thread may ask.
  const Tangents& tangents() const;

  /// What moves each vertex, laid out for a vertex shader; made on first use, any thread may ask.
  struct Skinning {
    uint32_t influences = 0;      ///< a vertex: 4 or a multiple of it
    std::vector<uint32_t> nodes;  ///< #vertices * influences
    std::vector<float> weights;   ///< #vertices * influences; 0 where a vertex has fewer
    std::vector<float> jaw;       ///< #vertices, the jaw's share
    std::vector<uint32_t> eyes;   ///< #vertices: 0 none, 1 left, 2 right
  };
  const Skinning& skinning() const;

  /// From the rig's metres to the space and back, of places.
  const rig::Mat4f& metres_to_space() const { return metres_to_space_; }

  /// Unit normals of the surface at `positions`, #vertices each.
  void surface_normals(const std::vector<Vec3f>& positions, const std::vector<uint32_t>& welded,
                       std::vector<Vec3f>& normals) const;

 private:
  const rig::Primitive& primitive_;
  rig::Mat4f metres_to_space_;
  Eigen::Matrix3f from_metres_, direction_matrix_, normal_matrix_;
  std::vector<Vec3f> rest_metres_, rest_;
  std::vector<Follower> followers_;
  std::vector<uint32_t> nodes_;
  std::vector<float> weights_;
  mutable std::once_flag normals_once_;
  mutable Normals normals_;
  mutable std::once_flag tangents_once_, skinning_once_;
  mutable std::unique_ptr<const Tangents> tangents_;
  mutable Skinning skinning_;
};

}  // namespace fascia::runtime
