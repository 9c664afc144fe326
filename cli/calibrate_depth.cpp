#include "cli/calibrate_depth.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "builder/prepare/prepare.h"
#include "builder/spatial/surface_query.h"
#include "cli/rig_build.h"
#include "formats/files.h"
#include "formats/scene.h"
#include "geometry/error.h"
#include "gltf/read/container.h"
#include "rig/write/write.h"

namespace fascia::cli {
namespace {

/// A file for as long as this lives.
class ScratchFile {
 public:
  ScratchFile(const std::string& format, const std::vector<uint8_t>& bytes) : name_("head." + format) {
    std::string pattern = (std::filesystem::temp_directory_path() / "fascia_XXXXXX").string();
    if (mkdtemp(pattern.data()) == nullptr)
      throw Error("'" + std::filesystem::temp_directory_path().string() +
                  "' takes no new folder: point TMPDIR to one that does");
    folder_ = pattern;
    formats::write_bytes(path(), bytes.data(), bytes.size());
  }
  ~ScratchFile() {
    std::error_code ignored;
    std::filesystem::remove_all(folder_, ignored);
  }
  ScratchFile(const ScratchFile&) = delete;
  ScratchFile& operator=(const ScratchFile&) = delete;

  std::filesystem::path path() const { return folder_ / name_; }

 private:
  std::string name_;
  std::filesystem::path folder_;
};

bool is_close(float a, float b) {
  return std::abs(a - b) <= 0.25F * std::max(std::abs(a), std::abs(b));
}

bool is_mimic(const anatomy::GenericAnatomy& anatomy, const std::string& name) {
  return std::any_of(anatomy.muscles.begin(), anatomy.muscles.end(), [&](const anatomy::Muscle& muscle) {
    return muscle.name == name && muscle.group == "mimic";
  });
}

}  // namespace

RebuiltRig::RebuiltRig(const std::vector<uint8_t>& bytes, const rig::RigFile& file)
    : bytes_(bytes), file_(file) {}

const rig::Rig* RebuiltRig::at(const fit::Physique& physique, const std::string& detail) {
  std::unique_ptr<rig::Rig>& kept = rigs_[{physique.depth, physique.breadth, detail}];
  if (kept) return kept.get();
  // If the rig cannot be rebuilt unchanged, it cannot be rebuilt with changes either.
  const bool has_any =
      std::any_of(rigs_.begin(), rigs_.end(), [](const auto& one) { return one.second != nullptr; });
  if (!fault_.empty() && !has_any) return nullptr;
  try {
    rig::Rig built = build(physique, detail);
    if (const std::string other = difference(built); !other.empty()) {
      fault_ = other;
      return nullptr;
    }
    built.actuation = file_.rig.actuation;
    built.input_to_metres = file_.rig.input_to_metres;
    kept = std::make_unique<rig::Rig>(std::move(built));
    return kept.get();
  } catch (const Error& error) {
    fault_ = error.what();
    return nullptr;
  }
}

rig::Rig RebuiltRig::build(const fit::Physique& physique, const std::string& detail) const {
  const rig::SourceRecord& record = file_.source;
  const bool is_made = !record.bytes.empty();  // of another format, which is kept
  rigging::BuildOptions options;
  options.detail = detail;
  options.tissue_scale = physique.depth;
  std::vector<uint8_t> glb;
  if (!is_made) {
    const rig::GltfSource source = rig::original(rig::glb_source(bytes_));
    glb = gltf::glb_bytes(source.json, source.bin);
    options.openings.open = "never";  // what was parted and added is in there
    options.openings.add = {"none"};
  }
  const ScratchFile head(is_made ? record.format : "glb", is_made ? record.bytes : glb);
  const formats::Scene scene = formats::read(head.path());
  const Mat4 to_file = file_.rig.input_to_metres.cast<double>().inverse();
  // Landmarks that were completed beyond the mesh, as on a neck that ends above them, are completed again.
  constexpr double on_skin = 0.008;  // metres
  const spatial::SurfaceQuery surface(prepare::joined_meshes(scene));
  const double reach = on_skin * to_file.topLeftCorner<3, 1>().norm();
  formats::LandmarkFile landmarks;
  for (const rig::Landmark& landmark : file_.rig.skull.landmarks) {
    const Vec3 place = transform_point(to_file, landmark.skin.cast<double>());
    if (surface.closest(place, reach).found()) landmarks.points[landmark.name] = place;
  }
  const anatomy::GenericAnatomy anatomy = anatomy_for({});
  const std::vector<size_t> third = fit::thirds_of_face(file_.rig);
  for (size_t m = 0; m < third.size(); ++m)
    if (const std::string& name = file_.rig.muscles[m].name; is_mimic(anatomy, name))
      options.edits.muscles[name].width = physique.breadth[third[m]];
  return rigging::build_rig(scene, landmarks, anatomy, options).rig;
}

/// Why a rig cannot take the place of the file's; empty when it can.
std::string RebuiltRig::difference(const rig::Rig& other) const {
  const rig::Rig& own = file_.rig;
  if (other.muscles.size() != own.muscles.size()) return "another build has other muscles";
  for (size_t m = 0; m < own.muscles.size(); ++m) {
    if (other.muscles[m].name != own.muscles[m].name) return "another build has other muscles";
    if (!is_close(other.muscles[m].strength, own.muscles[m].strength) ||
        !is_close(other.muscles[m].peak_shortening, own.muscles[m].peak_shortening))
      return "its " + own.muscles[m].name + " has been edited";
  }
  if (other.actuation.channels.size() != own.actuation.channels.size())
    return "another build has other channels";
  for (size_t c = 0; c < own.actuation.channels.size(); ++c)
    if (other.actuation.channels[c].name != own.actuation.channels[c].name)
      return "another build has other channels";
  const auto& before = own.tissue.bindings.front();
  const auto& after = other.tissue.bindings.front();
  if (after.size() != before.size()) return "another build binds other meshes";
  for (size_t b = 0; b < before.size(); ++b)
    if (after[b].mesh != before[b].mesh || after[b].primitive != before[b].primitive ||
        after[b].vertex_count != before[b].vertex_count ||
        (after[b].to_rig - before[b].to_rig).cwiseAbs().maxCoeff() > 1e-4F)
      return "another build finds the head elsewhere";
  return {};
}

}  // namespace fascia::cli
