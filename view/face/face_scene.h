#pragma once

#include <map>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "rig/model/rig.h"
#include "view/face/appearance.h"
#include "view/face/heat_map.h"
#include "view/face/joint_normals.h"
#include "view/face/lattice_layers.h"
#include "view/face/moving_anatomy.h"
#include "view/scene.h"

namespace fascia::view {

/// One primitive of a rig's file, as the runtime lists it.
struct FacePart {
  uint32_t mesh = 0, primitive = 0;
  std::string part;  ///< skin, eye_left, teeth_upper, lashes, ... as the rig names it
  std::vector<Triangle> triangles;
  std::vector<Vec3> rest;  ///< m
  std::vector<Vec3>
      colours;  ///< sRGB, one a vertex, where the file gives the part no look of its own; or none
};

using Fibres = std::vector<std::pair<std::string, std::vector<std::vector<Vec3>>>>;

/// A face as it stands.
struct FaceState {
  std::vector<std::span<const float>> positions;  ///< of each part, x y z, m
  Mat4 jaw = Mat4::Identity();                    ///< of the mandible
  Fibres fibres;                                  ///< by muscle; only for the layer `muscles`
  std::map<std::string, double> activations;      ///< 0..1 by muscle: those that pull glow; may be empty
  Lattice lattice;                                ///< only for the layers `fat`, `lattice` and `smas`
};

/// What to show of a face.
struct FaceView {
  std::set<std::string> layers = {"skin", "eyes"};  ///< of FaceScene::layer_names()
  std::vector<std::string> muscles;                 ///< these alone, names with sides; none: all
  bool tells_muscles_apart = false;                 ///< a colour a muscle in place of flesh
  bool has_textures = true;                         ///< else plain colours
  /// Half space whose skin is left out, and whose deeper layers alone are shown: (n, d) for n.p > d.
  std::optional<Eigen::Vector4d> reveal;
  HeatScale scale = {"areal strain, %", -30.0, 30.0, true};
};

/// Turns the face of one rig, pose after pose, into things to draw.
class FaceScene {
 public:
  FaceScene(const rig::Rig& rig, std::vector<FacePart> parts, Appearance appearance);

  /// skin, eyes, teeth, skull, fat, smas, muscles, ligaments, lattice, landmarks, strain.
  static const std::set<std::string>& layer_names();

  /// `state` must fit the parts. With deeper layers the skin is glass, unless `reveal` cuts it.
  DrawList list(const FaceState& state, const FaceView& view) const;

  const Appearance& appearance() const { return appearance_; }

 private:
  std::vector<std::vector<Vec3>> skin_normals(const std::vector<std::vector<Vec3>>& positions) const;
  void add_parts(const FaceState& state, const FaceView& view, DrawList& list) const;
  void add_bones(const FaceState& state, const FaceView& view, DrawList& list) const;
  void add_muscles(const FaceState& state, const FaceView& view, DrawList& list) const;
  void add_landmarks(const FaceState& state, DrawList& list) const;

  const rig::Rig* rig_;
  std::vector<FacePart> parts_;
  Appearance appearance_;
  std::vector<std::shared_ptr<const std::vector<int>>> seams_;
  std::vector<std::vector<Vec3>> eye_coordinates_;
  std::vector<bool> has_strands_;  ///< one per part: hairs rather than cards
  std::vector<size_t> skin_parts_;
  std::optional<JointNormals> skin_normals_;  ///< of `skin_parts_`
  std::optional<MovingAnatomy> moving_;
};

/// The retaining ligaments, as bands from bone to skin.
void add_ligaments(const std::vector<MovingAnatomy::Band>& ligaments, DrawList& list);

/// A colour of its own for each muscle, the same for both sides; sRGB.
Vec3 muscle_colour(const std::string& name);

}  // namespace fascia::view
