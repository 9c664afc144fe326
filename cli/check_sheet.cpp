#include "cli/check_sheet.h"

#include <algorithm>
#include <cmath>

#include "cli/picture.h"
#include "cli/posing.h"
#include "formats/scene.h"
#include "rig/read/read.h"
#include "view/renderer.h"

namespace fascia::cli {

namespace {

constexpr int tile_size = 340;  // pixels
constexpr int poses_a_row = 3;

/// A box about what a pose shows: eyes, brows, mouth or the whole face.
Bounds close_up(const rig::Rig& rig, const std::string& area) {
  std::vector<std::string> names;
  if (area == "eyes")
    names = {"exocanthion_left",   "exocanthion_right", "superciliare_left",
             "superciliare_right", "orbitale_left",     "orbitale_right"};
  else if (area == "brows")
    names = {"exocanthion_left", "exocanthion_right", "metopion", "subnasale"};
  else if (area == "mouth")
    names = {"cheilion_left", "cheilion_right", "pronasale", "menton", "zygion_left", "zygion_right"};
  std::vector<Vec3> points;
  for (const auto& landmark : rig.skull.landmarks)
    for (const std::string& name : names)
      if (landmark.name == name) points.push_back(landmark.skin.cast<double>());
  if (points.size() < 3) return face_box(rig);
  Bounds box = bounds(points);
  const Vec3 margin(0.006, 0.012, 0.0);
  box.lower -= margin;
  box.upper += margin;
  // A picture is as wide as high.
  const double more = 0.5 * std::max(0.0, box.size().x() - box.size().y());
  box.lower.y() -= more;
  box.upper.y() += more;
  return box;
}

/// Rings about the failing places, a little before the face so that nothing hides them.
void add_rings(view::DrawList& list, const std::vector<check::Row>& rows, const std::string& pose,
               const view::Camera& camera) {
  const double turn = camera.yaw * EIGEN_PI / 180.0, radius = 0.004;
  const Vec3 toward(std::sin(turn), 0.0, std::cos(turn)), across(std::cos(turn), 0.0, -std::sin(turn));
  view::DrawLines rings;
  rings.colour = Vec3(1.0, 0.1, 0.1);
  rings.width = 3.0;
  for (const check::Row& row : rows) {
    if (row.ok || row.pose != pose || !row.place) continue;
    std::vector<Vec3> ring;
    for (int k = 0; k <= 24; ++k)
      ring.push_back(
          *row.place + 0.03 * toward +
          radius * (std::cos(k * EIGEN_PI / 12.0) * across + std::sin(k * EIGEN_PI / 12.0) * Vec3::UnitY()));
    rings.lines.push_back(std::move(ring));
  }
  if (!rings.lines.empty()) list.lines.push_back(std::move(rings));
}

std::string caption_of(const std::vector<check::Row>& rows, const std::string& pose) {
  std::string failing;
  for (const check::Row& row : rows)
    if (!row.ok && row.pose == pose) failing += (failing.empty() ? "" : ", ") + row.name;
  return failing;
}

}  // namespace

view::Image check_sheet(const std::filesystem::path& path, const std::string& level,
                        const anatomy::Checks& checks, const std::vector<check::Row>& rows) {
  Face face(path, {FASCIA_SPACE_METRES, "own", level});
  const rig::RigFile file = rig::read(formats::read_bytes(path), path.string());
  const view::Renderer renderer(tile_size, tile_size);
  std::vector<view::Tile> tiles;
  const auto add = [&](const std::string& pose, const std::string& area) {
    const view::DrawList drawn = draw_face(face, file.rig, layers_from("skin,eyes"));
    const Bounds box = close_up(file.rig, area);
    const std::string failing = caption_of(rows, pose);
    for (const char* view : {"front", "three-quarter"}) {
      const view::Camera camera = view::named_camera(view, box);
      view::DrawList list = drawn;
      add_rings(list, rows, pose, camera);
      tiles.push_back({renderer.draw(list, camera), view == std::string("front") ? pose : failing});
    }
  };
  add("rest", "face");
  for (const anatomy::CheckPose& pose : checks.poses) {
    face.clear();
    for (const auto& [name, value] : pose.weights)
      face.set("arkit:" + name, value);
    face.pose();
    add(pose.name, pose.area);
  }
  return view::contact_sheet(tiles, 2 * poses_a_row);
}

}  // namespace fascia::cli
