#include "builder/openings/openings.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "builder/landmarks/generic_face.h"
#include "builder/openings/apply.h"
#include "builder/openings/closed_lids.h"
#include "builder/openings/eyeball.h"
#include "builder/openings/fused.h"
#include "builder/openings/lid_lining.h"
#include "builder/openings/mouth_lining.h"
#include "geometry/error.h"

namespace fascia::openings {

namespace {

// How far the cut goes towards the corners: lips and lids meet a little before the skin's corner.
constexpr double lip_end = 0.90, lid_end = 0.94;
constexpr double apart = 1e-5;  // metres

/// The lips' line as the landmarks have it: through the stomion.
MeetingLine lip_line(const prepare::PreparedHead& head, const Landmarks& landmarks, const FaceAxes& face) {
  const Vec3 &left = *find_landmark(landmarks, "cheilion_left"),
             &right = *find_landmark(landmarks, "cheilion_right");
  const Vec3 middle = *find_landmark(landmarks, "stomion") - 0.5 * (left + right);
  const Vec3 lateral = (left - right).normalized();
  const Vec3 up = (face.rotation.col(1) - face.rotation.col(1).dot(lateral) * lateral).normalized();
  const double height = std::clamp(middle.dot(up) / (left - right).norm(), -0.25, 0.25);
  return find_line(*head.surface, right, left, face,
                   [height](double along) { return height * (1.0 - along * along); });
}

/// The lids' line: closed lids meet where the lower one lies, a shallow bow below the canthi.
MeetingLine lid_line(const prepare::PreparedHead& head, const Landmarks& landmarks, const FaceAxes& face,
                     bool left) {
  const std::string side = left ? "_left" : "_right";
  const Vec3 &inner = *find_landmark(landmarks, "endocanthion" + side),
             &outer = *find_landmark(landmarks, "exocanthion" + side);
  const Vec3 &a = left ? inner : outer, &b = left ? outer : inner;
  constexpr double bow = -0.09;  // of the width
  LineSearch search;
  search.reach = 0.25;
  return find_line(
      *head.surface, a, b, face, [](double along) { return bow * (1.0 - along * along); }, search);
}

bool has_all(const Landmarks& landmarks, const std::vector<std::string>& names) {
  return std::all_of(names.begin(), names.end(),
                     [&](const std::string& name) { return landmarks.count(name) > 0; });
}

/// Cuts `head` along `line`; nothing, and a warning, where there is no way to.
std::optional<Cut> cut_head(const prepare::PreparedHead& head, const MeetingLine& line, double end,
                            const std::string& name, OpenedHead& opened) {
  const Connectivity links = connectivity(head.skin);
  Path path = trace(head.skin, links, *head.surface, line, end);
  if (path.nodes.size() < 3) {
    opened.warnings.push_back("the " + name +
                              " is closed and could not be parted: the skin has a hole or too few triangles "
                              "along the line; give its corners in --landmarks or cut it before building");
    return std::nullopt;
  }
  Cut cut = cut_along(head.skin, links, std::move(path));
  cut.apart = -apart * line.axes.col(1);
  return cut;
}

void record(const std::string& name, const MeetingLine& line, int vertices, OpenedHead& opened) {
  opened.parted.push_back({name, vertices, 2e3 * line.half_width, line.clearness});
}

/// The border of the hole that a mouth without an inside is; empty when there is none.
std::vector<int> hole_at(const TriangleMesh& skin, const MeetingLine& line) {
  for (const auto& loop : boundary_loops(skin, connectivity(skin))) {
    double least = 9.0, most = -9.0, farthest = 0.0;
    for (const int v : loop) {
      const Vec3& p = skin.vertices[static_cast<size_t>(v)];
      least = std::min(least, line.along(p));
      most = std::max(most, line.along(p));
      farthest = std::max(farthest, (p - line.place(std::clamp(line.along(p), -1.0, 1.0), 0.0, 0.0)).norm());
    }
    if (least < -0.6 && most > 0.6 && least > -1.3 && most < 1.3 && farthest < line.half_width) return loop;
  }
  return {};
}

bool are_lips_closed(const prepare::PreparedHead& head, const MeetingLine& line, OpenedHead& opened) {
  if (!is_fused(head.skin, connectivity(head.skin), *head.surface, line)) return false;
  constexpr double visible_bend = 0.15;  // radians in the mean: a furrow that can be seen
  if (line.clearness > visible_bend) return true;
  opened.warnings.emplace_back(
      "the mouth is closed and was not parted: there is no furrow where the lips would meet; give its "
      "corners "
      "and the stomion in --landmarks where they are elsewhere");
  return false;
}

/// Whether both eyes of the head are closed. Lids are left alone when in doubt: who closes one eye only, or
/// has eyes modelled open in one piece with their lids, keeps them.
bool are_lids_closed(const prepare::PreparedHead& head, const Landmarks& landmarks, const FaceAxes& face,
                     OpenedHead& opened) {
  const Connectivity links = connectivity(head.skin);
  int fused = 0;
  std::optional<std::string> doubt;
  for (const bool left : {true, false}) {
    const std::string side = left ? "_left" : "_right";
    if (!has_all(landmarks, {"endocanthion" + side, "exocanthion" + side})) return false;
    const MeetingLine line = lid_line(head, landmarks, face, left);
    const std::optional<prepare::Eyeball>& own = left ? head.eye_left : head.eye_right;
    if (own && eyeball_shows(*own, *head.surface, line)) continue;
    if (!is_fused(head.skin, links, *head.surface, line)) continue;
    ++fused;
    const auto why = doubt_of_closed_lids(*head.surface, line, face, own.has_value());
    if (why && !doubt) doubt = *why;
  }
  if (fused == 0) return false;
  if (fused == 1 && !doubt) doubt = "only one eye is closed";
  if (doubt)
    opened.warnings.push_back("the lids may be closed and were not parted: " + *doubt +
                              "; part them in the file if they should open");
  return !doubt;
}

void open_mouth(prepare::PreparedHead& head, const Landmarks& landmarks,
                const anatomy::GenericAnatomy& anatomy, const FaceAxes& face, bool is_inside_out,
                const OpeningOptions& options, OpenedHead& opened) {
  if (!has_all(landmarks, {"cheilion_left", "cheilion_right", "stomion"})) return;
  const MeetingLine line = lip_line(head, landmarks, face);
  const auto lined = [&](const Cut& cut, const Rim& rim) {
    const Lining lining = mouth_lining(landmarks::generic_face(anatomy), anatomy, landmarks, *head.surface,
                                       line, rim, cut.count());
    return apply(cut, lining, head, opened, is_inside_out);
  };
  const bool is_closed = options.open == "auto" && are_lips_closed(head, line, opened);
  if (is_closed)
    if (const auto cut = cut_head(head, line, lip_end, "mouth", opened)) {
      record(
          "mouth", line,
          cut->is_lined ? apply(*cut, {}, head, opened, is_inside_out) : lined(*cut, rim_of(head.skin, *cut)),
          opened);
      return;
    }
  if (!wants(options, "mouth", false)) return;
  const std::vector<int> hole = hole_at(head.skin, line);
  if (hole.empty()) return;
  Cut none;
  none.vertex_count = head.skin.vertex_count();
  opened.lining_vertices += lined(none, rim_of(head.skin, hole, line));
  opened.added.push_back("mouth");
}

void open_eye(prepare::PreparedHead& head, const Landmarks& landmarks, const anatomy::GenericAnatomy& anatomy,
              const FaceAxes& face, bool left, bool are_closed, bool is_inside_out,
              const OpeningOptions& options, OpenedHead& opened) {
  const std::string side = left ? "_left" : "_right", name = "eye" + side;
  if (!has_all(landmarks, {"endocanthion" + side, "exocanthion" + side})) return;
  const MeetingLine line = lid_line(head, landmarks, face, left);
  std::optional<prepare::Eyeball>& own = left ? head.eye_left : head.eye_right;
  const prepare::Eyeball globe = own ? *own : fit_globe(*head.surface, line, face);
  const auto cut = are_closed ? cut_head(head, line, lid_end, name, opened) : std::nullopt;
  if (cut) {
    const Lining lining =
        cut->is_lined ? Lining() : lid_lining(rim_of(head.skin, *cut), cut->count(), line, globe);
    record(name, line, apply(*cut, lining, head, opened, is_inside_out), opened);
  }
  if (own || !wants(options, "eyes", cut.has_value())) return;
  formats::SceneMesh mesh = eyeball_mesh(anatomy, globe, face, left);
  if (mesh.triangles.empty()) return;
  add_mesh(opened, head, std::move(mesh), left ? prepare::Part::eye_left : prepare::Part::eye_right);
  own = globe;
}

}  // namespace

void check(const OpeningOptions& options) {
  if (options.open != "auto" && options.open != "never")
    throw Error("--open '" + options.open + "' is unknown: use auto or never");
  for (const std::string& word : options.add)
    if (word != "auto" && word != "none" && word != "mouth" && word != "teeth" && word != "tongue" &&
        word != "eyes")
      throw Error("--add '" + word + "' is unknown: use auto, none, or any of mouth,teeth,tongue,eyes");
}

bool wants(const OpeningOptions& options, const std::string& part, bool by_auto) {
  for (const std::string& word : options.add)
    if (word == part || (word == "auto" && by_auto)) return true;
  return false;
}

void add_mesh(OpenedHead& opened, prepare::PreparedHead& head, formats::SceneMesh mesh, prepare::Part part) {
  prepare::PreparedMesh prepared;
  prepared.name = mesh.name;
  prepared.positions = mesh.positions;
  prepared.triangles = mesh.triangles;
  prepared.parts.assign(mesh.positions.size(), part);
  prepared.skin_vertices.assign(mesh.positions.size(), -1);
  const Mat4 to_file = head.input_to_metres.inverse();
  for (Vec3& p : mesh.positions)
    p = transform_point(to_file, p);
  if (to_file.topLeftCorner<3, 3>().determinant() < 0.0)
    for (Triangle& t : mesh.triangles)
      std::swap(t[1], t[2]);
  opened.added.push_back(mesh.name);
  opened.scene.meshes.push_back(std::move(mesh));
  head.meshes.push_back(std::move(prepared));
}

OpenedHead open_head(const formats::Scene& scene, prepare::PreparedHead& head, const Landmarks& landmarks,
                     const anatomy::GenericAnatomy& anatomy, bool is_inside_out,
                     const OpeningOptions& options) {
  OpenedHead opened;
  opened.scene = scene;
  for (const formats::SceneMesh& mesh : scene.meshes)
    opened.extensions.push_back(formats::unchanged(mesh));
  const FaceAxes face = face_axes(anatomy, landmarks);
  open_mouth(head, landmarks, anatomy, face, is_inside_out, options, opened);
  const bool are_closed = options.open == "auto" && are_lids_closed(head, landmarks, face, opened);
  for (const bool left : {true, false})
    open_eye(head, landmarks, anatomy, face, left, are_closed, is_inside_out, options, opened);
  return opened;
}

}  // namespace fascia::openings
