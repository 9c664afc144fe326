#include "tests/builder/posed_face.h"

#include "builder/rigging/gltf_source.h"
#include "formats/landmark_file.h"
#include "formats/scene.h"
#include "geometry/error.h"
#include "rig/write/write.h"

namespace fascia::testing {

PosedFace::PosedFace(const std::filesystem::path& head, const std::filesystem::path& landmarks,
                     const std::string& name, const std::string& detail) {
  const formats::Scene scene = formats::read(head);
  rigging::BuildOptions options;
  options.detail = detail;
  rigging::BuildResult built =
      rigging::build_rig(scene, formats::read_landmarks(landmarks), anatomy::load_generic(), options);
  const auto bytes = rig::write(rigging::gltf_source(scene, built.report.input_to_metres), built.rig);
  rig_path_ = std::filesystem::temp_directory_path() / ("fascia_" + name + ".glb");
  formats::write_bytes(rig_path_, bytes.data(), bytes.size());
  report_ = std::move(built.report);
  rig_ = std::move(built.rig);
  face_ = std::make_unique<cli::Face>(rig_path_, cli::Face::Options{FASCIA_SPACE_METRES, "own", ""});
  for (const rig::Landmark& landmark : rig_.skull.landmarks) {
    double nearest = 1e300;
    Handle& handle = handles_[landmark.name];
    for (size_t m = 0; m < face_->meshes().size(); ++m) {
      if (face_->meshes()[m].part != "skin") continue;
      const auto rest = face_->rest(m);
      for (size_t i = 0; i + 2 < rest.size(); i += 3) {
        const double gap = (Vec3(rest[i], rest[i + 1], rest[i + 2]) - landmark.skin.cast<double>()).norm();
        if (gap < nearest) {
          nearest = gap;
          handle = {m, i / 3};
        }
      }
    }
  }
}

PosedFace::~PosedFace() {
  std::error_code ignored;
  std::filesystem::remove(rig_path_, ignored);
}

void PosedFace::pose(const Values& values) {
  face_->clear();
  face_->reset();
  for (const auto& [name, value] : values)
    face_->set(name, value);
  face_->pose();
}

Vec3 PosedFace::at(const Handle& handle, bool rest) const {
  const auto flat = rest ? face_->rest(handle.mesh) : face_->positions(handle.mesh);
  return 1e3 * Vec3(flat[3 * handle.vertex], flat[3 * handle.vertex + 1], flat[3 * handle.vertex + 2]);
}

Vec3 PosedFace::place(const std::string& landmark) const {
  const auto handle = handles_.find(landmark);
  if (handle == handles_.end()) throw Error("the rig has no landmark '" + landmark + "'");
  return at(handle->second, false);
}

Vec3 PosedFace::moved(const std::string& landmark) const {
  return place(landmark) - at(handles_.at(landmark), true);
}

double PosedFace::largest_motion() const {
  double largest = 0.0;
  for (size_t m = 0; m < face_->meshes().size(); ++m) {
    const auto now = face_->positions(m), rest = face_->rest(m);
    for (size_t i = 0; i < now.size(); ++i)
      largest = std::max(largest, 1e3 * std::abs(static_cast<double>(now[i] - rest[i])));
  }
  return largest;
}

double PosedFace::largest_skin_motion_right_of(double x_mm) const {
  double largest = 0.0;
  for (size_t m = 0; m < face_->meshes().size(); ++m) {
    if (face_->meshes()[m].part != "skin") continue;
    const auto now = face_->positions(m), rest = face_->rest(m);
    for (size_t i = 0; i + 2 < now.size(); i += 3)
      if (1e3 * rest[i] < x_mm)
        largest =
            std::max(largest, 1e3 * static_cast<double>(std::hypot(now[i] - rest[i], now[i + 1] - rest[i + 1],
                                                                   now[i + 2] - rest[i + 2])));
  }
  return largest;
}

}  // namespace fascia::testing
