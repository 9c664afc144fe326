// The embedded head under many drives: nothing passes through anything, and closed eyes are closed.
#include <gtest/gtest.h>

#include "builder/rigging/build_rig.h"
#include "builder/rigging/gltf_source.h"
#include "builder/spatial/surface_query.h"
#include "cli/demo_curves.h"
#include "formats/landmark_file.h"
#include "formats/scene.h"
#include "rig/write/write.h"
#include "tests/builder/swept_face.h"

namespace fascia::testing {
namespace {

namespace fs = std::filesystem;

std::shared_ptr<const runtime::Asset> embedded_head() {
  static const std::shared_ptr<const runtime::Asset> asset = [] {
    const fs::path folder = fs::temp_directory_path() / "fascia_sweep";
    fs::create_directories(folder);
    cli::write_embedded_head(folder / "head.obj", folder / "landmarks.json");
    const formats::Scene scene = formats::read(folder / "head.obj");
    rigging::BuildResult built = rigging::build_rig(scene, formats::read_landmarks(folder / "landmarks.json"), anatomy::load_generic());
    fs::remove_all(folder);
    return std::make_shared<const runtime::Asset>(rig::write(rigging::gltf_source(scene, built.report.input_to_metres), built.rig));
  }();
  return asset;
}

/// How many lines of sight from the front reach an eyeball.
int seen_of_the_eye(const SweptFace& face, const rig::Eye& eye) {
  const spatial::SurfaceQuery skin(face.skin());
  const Vec3 centre = eye.centre.cast<double>();
  const double radius = eye.radius;
  int seen = 0;
  for (int i = -5; i <= 5; ++i)
    for (int k = -9; k <= 9; ++k) {
      const Vec3 aside(0.09 * radius * i, 0.08 * radius * k, 0.0);
      const Vec3 on_globe = centre + aside + Vec3(0, 0, std::sqrt(radius * radius - aside.squaredNorm()));
      if (!skin.blocked(on_globe + Vec3(0, 0, 0.05), Vec3(0, 0, -1), 0.05)) ++seen;
    }
  return seen;
}

void show(SweptFace& face, const std::vector<std::string>& names) {
  face.relax();
  for (const std::string& name : names) face.add(name, 1.0F);
  face.pose();
}

TEST(Lids, AFullBlinkShutsTheEyesAndGoesNoFarther) {
  for (size_t level = 0; level < 2; ++level) {
    SweptFace face(embedded_head(), level);
    const rig::Skull& skull = face.asset().rig().skull;
    face.pose();
    EXPECT_GT(seen_of_the_eye(face, skull.eye_left), 60);
    // The blink of the table, and lids driven together by all that closes them.
    for (const std::vector<std::string>& names :
         {std::vector<std::string>{"arkit:eyeBlinkLeft", "arkit:eyeBlinkRight"},
          {"lid_upper_left", "lid_lower_left", "orbicularis_oculi_pretarsal_upper_left", "lid_upper_right", "lid_lower_right", "orbicularis_oculi_pretarsal_upper_right"}}) {
      show(face, names);
      EXPECT_LE(seen_of_the_eye(face, skull.eye_left), 3) << names[0];  // beside the caruncle
      EXPECT_LE(seen_of_the_eye(face, skull.eye_right), 3) << names[0];
      const SweptFace::State state = face.state(5e-4);
      for (const size_t eye : {1, 2}) {
        // Edges may overlap by 0.3 mm, and the contact is a penalty: driven together they lap over by a millimetre.
        EXPECT_LT(state.lattice[eye].depth, names.size() == 2 ? 7e-4 : 1.3e-3) << names[0];
        EXPECT_LT(state.rendered[eye].depth, names.size() == 2 ? 1e-3 : 1.3e-3) << names[0];
      }
    }
  }
}

}  // namespace
}  // namespace fascia::testing
