// Lids of heads that differ from the generic one in one respect.
#include <gtest/gtest.h>

#include "anatomy/anatomy.h"
#include "formats/files.h"
#include "formats/write.h"
#include "tests/builder/posed_face.h"

namespace fascia::testing {
namespace {

namespace fs = std::filesystem;

fs::path drawn(const std::string& name, const formats::Drawing& drawing) {
  const fs::path path = fs::temp_directory_path() / std::string("fascia_head_").append(name).append(".glb");
  formats::write(path, drawing);
  return path;
}

/// The embedded head with each of its surfaces changed by `change`.
template <class Change>
formats::Drawing embedded(const Change& change) {
  formats::Drawing drawing;
  for (const anatomy::MeshObject& object : anatomy::load_generic().head) {
    formats::NamedSurface surface{object.name, object.mesh};
    change(surface);
    if (!surface.mesh.triangles.empty()) drawing.surfaces.push_back(std::move(surface));
  }
  return drawing;
}

/// The tip of the nose and no more: all else is found.
fs::path one_landmark() {
  const Vec3 tip = 1e3 * *anatomy::load_generic().landmark("pronasale")->skin;
  const std::string text = R"({"units": "mm", "landmarks": {"pronasale": [)" + std::to_string(tip.x()) +
                           ", " + std::to_string(tip.y()) + ", " + std::to_string(tip.z()) + "]}}";
  const fs::path path = fs::temp_directory_path() / "fascia_pronasale.json";
  formats::write_bytes(path, text.data(), text.size());
  return path;
}

TEST(Lids, PassClearOfAnEyeballWithoutACornea) {
  // Every eyeball a plain ball: lids keep clear of its front as of a cornea, on both sides.
  const auto head = embedded([](formats::NamedSurface& surface) {
    if (surface.name != "eye_left" && surface.name != "eye_right") return;
    const Vec3 centre = bounds(surface.mesh.vertices).centre();
    for (Vec3& p : surface.mesh.vertices)
      p = centre + 0.0125 * (p - centre).normalized();
  });
  PosedFace face(drawn("balls", head), one_landmark(), "balls", "low");
  const rig::TissueLevel& level = face.rig().tissue.levels.at(0);
  ASSERT_GT(level.globe_centre.size(), 2U);
  for (const bool left : {true, false}) {
    const rig::Eye& eye = left ? face.rig().skull.eye_left : face.rig().skull.eye_right;
    float before = 0.0F;
    for (size_t g = 0; g < level.globe_centre.size(); ++g)
      if ((level.globe_centre[g] - eye.centre).norm() < eye.radius)
        before = std::max(before, (level.globe_centre[g] - eye.centre).norm() + level.globe_radius[g]);
    EXPECT_GT(before, eye.radius + 0.0005F);  // the clearance of cornea and chords
  }
}

}  // namespace
}  // namespace fascia::testing
