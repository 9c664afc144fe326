#include "cli/snapshot_report.h"

#include <algorithm>
#include <cmath>

#include "cli/page.h"
#include "cli/picture.h"
#include "cli/take/performance.h"
#include "formats/scene.h"
#include "geometry/error.h"
#include "geometry/text.h"
#include "rig/read/read.h"
#include "snapshot/junit.h"
#include "view/renderer.h"

namespace fascia::cli {

namespace {

constexpr int picture_size = 420;  // pixels
constexpr size_t states_drawn = 6, rows_listed = 40;
constexpr double reach_mm = 20.0;  // a difference is shown this far about the vertex where it is known

/// The states in which regions differ most, those that fail first.
std::vector<size_t> states_to_draw(const snapshot::Comparison& comparison) {
  std::vector<size_t> states;
  for (const snapshot::Difference& difference : comparison.worst(comparison.differences.size())) {
    if (states.size() == states_drawn || (difference.ok && difference.largest_mm == 0.0)) break;
    if (std::find(states.begin(), states.end(), difference.state) == states.end())
      states.push_back(difference.state);
  }
  std::sort(states.begin(), states.end());
  return states;
}

/// Brings `face` into a state of the snapshot.
void enter(Face& face, const snapshot::Snapshot& snapshot, size_t state, const SnapshotReport& report) {
  face.clear();
  face.reset();
  if (state == 0) return;
  if (state <= snapshot.poses.size()) {
    for (const auto& [name, value] : snapshot.poses[state - 1].values)
      face.set(name, value);
    face.pose();
    return;
  }
  size_t left = state - 1 - snapshot.poses.size(), take = 0;
  for (; left >= snapshot.takes[take].frames.size(); ++take)
    left -= snapshot.takes[take].frames.size();
  const Curves curves(report.curves.at(take));
  const double rate = snapshot.takes[take].frames_per_second;
  curves.apply(0.0, face);
  face.pose();
  for (uint32_t frame = 1; frame <= snapshot.takes[take].frames[left]; ++frame) {
    curves.apply(frame / rate, face);
    face.step(1.0 / rate);
  }
}

/// A watched vertex and how far the recorded face lay from the present one there, metres.
struct Known {
  Vec3 rest, off;
};

std::vector<Known> known_of(const FaceMesh& mesh, const snapshot::Snapshot& then,
                            const snapshot::Snapshot& now, size_t state) {
  std::vector<Known> list;
  for (size_t r = 0; r < then.regions.size(); ++r) {
    const snapshot::Region& region = then.regions[r];
    const size_t first = then.first_vertex(r);
    for (size_t i = 0; i < region.vertices.size(); ++i) {
      const snapshot::Mesh& watched = then.meshes[region.vertices[i].mesh];
      if (watched.mesh != mesh.mesh || watched.primitive != mesh.primitive) continue;
      Known known;
      for (int k = 0; k < 3; ++k) {
        const size_t at = 3 * (first + i) + static_cast<size_t>(k);
        known.rest[k] = 1e-3 * now.quantum_mm * now.states[0].quanta[at];
        known.off[k] =
            1e-3 * now.quantum_mm *
            static_cast<double>(int64_t{then.states[state].quanta[at]} - now.states[state].quanta[at]);
      }
      list.push_back(known);
    }
  }
  return list;
}

/// The difference at every vertex of a mesh: those that are known, weighed by nearness.
std::vector<Vec3> spread_out(std::span<const float> rest, const std::vector<Known>& known) {
  std::vector<Vec3> field;
  const double reach = 1e-3 * reach_mm;
  for (size_t i = 0; i + 2 < rest.size(); i += 3) {
    const Vec3 at(rest[i], rest[i + 1], rest[i + 2]);
    Vec3 sum = Vec3::Zero();
    double weights = 0.0, nearest = reach;
    for (const Known& point : known) {
      const double away = (point.rest - at).norm();
      if (away >= reach) continue;
      const double weight = std::pow((1.0 - away / reach) / std::max(away, 1e-6), 2);
      sum += weight * point.off;
      weights += weight;
      nearest = std::min(nearest, away);
    }
    field.push_back(weights > 0.0 ? Vec3(sum / weights * (1.0 - nearest / reach)) : Vec3::Zero());
  }
  return field;
}

/// Grey where nothing differs, yellow at the tolerance, red at four times as much and beyond.
Vec3 heat(double mm, double tolerance_mm) {
  const Vec3 grey(0.72, 0.72, 0.74), yellow(0.98, 0.80, 0.15), red(0.78, 0.07, 0.10);
  const double share = mm / tolerance_mm;
  if (share <= 1.0) return grey + share * (yellow - grey);
  return yellow + std::min((share - 1.0) / (snapshot::largest_share - 1.0), 1.0) * (red - yellow);
}

struct Triptych {
  view::DrawList then, now, heat;
};

Triptych drawings(const Face& face, const rig::Rig& rig, const snapshot::Snapshot& then,
                  const snapshot::Snapshot& snapshot_now, size_t state, double tolerance_mm) {
  Triptych three;
  three.now = draw_face(face, rig, layers_from("skin,eyes"));
  three.then = three.now;
  for (size_t m = 0; m < face.meshes().size(); ++m) {
    const auto field = spread_out(face.rest(m), known_of(face.meshes()[m], then, snapshot_now, state));
    const std::span<const float> at = face.positions(m);
    view::DrawSurface surface;
    for (size_t v = 0; v < field.size(); ++v) {
      surface.positions.emplace_back(at[3 * v], at[3 * v + 1], at[3 * v + 2]);
      surface.vertex_colours.push_back(heat(1e3 * field[v].norm(), tolerance_mm));
    }
    surface.triangles = face.meshes()[m].triangles;
    // draw_face leaves out what would hide the face; so does the map.
    for (view::DrawSurface& drawn : three.then.surfaces) {
      if (drawn.positions.size() != surface.positions.size() || drawn.positions != surface.positions)
        continue;
      for (size_t v = 0; v < field.size(); ++v)
        drawn.positions[v] += field[v];
      three.heat.surfaces.push_back(surface);
      break;
    }
  }
  return three;
}

std::string pictures(const SnapshotReport& report, const snapshot::Snapshot& then,
                     const snapshot::Snapshot& now, const snapshot::Comparison& comparison) {
  const std::vector<size_t> states = states_to_draw(comparison);
  if (states.empty()) return "";
  Face face(report.rig, {FASCIA_SPACE_METRES, "own", now.level});
  const rig::RigFile file = rig::read(formats::read_bytes(report.rig), report.rig.string());
  const view::Renderer renderer(picture_size, picture_size);
  const view::Camera camera = view::named_camera("front", face_box(file.rig));
  double tolerance = report.tolerance_mm;
  for (const snapshot::Region& region : then.regions)
    if (report.tolerance_mm <= 0.0) tolerance = std::max(tolerance, region.tolerance_mm);
  std::string out =
      "<p class=cap>As recorded (drawn back from the watched vertices), as it is now, and where "
      "they differ: yellow at " +
      page::number(tolerance, 3) + " mm, red from " + page::number(snapshot::largest_share * tolerance, 3) +
      " mm.</p>\n";
  for (const size_t state : states) {
    enter(face, now, state, report);
    const Triptych three = drawings(face, file.rig, then, now, state, tolerance);
    const std::string name = now.states[state].name;
    out += "<h2>" + escaped_markup(name) + "</h2>\n<div class=views>" +
           page::picture(renderer.draw(three.then, camera), name + " as recorded") +
           page::picture(renderer.draw(three.now, camera), name + " now") +
           page::picture(renderer.draw(three.heat, camera), name + ", difference") + "</div>\n";
  }
  return out;
}

}  // namespace

std::string snapshot_page(const SnapshotReport& report, const snapshot::Snapshot& then,
                          const snapshot::Snapshot& now, const snapshot::Comparison& comparison) {
  std::string body = "<p>" + std::to_string(then.states.size()) + " poses and frames, " +
                     std::to_string(then.regions.size()) + " regions; " + std::to_string(comparison.failed) +
                     " differ by more than is allowed. " +
                     (comparison.is_same_rig ? "The rig is the very file that was recorded."
                                             : "The rig is another file than was recorded.") +
                     "</p>\n";
  try {
    body += pictures(report, then, now, comparison);
  } catch (const Error& error) {
    body += "<p class=warn>No pictures: " + escaped_markup(error.what()) + "</p>\n";
  }
  body += "<h2>What differs most</h2>\n<table>\n" +
          page::row({"pose or frame", "region", "mean mm", "largest mm", "vertex", "allowed mm"}, "th", 2);
  for (const snapshot::Difference& difference : comparison.worst(rows_listed)) {
    const snapshot::Region& region = then.regions[difference.region];
    const std::string mean = page::number(difference.mean_mm, 3);
    body +=
        page::row({escaped_markup(then.states[difference.state].name), escaped_markup(region.name),
                   difference.ok ? mean : "<span class=far>" + mean + "</span>",
                   page::number(difference.largest_mm, 3), std::to_string(difference.vertex.vertex),
                   page::number(report.tolerance_mm > 0.0 ? report.tolerance_mm : region.tolerance_mm, 3)},
                  "td", 2);
  }
  body += "</table>\n<h2>Why it was recorded</h2>\n<ul>\n";
  for (const std::string& reason : then.reasons)
    body += "<li>" + escaped_markup(reason) + "</li>\n";
  return page::whole("Snapshot of " + report.rig.filename().string(), body + "</ul>\n");
}

}  // namespace fascia::cli
