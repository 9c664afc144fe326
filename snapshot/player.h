#pragma once

#include <fascia/fascia.h>

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "snapshot/snapshot.h"

namespace fascia::snapshot {

/// A rig's mesh as the runtime lists it.
struct PlayedMesh {
  uint32_t mesh = 0, primitive = 0;
  std::string part;
  std::vector<float> rest;  ///< 3 a vertex, metres
};

/// One face of a rig through the runtime's C interface, in the rig's metres.
class Player {
 public:
  /// `level`: low, medium or high; empty: the finest. Throws fascia::Error, beginning with `name`.
  Player(std::span<const uint8_t> rig, const std::string& name, const std::string& level);
  /// Another face of the same rig and level.
  Player sibling() const;

  const std::string& level() const { return level_name_; }
  const std::vector<PlayedMesh>& meshes() const { return *meshes_; }
  /// Poses of every channel alone at the end of its range, and of every shape of the rig's set `arkit`.
  std::vector<Pose> all_poses() const;

  /// The static pose of `values`, solved from rest, independent of earlier poses.
  void pose(const Values& values);
  /// The first frame of curves as a static pose, then frame by frame. False if the simulation was reset to
  /// rest.
  void begin(const fascia_curves* curves);
  bool step(const fascia_curves* curves, double time, double seconds);

  /// Positions of a mesh now: 3 a vertex, metres.
  std::span<const float> positions(size_t mesh) const;

 private:
  struct Release {
    void operator()(fascia_asset* asset) const { fascia_asset_release(asset); }
    void operator()(fascia_face* face) const { fascia_face_release(face); }
  };
  Player() = default;
  void create();

  std::string name_, level_name_;
  int32_t level_ = -1;
  std::shared_ptr<fascia_asset> asset_;
  std::unique_ptr<fascia_face, Release> face_;
  std::shared_ptr<const std::vector<PlayedMesh>> meshes_;
};

/// Curves of a file's bytes. Throws fascia::Error, beginning with `name`.
std::shared_ptr<fascia_curves> load_curves(std::span<const uint8_t> bytes, const std::string& name);

}  // namespace fascia::snapshot
