#include "cli/muscle_sheet.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <sstream>

#include "cli/picture.h"
#include "geometry/error.h"
#include "geometry/nearest_names.h"
#include "view/renderer.h"

namespace fascia::cli {

namespace {

std::string without_side(const std::string& name) {
  for (const char* side : {"_left", "_right"})
    if (name.ends_with(side)) return name.substr(0, name.rfind('_'));
  return name;
}

/// The n-th of `count` colours that are easy to tell apart: around the circle of hues, every other one
/// lighter.
Vec3 colour_of(size_t n, size_t count) {
  const double hue = 6.0 * double(n) / double(std::max<size_t>(1, count)), light = n % 2 == 0 ? 0.95 : 0.62;
  const auto channel = [&](double offset) {
    const double at = std::fmod(hue + offset, 6.0);
    return light * (1.0 - 0.85 * std::clamp(std::min(at, 4.0 - at), 0.0, 1.0));
  };
  return Vec3(channel(5.0), channel(3.0), channel(1.0));
}

view::Colour bytes_of(const Vec3& colour) {
  view::Colour bytes;
  for (int i = 0; i < 3; ++i)
    bytes[static_cast<size_t>(i)] =
        static_cast<uint8_t>(std::lround(255.0 * std::clamp(colour[i], 0.0, 1.0)));
  return bytes;
}

/// A column of colour patches and names.
view::Image legend(const std::vector<std::pair<std::string, Vec3>>& entries, int height) {
  view::Image image(height >= 400 ? 330 : 250, height, {30, 33, 38});
  const int step = std::clamp((height - 20) / std::max(1, static_cast<int>(entries.size())), 12, 22);
  int y = 12;
  for (const auto& [name, colour] : entries) {
    view::paste(image, view::Image(14, std::min(12, step - 2), bytes_of(colour)), 10, y);
    view::write_label(image, name, 32, y + 2, 1, {225, 225, 225});
    y += step;
  }
  return image;
}

}  // namespace

std::vector<std::string> muscles_from(const std::string& list, const rig::Rig& rig) {
  std::vector<std::string> names;
  std::istringstream words(list);
  const auto add = [&](const std::string& wanted) {
    bool found = false;
    for (const rig::Muscle& muscle : rig.muscles)
      for (const std::string& name :
           {muscle.name, muscle.group, without_side(muscle.name), without_side(muscle.group)})
        if (wanted.empty() || name == wanted) {
          if (std::find(names.begin(), names.end(), muscle.name) == names.end()) names.push_back(muscle.name);
          found = true;
        }
    if (found) return;
    std::vector<std::string> known;
    for (const rig::Muscle& muscle : rig.muscles)
      known.push_back(muscle.name);
    throw Error("there is no muscle '" + wanted + "'" + did_you_mean(wanted, known) +
                "; 'fascia info RIG.glb --channels' lists them");
  };
  for (std::string word; std::getline(words, word, ',');)
    add(word);
  if (names.empty()) add("");
  return names;
}

view::Image muscle_sheet(const Face& face, const rig::Rig& rig, const std::vector<std::string>& muscles,
                         int size) {
  std::vector<std::string> kinds;  // one a muscle, for both its sides
  for (const std::string& name : muscles)
    if (const std::string kind = without_side(name);
        std::find(kinds.begin(), kinds.end(), kind) == kinds.end())
      kinds.push_back(kind);
  std::map<std::string, Vec3> colours;
  std::vector<std::pair<std::string, Vec3>> entries;
  for (size_t k = 0; k < kinds.size(); ++k) {
    colours[kinds[k]] = colour_of(k, kinds.size());
    entries.emplace_back(kinds[k], colours[kinds[k]]);
  }
  view::DrawList list = draw_face(face, rig, {"skull", "smas", "eyes"});
  // Muscles from bone to bone lie behind bones: then these are glass.
  const bool has_deep = std::any_of(rig.muscles.begin(), rig.muscles.end(), [&](const rig::Muscle& muscle) {
    const auto bony = [](rig::FibreEnd end) {
      return end == rig::FibreEnd::cranium || end == rig::FibreEnd::mandible;
    };
    return colours.count(without_side(muscle.name)) && bony(muscle.origin) && bony(muscle.insertion);
  });
  for (view::DrawSurface& surface : list.surfaces)
    surface.opacity = surface.opacity < 1.0 ? 0.16 : has_deep ? 0.35 : 1.0;
  Bounds box = face_box(rig);
  for (auto& [name, lines] : all_fibres(face, rig)) {
    const auto colour = colours.find(without_side(name));
    if (colour == colours.end()) continue;
    for (const auto& line : lines)
      for (const Vec3& p : line)
        box.lower = box.lower.cwiseMin(p), box.upper = box.upper.cwiseMax(p);
    list.lines.push_back({std::move(lines), colour->second, 1.3});
  }
  const view::Renderer renderer(size, size);
  std::vector<view::Tile> tiles;
  for (const char* name : {"front", "three-quarter", "side", "below"}) {
    view::Camera camera = view::named_camera(std::string(name) == "below" ? "front" : name, box);
    camera.distance *= 0.84;
    if (std::string(name) == "below") {
      camera.yaw = 25.0;
      camera.pitch = -35.0;
    }
    tiles.push_back({renderer.draw(list, camera), name});
  }
  const view::Image views = view::contact_sheet(tiles, 2), names = legend(entries, views.height);
  view::Image sheet(views.width + names.width, views.height, {30, 33, 38});
  view::paste(sheet, views, 0, 0);
  view::paste(sheet, names, views.width, 0);
  return sheet;
}

}  // namespace fascia::cli
