// Faces fitted to surfaces of another topology and to landmarks alone, on the embedded head at low detail.
#include "fit/scan/scan.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <fstream>
#include <nlohmann/json.hpp>
#include <random>

#include "formats/scene.h"
#include "geometry/error.h"
#include "tests/fit/embedded_subject.h"

namespace fascia::fit {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

class FitScan : public EmbeddedSubject {
 protected:
  static Eigen::VectorXd displacements(const std::vector<float>& values) {
    subject->pose(values, false);
    return subject->displacements(values);
  }

  static bool is_skin(size_t vertex) {
    for (const rig::Binding& binding : subject->file().rig.tissue.bindings.front()) {
      const size_t p = subject->file().primitive_of(binding);
      const size_t first = subject->first_vertex(p);
      if (binding.part == "skin" && vertex >= first &&
          vertex < first + subject->file().primitives[p].positions.size())
        return true;
    }
    return false;
  }

  /// The posed skin with a new vertex in the middle of every triangle, and the old ones in another order.
  static TriangleMesh scan(const Eigen::VectorXd& moved, double noise = 0.0) {
    TriangleMesh mesh;
    std::mt19937 random(3);
    std::normal_distribution<double> off(0.0, noise / std::sqrt(3.0));
    const size_t count = subject->vertex_count();
    for (size_t i = 0; i < count; ++i) {
      const auto at = static_cast<Eigen::Index>(3 * (count - 1 - i));
      mesh.vertices.push_back(subject->rest().segment<3>(at) + moved.segment<3>(at));
    }
    for (const rig::Binding& binding : subject->file().rig.tissue.bindings.front()) {
      if (binding.part != "skin") continue;
      const size_t p = subject->file().primitive_of(binding);
      for (const auto& t : subject->file().primitives[p].triangles) {
        std::array<int, 3> corner{};
        for (size_t k = 0; k < 3; ++k)
          corner[k] = static_cast<int>(count - 1 - subject->first_vertex(p) - t[k]);
        const int middle = mesh.vertex_count();
        mesh.vertices.push_back((mesh.vertices[static_cast<size_t>(corner[0])] +
                                 mesh.vertices[static_cast<size_t>(corner[1])] +
                                 mesh.vertices[static_cast<size_t>(corner[2])]) /
                                3.0);
        for (size_t k = 0; k < 3; ++k)
          mesh.triangles.push_back({corner[k], corner[(k + 1) % 3], middle});
      }
    }
    if (noise > 0.0)
      for (Vec3& p : mesh.vertices)
        p += Vec3(off(random), off(random), off(random));
    return mesh;
  }

  /// Share of the skin's true motion that `found` explains.
  static double share(const Eigen::VectorXd& truth, const Eigen::VectorXd& found) {
    double left = 0.0, whole = 0.0;
    for (size_t v = 0; v < subject->vertex_count(); ++v) {
      if (!is_skin(v)) continue;
      const auto at = static_cast<Eigen::Index>(3 * v);
      left += (truth - found).segment<3>(at).squaredNorm();
      whole += truth.segment<3>(at).squaredNorm();
    }
    return 1.0 - left / whole;
  }

  static std::map<std::string, float> smile_with_open_mouth() {
    return {{"zygomaticus_major_superior_left", 0.7F},
            {"zygomaticus_major_inferior_left", 0.7F},
            {"jaw_open", 0.3F},
            {"frontalis_medial_left", 0.5F},
            {"frontalis_medial_right", 0.5F}};
  }
};

TEST_F(FitScan, FindsTheMotionBehindAnotherTopology) {
  const Eigen::VectorXd truth = displacements(values_of(smile_with_open_mouth()));
  const ScanFit found = fit_scan(*subject, scan(truth));
  EXPECT_GT(share(truth, found.result.displacements), 0.98);
  EXPECT_LT(found.result.rms_mm, 0.1);
  EXPECT_GT(found.matched_share, 0.9);
}

/// Cheeks and lips slide over the scan without changing their distance to it.
TEST_F(FitScan, SkinSlidesOverTheScan) {
  for (const char* member : {"mouthLeft", "mouthSmileLeft", "cheekPuff"}) {
    std::vector<float> values = values_of({});
    for (const rig::NamedSet& set : subject->file().rig.actuation.sets) {
      if (set.name != "arkit") continue;
      for (size_t e = 0; e < set.weights.size(); ++e)
        if (set.members[set.member_indices[e]] == member)
          values[set.channel_indices[e]] += 0.8F * set.weights[e];
    }
    const Eigen::VectorXd truth = displacements(values);
    EXPECT_GT(share(truth, fit_scan(*subject, scan(truth)).result.displacements), 0.97) << member;
  }
}

TEST_F(FitScan, BringsTheScanOntoTheHead) {
  const Eigen::VectorXd truth = displacements(values_of(smile_with_open_mouth()));
  TriangleMesh moved = scan(truth, 0.0005);
  const Eigen::Isometry3d motion =
      Eigen::Translation3d(0.004, -0.006, 0.005) * Eigen::AngleAxisd(0.08, Vec3(0.3, 1.0, 0.2).normalized());
  for (Vec3& p : moved.vertices)
    p = motion * p;
  const ScanFit found = fit_scan(*subject, moved);
  EXPECT_GT(share(truth, found.result.displacements), 0.9)
      << "half a millimetre of noise, and the head turned";
  const Vec3 chin(0.0, -0.08, 0.08);
  EXPECT_LT((transform_point(found.scan_to_head, motion * chin) - chin).norm(), 0.0015);
}

TEST_F(FitScan, RestIsFoundWhenTheMouthIsHidden) {
  TriangleMesh mesh = scan(Eigen::VectorXd::Zero(subject->rest().size()));
  Vec3 mouth = Vec3::Zero();
  for (const rig::Landmark& landmark : subject->file().rig.skull.landmarks)
    if (landmark.name == "stomion") mouth = landmark.skin.cast<double>();
  std::erase_if(mesh.triangles, [&](const Triangle& t) {
    return (mesh.vertices[static_cast<size_t>(t[0])] - mouth).norm() < 0.03;
  });
  const ScanFit found = fit_scan(*subject, mesh);
  for (size_t v = 0; v < subject->vertex_count(); ++v) {
    if (is_skin(v)) {
      EXPECT_LT(found.result.displacements.segment<3>(static_cast<Eigen::Index>(3 * v)).norm(), 0.001);
    }
  }
}

TEST_F(FitScan, RejectsAScanAwayFromTheHead) {
  TriangleMesh far = scan(Eigen::VectorXd::Zero(subject->rest().size()));
  for (Vec3& p : far.vertices)
    p += Vec3(1.0, 0.0, 0.0);
  EXPECT_THROW(fit_scan(*subject, far), Error);
}

TEST_F(FitScan, LandmarksAloneDriveTheFit) {
  const std::vector<float> values = values_of(smile_with_open_mouth());
  const Eigen::VectorXd truth = displacements(values);
  json rest, posed;
  for (const rig::Landmark& landmark : subject->file().rig.skull.landmarks) {
    size_t nearest = 0;
    double least = 1e9;
    const Vec3 skin = landmark.skin.cast<double>();
    for (size_t v = 0; v < subject->vertex_count(); ++v)
      if (const double d = (subject->rest().segment<3>(static_cast<Eigen::Index>(3 * v)) - skin).norm();
          is_skin(v) && d < least) {
        least = d;
        nearest = v;
      }
    const auto at = static_cast<Eigen::Index>(3 * nearest);
    const Mat4 back = subject->file().rig.input_to_metres.cast<double>().inverse();
    const Vec3 a = transform_point(back, subject->rest().segment<3>(at)),
               b = transform_point(back, subject->rest().segment<3>(at) + truth.segment<3>(at));
    rest["landmarks"][landmark.name] = {a[0], a[1], a[2]};
    posed["landmarks"][landmark.name] = {b[0], b[1], b[2]};
  }
  formats::write_text(at("rest.json"), rest.dump());
  formats::write_text(at("posed.json"), posed.dump());
  const cli::Outcome fitted = run("fit " + at("rig.glb") + " --target " + at("posed.json") + " --neutral " +
                                  at("rest.json") + " -o " + at("found.json") + " --json");
  ASSERT_EQ(fitted.code, 0) << fitted.err;
  const auto found = json::parse(fitted.out)["activations"].get<std::map<std::string, float>>();
  EXPECT_GT(share(truth, displacements(values_of(found))), 0.93);
  const cli::Outcome refused =
      run("fit " + at("rig.glb") + " --target " + at("found.json") + " -o " + at("x.json"));
  EXPECT_EQ(refused.code, 1) << "activations are no landmarks";
}

TEST_F(FitScan, TheToolTakesAScanInAnyPoseAndUnit) {
  const Eigen::VectorXd truth = displacements(values_of(smile_with_open_mouth()));
  const TriangleMesh mesh = scan(truth);
  const Mat3 turn = Eigen::AngleAxisd(0.5, Vec3(0.1, 1.0, 0.1).normalized()).toRotationMatrix();
  std::ofstream file(at("scan.obj"));
  for (const Vec3& p : mesh.vertices) {
    const Vec3 q = 100.0 * (turn * p) + Vec3(30.0, 10.0, -20.0);  // centimetres
    file << "v " << q[0] << ' ' << q[1] << ' ' << q[2] << '\n';
  }
  for (const Triangle& t : mesh.triangles)
    file << "f " << t[0] + 1 << ' ' << t[1] + 1 << ' ' << t[2] + 1 << '\n';
  file.close();
  const cli::Outcome fitted =
      run("fit " + at("rig.glb") + " --target " + at("scan.obj") + " -o " + at("scan.json") + " --json");
  ASSERT_EQ(fitted.code, 0) << fitted.err;
  const auto found = json::parse(fitted.out)["activations"].get<std::map<std::string, float>>();
  EXPECT_GT(share(truth, displacements(values_of(found))), 0.9);
}

/// In STL no triangle shares a corner with another.
TEST_F(FitScan, AnStlScanIsFitted) {
  ASSERT_EQ(run("pose " + at("rig.glb") + " --set jaw_open=0.3 --level low -o " + at("open.glb")).code, 0);
  const formats::Scene posed = formats::read(at("open.glb"));
  std::ofstream stl(at("open.stl"));
  stl << "solid open\n";
  for (const formats::SceneMesh& mesh : posed.meshes)
    for (const Triangle& t : mesh.triangles) {
      stl << "facet normal 0 0 0\nouter loop\n";
      for (const int v : t)
        stl << "vertex " << mesh.positions[static_cast<size_t>(v)].transpose() << "\n";
      stl << "endloop\nendfacet\n";
    }
  stl << "endsolid open\n";
  stl.close();
  const cli::Outcome fitted = run("fit " + at("rig.glb") + " --target " + at("open.stl") +
                                  " --as scan --level low -o " + at("stl.json") + " --json");
  ASSERT_EQ(fitted.code, 0) << fitted.err;
  EXPECT_GT(json::parse(fitted.out)["share"].get<double>(), 0.8);
}

}  // namespace
}  // namespace fascia::fit
