#pragma once

#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "app/engine/face_session.h"
#include "app/engine/live_skull.h"
#include "app/model/settings.h"
#include "rig/model/rig.h"
#include "view/face/face_scene.h"
#include "view/face/moving_anatomy.h"
#include "view/scene.h"

namespace fascia::app {

/// What the picture shows besides the face itself.
struct SceneOptions {
  Layers layers;
  bool has_round_fibres = false;  ///< muscles as flesh, for pictures that may take their time; else lines
  std::string selected_muscle;    ///< drawn bright; empty: none
  std::set<std::string> hidden_muscles;  ///< by the name of the muscle
  /// Distances to colour the skin by, metres, one list a part; empty: as skin.
  const std::vector<std::vector<float>>* distances = nullptr;
  double scale = 0.005;                     ///< metres at the hot end
  const SkullShift* skull_shift = nullptr;  ///< of the bones from where the rig has them; null: none
};

/// Colour of a share from 0 to 1 of the heat map, sRGB: the figures of matplotlib's "inferno", lightened at
/// its dark end.
Vec3 heat_colour(double share);

/// The colour of a muscle that contracts by `activation`, 0..1.
Vec3 muscle_colour(double activation);

/// What does not change while a rig is shown: colours of the eyes, skin without transparent cards.
class SceneStore {
 public:
  /// `appearance`, where given, must be that of the asset's file; both and the rig must outlive the store.
  SceneStore(const FaceAsset& asset, const rig::Rig& rig, const view::Appearance* appearance);

  /// The face as it stands in `frame`, ready to be drawn.
  view::DrawList list(const FaceFrame& frame, const SceneOptions& options) const;

 private:
  struct ContractingMuscle {
    std::vector<std::vector<Vec3>> fibres;
    double activation = 0.0;
  };
  bool is_painted(const SceneOptions& options) const;
  void add_painted(view::DrawList& list, const FaceFrame& frame) const;
  void add_skin(view::DrawList& list, const FaceFrame& frame, const SceneOptions& options) const;
  void add_part(view::DrawList& list, size_t part, const FaceFrame& frame) const;
  std::map<std::string, ContractingMuscle> muscles_of(const FaceFrame& frame,
                                                      const SceneOptions& options) const;

  void add_fibre_lines(view::DrawList& list, const FaceFrame& frame, const SceneOptions& options) const;
  void add_flesh(view::DrawList& list, const FaceFrame& frame, const SceneOptions& options) const;
  void add_lattice(view::DrawList& list, const FaceFrame& frame, const Layers& layers) const;
  void add_bones(view::DrawList& list, const FaceFrame& frame, const SkullShift* shift) const;
  void add_sheets(view::DrawList& list, const FaceFrame& frame, const Layers& layers) const;

  const FaceAsset& asset_;
  std::optional<view::FaceScene> painted_;          ///< where the file gives any part a look of its own
  std::vector<std::vector<Vec3>> eye_coordinates_;  ///< one list a part
  /// The parts that are skin as one surface: groups of a file share their borders' normals.
  std::vector<size_t> skin_parts_;
  std::vector<Triangle> skin_triangles_;
  std::shared_ptr<const std::vector<int>> skin_seams_;
  std::optional<view::MovingAnatomy> moving_;
};

/// Distance of every vertex of `frame` from `reference`, metres, one list a part; of parts whose counts
/// differ, none.
std::vector<std::vector<float>> distances_between(const FaceFrame& frame,
                                                  const std::vector<std::vector<float>>& reference);

}  // namespace fascia::app
