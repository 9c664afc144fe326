#include <algorithm>

#include "app/workspace.h"
#include "formats/scene.h"
#include "geometry/error.h"

namespace fascia::app {

namespace {

/// The vertices of a file that has the head's meshes, one list a part of the asset.
std::vector<std::vector<float>> positions_from(const std::string& file, const FaceAsset& asset,
                                               const Mat4& head_to_metres) {
  const formats::Scene scene = formats::read(file);
  std::vector<std::vector<float>> lists;
  std::vector<bool> is_used(scene.meshes.size(), false);
  for (const FacePart& part : asset.parts) {
    lists.emplace_back();
    for (size_t m = 0; m < scene.meshes.size(); ++m) {
      const formats::SceneMesh& mesh = scene.meshes[m];
      if (is_used[m] || mesh.positions.size() != part.vertex_count) continue;
      is_used[m] = true;
      for (const Vec3& p : mesh.positions) {
        const Vec3 metres = transform_point(head_to_metres, p + scene.offset);
        for (int k = 0; k < 3; ++k)
          lists.back().push_back(static_cast<float>(metres[k]));
      }
      break;
    }
  }
  if (std::all_of(lists.begin(), lists.end(), [](const auto& list) { return list.empty(); }))
    throw Error("'" + file +
                "': none of its meshes has as many vertices as one of the head's; compare with a file "
                "of the same meshes, or with it as another head");
  return lists;
}

}  // namespace

void Workspace::start_reference(const std::shared_ptr<const FaceAsset>& asset, fascia_solver solver) {
  coming_reference_.start(
      [asset, solver, pace = pace_] { return std::make_unique<Simulation>(asset, solver, pace); });
}

void Workspace::compare_with(Reference wanted, const std::string& file) {
  part_with(std::move(reference));
  reference_frame.reset();
  reference_positions.clear();
  coming_reference_.give_up();
  coming_positions_.give_up();
  if (other_build_) other_build_->cancel();
  if (other_build_) given_up_.push_back(std::move(other_build_));
  other_.reset();
  comparison.reference = rig ? wanted : Reference::none;
  comparison.file = file;
  ++changes_;
  if (!rig) return;
  try {
    if (wanted == Reference::file)
      coming_positions_.start([file, asset = rig->asset, to_metres = rig->head_to_metres] {
        return positions_from(file, *asset, to_metres);
      });
    if (wanted == Reference::other)
      other_build_ = std::make_unique<BuildTask>(
          BuildOrder{std::filesystem::absolute(file), session_.next_build(), "", "medium", false});
    if (wanted == Reference::before && !before_)
      throw Error("There is no rig from before: change a landmark or a muscle and build again");
    if (wanted == Reference::before) start_reference(before_->asset, FASCIA_SOLVER_OWN);
    if (wanted == Reference::bullet) start_reference(rig->asset, FASCIA_SOLVER_BULLET);
    if (wanted == Reference::converged) start_reference(rig->asset, FASCIA_SOLVER_REFERENCE);
  } catch (const std::exception& error) {
    notify(error.what(), Notice::Kind::error);
    comparison.reference = Reference::none;
  }
}

void Workspace::take_other() {
  if (!other_build_ || !other_build_->progress().is_done) return;
  const std::unique_ptr<BuildTask> done = std::move(other_build_);
  other_ = done->take_result();
  if (other_) return start_reference(other_->asset, FASCIA_SOLVER_OWN);
  comparison.reference = Reference::none;
  if (!done->fault().empty()) notify(done->fault(), Notice::Kind::error);
}

void Workspace::take_reference(bool waits) {
  std::erase_if(farewells_, [](const std::future<void>& farewell) {
    return farewell.wait_for(std::chrono::seconds(0)) == std::future_status::ready;
  });
  try {
    if (auto made = coming_reference_.take(waits)) {
      reference = std::move(*made);
      ++changes_;
    }
    if (auto positions = coming_positions_.take(waits)) {
      reference_positions = std::move(*positions);
      ++changes_;
    }
  } catch (const std::exception& error) {
    notify(error.what(), Notice::Kind::error);
    comparison.reference = Reference::none;
    ++changes_;
  }
}

/// What a file shows: its own vertices where it has them, the rest as the face is at rest.
std::shared_ptr<const FaceFrame> Workspace::frame_of_file() const {
  FaceFrame still = *rest_frame_;
  for (size_t part = 0; part < std::min(still.positions.size(), reference_positions.size()); ++part)
    if (reference_positions[part].size() == still.positions[part].size())
      still.positions[part] = reference_positions[part];
  return std::make_shared<const FaceFrame>(std::move(still));
}

void Workspace::renew_reference_frame() {
  if (reference)
    reference_frame = reference->frame();
  else if (comparison.reference == Reference::rest)
    reference_frame = rest_frame_;
  else if (comparison.reference != Reference::file || reference_positions.empty())
    reference_frame = nullptr;
  else if (!reference_frame)
    reference_frame = frame_of_file();
}

const LoadedRig* Workspace::reference_rig() const {
  if (comparison.reference == Reference::other) return other_ ? &*other_ : nullptr;
  if (comparison.reference == Reference::before) return before_ ? &*before_ : nullptr;
  return rig ? &*rig : nullptr;
}

bool Workspace::has_distances() const {
  if (!frame || !reference_frame || !comparison.has_heat) return false;
  const auto& a = frame->positions;
  const auto& b = reference_frame->positions;
  return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                    [](const auto& own, const auto& other) { return own.size() == other.size(); });
}

bool Workspace::is_divided() const {
  return reference_frame && (comparison.is_side_by_side || comparison.reference == Reference::other);
}

view::Camera Workspace::reference_camera() const {
  view::Camera camera = orbit.camera();
  if (const LoadedRig* other = reference_rig(); other && rig && comparison.reference == Reference::other)
    camera.target += face_box(*other->rig).centre() - face_box(*rig->rig).centre();
  return camera;
}

}  // namespace fascia::app
