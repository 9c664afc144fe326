#include "builder/prepare/parts.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <set>

#include "builder/prepare/eyeballs.h"
#include "builder/prepare/part_names.h"
#include "builder/prepare/tooth_rows.h"
#include "builder/spatial/surface_query.h"
#include "geometry/connectivity.h"
#include "geometry/error.h"

namespace fascia::prepare {

namespace {

struct Component {
  std::vector<Vec3> points;
  std::set<int> meshes;
  double area = 0.0;
  Bounds box;
};

std::vector<Component> gather(const WeldedScene& welded) {
  std::vector<Component> all(static_cast<size_t>(welded.component_count));
  std::vector<bool> seen(welded.surface.vertices.size(), false);
  for (int t = 0; t < welded.surface.triangle_count(); ++t) {
    Component& component = all[static_cast<size_t>(welded.component[static_cast<size_t>(t)])];
    component.meshes.insert(welded.triangle_mesh[static_cast<size_t>(t)]);
    component.area += triangle_area(welded.surface, t);
    for (int v : welded.surface.triangles[static_cast<size_t>(t)]) {
      if (seen[static_cast<size_t>(v)]) continue;
      seen[static_cast<size_t>(v)] = true;
      component.points.push_back(welded.surface.vertices[static_cast<size_t>(v)]);
    }
  }
  for (Component& component : all)
    component.box = bounds(component.points);
  return all;
}

std::string names_of(const formats::Scene& scene, const Component& component) {
  std::string names;
  for (int m : component.meshes)
    names +=
        " " + scene.meshes[static_cast<size_t>(m)].name + " " + scene.meshes[static_cast<size_t>(m)].material;
  return names;
}

int skin_component(const formats::Scene& scene, const WeldedScene& welded,
                   const std::vector<Component>& components, const Landmarks& landmarks,
                   const PrepareOptions& options) {
  std::vector<double> score(components.size());
  for (size_t c = 0; c < components.size(); ++c)
    score[c] = 1e-6 * components[c].area;
  if (!options.skin.empty()) {
    joined_meshes(scene, options.skin);  // says which names there are when this is none
    for (size_t c = 0; c < components.size(); ++c)
      for (int m : components[c].meshes)
        if (scene.meshes[static_cast<size_t>(m)].name == options.skin) score[c] += 1e3 * components[c].area;
  }
  if (!landmarks.empty()) {
    const spatial::SurfaceQuery surface(welded.surface);
    for (const auto& [name, p] : landmarks) {
      const spatial::ClosestPoint hit = surface.nearest_place(p);
      if (hit.found())
        score[static_cast<size_t>(welded.component[static_cast<size_t>(hit.surface.triangle)])] += 1.0;
    }
  }
  return static_cast<int>(std::max_element(score.begin(), score.end()) - score.begin());
}

/// Rows of teeth run around an empty middle; a tongue does not.
bool is_arch(const Component& component) {
  const Vec3 centre = component.box.centre(), size = component.box.size();
  double front = -1e300, back = 1e300;
  for (const Vec3& p : component.points)
    if (std::abs(p[0] - centre[0]) < 0.12 * size[0]) {
      front = std::max(front, p[2]);
      back = std::min(back, p[2]);
    }
  return front > back && front - back < 0.6 * size[2];
}

/// The region of the head a part lies in, which restricts what it can be.
enum class Zone { mouth, lids, about_head, unknown };

struct Placed {
  Zone zone = Zone::unknown;
  Part likely = Part::other;
};

std::optional<Placed> in_mouth(const Component& component, const Landmarks& landmarks) {
  const auto left = find_landmark(landmarks, "cheilion_left"),
             right = find_landmark(landmarks, "cheilion_right");
  if (!left || !right) return std::nullopt;
  const Vec3 mouth = 0.5 * (*left + *right);
  // Lengths are an adult's; the mouths of stylised heads are wider, and what is in them larger.
  const double scale = std::clamp((*left - *right).norm() / 0.052, 1.0, 2.5);
  const Vec3 from = (component.box.centre() - mouth) / scale, size = component.box.size() / scale;
  const bool is_inside = std::abs(from[0]) < 0.04 && from[1] > -0.045 && from[1] < 0.035 && from[2] > -0.07 &&
                         component.box.upper[2] < mouth[2] + 0.02 * scale;
  if (!is_inside) return std::nullopt;
  const bool is_tongue = std::abs(from[0]) < 0.004 && size[0] > 0.02 && size[0] < 0.06 && size[1] < 0.048 &&
                         size[2] > 0.03 && from[1] < 0.003 && from[2] < -0.02 && !is_arch(component);
  if (is_tongue) return Placed{Zone::mouth, Part::tongue};
  if (size[1] > 0.035 || size.maxCoeff() > 0.07) return Placed{Zone::mouth, Part::mouth_interior};
  return Placed{Zone::mouth, from[1] > -0.003 ? Part::teeth_upper : Part::teeth_lower};
}

std::optional<Placed> at_lids(const Component& component, const Landmarks& landmarks) {
  for (const char* side : {"left", "right"}) {
    const auto outer = find_landmark(landmarks, "exocanthion_" + std::string(side));
    const auto inner = find_landmark(landmarks, "endocanthion_" + std::string(side));
    if (!outer || !inner) continue;
    const Vec3 from = component.box.centre() - 0.5 * (*outer + *inner), size = component.box.size();
    const double width = (*outer - *inner).norm();
    // A brow lies above the lids and is longer than high; lashes stand out in front of the lids.
    const bool is_brow = from[1] > 0.35 * width && from[1] < 1.3 * width && std::abs(from[0]) < 0.6 * width &&
                         size[0] > 0.8 * width && size[0] < 2.2 * width && size[1] < 0.8 * width &&
                         size[2] < 1.5 * width;
    if (is_brow) return Placed{Zone::lids, Part::brows};
    if (from.norm() < 0.022 && size.maxCoeff() < 0.05)
      return Placed{Zone::lids, from[2] > 0.2 * width ? Part::lashes : Part::eye_surround};
  }
  return std::nullopt;
}

/// Hair goes over the crown and is about as wide as the head; glasses sit before the eyes and reach from ear
/// to ear; clothes begin below the chin.
std::optional<Placed> about_head(const Component& component, const Landmarks& landmarks) {
  const auto glabella = find_landmark(landmarks, "glabella"), menton = find_landmark(landmarks, "menton"),
             nasion = find_landmark(landmarks, "nasion");
  const auto ear_left = find_landmark(landmarks, "tragion_left"),
             ear_right = find_landmark(landmarks, "tragion_right");
  if (!glabella || !menton || !nasion || !ear_left || !ear_right) return std::nullopt;
  const double height = (*glabella - *menton).norm(), width = (*ear_left - *ear_right).norm();
  const Bounds& box = component.box;
  const Vec3 size = box.size();
  const bool is_over_crown =
      box.upper[1] > (*glabella)[1] + 0.45 * height && box.upper[1] < (*glabella)[1] + 1.6 * height;
  if (is_over_crown && size[0] > 0.7 * width && size[0] < 3.0 * width)
    return Placed{Zone::about_head, Part::hair};
  const bool is_at_eyes =
      box.centre()[1] < (*glabella)[1] + 0.1 * height && box.centre()[1] > (*nasion)[1] - 0.35 * height;
  const bool is_before_eyes = box.upper[2] > (*nasion)[2] - 0.005 && box.upper[2] < (*nasion)[2] + 0.06;
  if (is_at_eyes && is_before_eyes && size[0] > 0.7 * width && size[0] < 1.5 * width &&
      size[1] < 0.7 * height)
    return Placed{Zone::about_head, Part::glasses};
  if (box.upper[1] < (*menton)[1] + 0.1 * height && size.maxCoeff() > 0.5 * width)
    return Placed{Zone::about_head, Part::clothes};
  return Placed{Zone::about_head, Part::other};
}

Placed place_of(const Component& component, const Landmarks& landmarks) {
  if (const auto placed = in_mouth(component, landmarks)) return *placed;
  if (const auto placed = at_lids(component, landmarks)) return *placed;
  return about_head(component, landmarks).value_or(Placed{});
}

Zone zone_of(Part part) {
  switch (part) {
    case Part::teeth_upper:
    case Part::teeth_lower:
    case Part::gums_upper:
    case Part::gums_lower:
    case Part::mouth_interior:
    case Part::tongue:
      return Zone::mouth;
    case Part::lashes:
    case Part::brows:
    case Part::eye_surround:
      return Zone::lids;
    default:
      return Zone::about_head;
  }
}

/// Which jaw teeth or gums belong to: by their name, else by lying below the mouth's line.
Part of_jaw(Part upper, const NamedPart& named, const Component& component, const Landmarks& landmarks) {
  const Part lower = upper == Part::teeth_upper ? Part::teeth_lower : Part::gums_lower;
  if (named.jaw != NamedPart::Jaw::unsaid) return named.jaw == NamedPart::Jaw::lower ? lower : upper;
  const auto mouth = find_landmark(landmarks, "stomion");
  if (!mouth) return upper;
  if (upper == Part::gums_upper && component.box.upper[1] > (*mouth)[1] + 0.004 &&
      component.box.lower[1] < (*mouth)[1] - 0.012)
    return Part::mouth_interior;  // of both jaws in one
  return component.box.centre()[1] < (*mouth)[1] - 0.003 ? lower : upper;
}

/// The part's position restricts what it can be; within that its name decides. If the position is
/// inconclusive, the name alone decides.
Part part_of(const Component& component, const NamedPart& named, const Landmarks& landmarks) {
  constexpr double speck = 1.5e-5;  // square metres: a tooth's crown, or a lash card, has more
  if (!named.part && component.area < speck) return Part::other;
  const Placed placed = place_of(component, landmarks);
  // Brows and lashes of both eyes are often one mesh, which lies between the eyes; cards of hair lie anywhere
  // about the head.
  const bool may_be = named.part && (placed.zone == Zone::unknown || zone_of(*named.part) == placed.zone ||
                                     (zone_of(*named.part) != Zone::mouth && placed.zone != Zone::mouth));
  // Some files have the tongue in the mesh of the teeth.
  const bool is_tongue = placed.likely == Part::tongue && named.part == Part::teeth_upper;
  if (!may_be || is_tongue) return placed.likely;
  if (*named.part == Part::teeth_upper || *named.part == Part::gums_upper)
    return of_jaw(*named.part, named, component, landmarks);
  return *named.part;
}

/// x of the plane between the two sides.
double middle_of_face(const Landmarks& landmarks) {
  double sum = 0.0, count = 0.0;
  for (const char* pair : {"exocanthion_", "endocanthion_", "cheilion_"})
    if (const auto left = find_landmark(landmarks, pair + std::string("left")),
        right = find_landmark(landmarks, pair + std::string("right"));
        left && right) {
      sum += (*left)[0] + (*right)[0];
      count += 2.0;
    }
  return count > 0.0 ? sum / count : 0.0;
}

/// Heights of the rows of teeth, NaN for a row that is not there.
struct RowHeights {
  double upper = NAN, lower = NAN;
};

/// Assigns every piece of teeth to a row: by its name if that tells, else by its height relative to the other
/// pieces; a single row is assigned by the line of the mouth. A piece that contains both rows gets neither.
RowHeights tell_rows_apart(const std::vector<Component>& components, const std::vector<NamedPart>& names,
                           const Landmarks& landmarks, std::vector<Part>& parts) {
  constexpr double over = 0.006, under = 0.012;  // metres about the mouth's line that one row does not fill
  const auto mouth = find_landmark(landmarks, "stomion");
  std::vector<size_t> pieces;
  std::vector<Bounds> boxes;
  double height = 0.0;
  for (size_t c = 0; c < parts.size(); ++c) {
    if (parts[c] != Part::teeth_upper && parts[c] != Part::teeth_lower) continue;
    pieces.push_back(c);
    boxes.push_back(components[c].box);
    height += components[c].box.centre()[1];
  }
  const std::optional<std::vector<bool>> lower = lower_row(boxes);
  const bool all_lower = mouth && height < ((*mouth)[1] - 0.003) * static_cast<double>(boxes.size());
  std::array<double, 2> sums{}, counts{};
  for (size_t i = 0; i < pieces.size(); ++i) {
    const NamedPart::Jaw said = names[pieces[i]].jaw;
    if (!lower && said == NamedPart::Jaw::unsaid && mouth && boxes[i].upper[1] > (*mouth)[1] + over &&
        boxes[i].lower[1] < (*mouth)[1] - under) {
      parts[pieces[i]] = Part::mouth_interior;
      continue;
    }
    const bool is_lower = said != NamedPart::Jaw::unsaid ? said == NamedPart::Jaw::lower
                          : lower                        ? (*lower)[i]
                                                         : all_lower;
    parts[pieces[i]] = is_lower ? Part::teeth_lower : Part::teeth_upper;
    sums[is_lower] += boxes[i].centre()[1];
    counts[is_lower] += 1.0;
  }
  return {counts[0] > 0.0 ? sums[0] / counts[0] : NAN, counts[1] > 0.0 ? sums[1] / counts[1] : NAN};
}

/// Gums go with the row of teeth they lie beyond, those of both rows in one with both jaws.
void tell_gums_apart(const std::vector<Component>& components, const std::vector<NamedPart>& names,
                     const RowHeights& rows, std::vector<Part>& parts) {
  if (std::isnan(rows.upper) || std::isnan(rows.lower)) return;
  for (size_t c = 0; c < parts.size(); ++c) {
    if ((parts[c] != Part::gums_upper && parts[c] != Part::gums_lower) ||
        names[c].jaw != NamedPart::Jaw::unsaid)
      continue;
    const Bounds& box = components[c].box;
    if (box.upper[1] > rows.upper && box.lower[1] < rows.lower)
      parts[c] = Part::mouth_interior;
    else
      parts[c] = box.centre()[1] > 0.5 * (rows.upper + rows.lower) ? Part::gums_upper : Part::gums_lower;
  }
}

}  // namespace

const char* part_name(Part part) {
  static constexpr const char* names[] = {"skin",           "eye_left",    "eye_right",  "eye_surround",
                                          "teeth_upper",    "teeth_lower", "gums_upper", "gums_lower",
                                          "mouth_interior", "tongue",      "lashes",     "brows",
                                          "hair",           "glasses",     "clothes",    "other"};
  return names[static_cast<int>(part)];
}

namespace {

/// The palpebral fissure: the middle between its corners, and its width.
struct Lids {
  Vec3 middle = Vec3::Zero();
  double width = 0.030;  ///< metres
};

std::optional<Lids> lids_of(const Landmarks& landmarks, bool is_left) {
  const auto outer = find_landmark(landmarks, is_left ? "exocanthion_left" : "exocanthion_right");
  const auto inner = find_landmark(landmarks, is_left ? "endocanthion_left" : "endocanthion_right");
  if (!outer || !inner) return std::nullopt;
  return Lids{0.5 * (*outer + *inner), (*outer - *inner).norm()};
}

/// Where what is called an eye lies on one side, within reach of the rough lids; empty when nothing does.
Bounds named_eye(const std::vector<Component>& components, const std::vector<NamedPart>& names,
                 const Lids& rough, double middle, bool is_left, int skin) {
  constexpr double reach = 1.5;  // widths of the fissure
  Bounds all;
  for (size_t c = 0; c < components.size(); ++c) {
    const Bounds& box = components[c].box;
    const Vec3 off = box.centre() - rough.middle;
    if (static_cast<int>(c) != skin && names[c].says_eye && (box.centre().x() > middle) == is_left &&
        off.norm() < reach * rough.width && box.size().x() < 2.0 * rough.width) {
      all.lower = all.lower.cwiseMin(box.lower);
      all.upper = all.upper.cwiseMax(box.upper);
    }
  }
  return all;
}

/// Both sides' fissures. Rough landmarks have the eyes of drawn faces, large and low, near the brows: where a
/// pair of meshes that are called eyes lies off them, the fissures are before these.
std::array<std::optional<Lids>, 2> fissures(const std::vector<Component>& components,
                                            const std::vector<NamedPart>& names, const Landmarks& landmarks,
                                            int skin) {
  constexpr double off = 0.25, level = 0.25;  // of the fissure's width
  std::array<std::optional<Lids>, 2> lids = {lids_of(landmarks, true), lids_of(landmarks, false)};
  if (!lids[0] || !lids[1]) return lids;
  const double middle = middle_of_face(landmarks);
  const Bounds left = named_eye(components, names, *lids[0], middle, true, skin),
               right = named_eye(components, names, *lids[1], middle, false, skin);
  if (!(left.size().x() > 0.0) || !(right.size().x() > 0.0)) return lids;
  const double width = 0.5 * (lids[0]->width + lids[1]->width);
  const bool is_pair = std::abs(left.centre().y() - right.centre().y()) < level * width &&
                       std::abs(left.size().x() - right.size().x()) < level * width;
  const auto beside = [&](const Bounds& eye, const Lids& rough) {
    return (eye.centre() - rough.middle).head<2>().norm();
  };
  if (!is_pair || std::max(beside(left, *lids[0]), beside(right, *lids[1])) < off * width) return lids;
  for (const bool is_left : {true, false}) {
    const Bounds& eye = is_left ? left : right;
    Lids& side = *lids[is_left ? 0 : 1];
    side.middle = Vec3(eye.centre().x(), eye.centre().y(), eye.upper.z());
    side.width = std::max(side.width, eye.size().x());
  }
  return lids;
}

/// The triangles of one component, with its own vertices.
TriangleMesh component_mesh(const WeldedScene& welded, size_t component) {
  std::vector<bool> is_kept(welded.surface.triangles.size());
  for (size_t t = 0; t < is_kept.size(); ++t)
    is_kept[t] = welded.component[t] == static_cast<int>(component);
  return submesh(welded.surface, is_kept, nullptr);
}

/// Marks the plates that are called an eye and lie in the fissure of one side, as anime characters have them.
std::optional<Eyeball> find_flat_eye(const std::vector<Component>& components,
                                     const std::vector<NamedPart>& names, const Lids& lids, bool is_left,
                                     int skin, std::vector<std::optional<Part>>& known) {
  Bounds plate;
  bool any = false;
  for (size_t c = 0; c < components.size(); ++c) {
    const Bounds& box = components[c].box;
    const Vec3 off = box.centre() - lids.middle, size = box.size();
    if (static_cast<int>(c) == skin || known[c] || !names[c].says_eye ||
        off.head<2>().norm() > 0.5 * lids.width || std::abs(off.z()) > lids.width ||
        size.x() > 1.5 * lids.width || size.z() > size.x())
      continue;
    known[c] = is_left ? Part::eye_left : Part::eye_right;
    plate.lower = plate.lower.cwiseMin(box.lower);
    plate.upper = plate.upper.cwiseMax(box.upper);
    any = true;
  }
  return any ? std::optional<Eyeball>(globe_behind(plate, lids.width)) : std::nullopt;
}

/// Marks the eyeball of one side and shells over it. An eyeball is what is round behind the lids and covers
/// the most directions.
std::optional<Eyeball> find_eye(const WeldedScene& welded, const std::vector<Component>& components,
                                const std::vector<NamedPart>& names, const Landmarks& landmarks,
                                const std::optional<Lids>& lids, bool is_left, int skin,
                                std::vector<std::optional<Part>>& known) {
  std::vector<std::pair<size_t, RoundPart>> round;
  double most = 0.0;
  for (size_t c = 0; c < components.size(); ++c) {
    if (static_cast<int>(c) == skin || (components[c].box.centre()[0] > middle_of_face(landmarks)) != is_left)
      continue;
    if (!lids && !names[c].says_eye) continue;
    const Vec3 size = components[c].box.size();
    if (!(size.minCoeff() > 0.25 * size.maxCoeff())) continue;
    const auto part = lids ? round_part(components[c].points, lids->middle, lids->width)
                           : round_part(components[c].points, components[c].box.centre());
    if (!part) continue;
    round.emplace_back(c, *part);
    most = std::max(most, part->coverage);
  }
  std::optional<Eyeball> eye;
  size_t of = 0;
  for (const auto& [c, part] : round) {
    const bool is_shell = part.coverage < 0.75 * most || (part.coverage < 0.6 && names[c].part);
    known[c] = is_shell  ? names[c].part.value_or(Part::eye_surround)
               : is_left ? Part::eye_left
                         : Part::eye_right;
    if (is_shell || (eye && part.ball.radius <= eye->radius)) continue;
    eye = part.ball;
    of = c;
  }
  if (!eye) return lids ? find_flat_eye(components, names, *lids, is_left, skin, known) : std::nullopt;
  const TriangleMesh mesh = component_mesh(welded, of);
  eye->gaze = gaze_axis(*eye, mesh.vertices, mesh.triangles);
  return eye;
}

}  // namespace

Parts recognise_parts(const formats::Scene& scene, const WeldedScene& welded, const Landmarks& landmarks,
                      const PrepareOptions& options) {
  const std::vector<Component> components = gather(welded);
  Parts parts;
  parts.component_parts.assign(components.size(), Part::other);
  const int skin = skin_component(scene, welded, components, landmarks, options);
  std::vector<NamedPart> names;
  for (const Component& component : components)
    names.push_back(part_by_name(names_of(scene, component)));
  std::vector<std::optional<Part>> known(components.size());
  known[static_cast<size_t>(skin)] = Part::skin;
  const auto lids = fissures(components, names, landmarks, skin);
  parts.eye_left = find_eye(welded, components, names, landmarks, lids[0], true, skin, known);
  parts.eye_right = find_eye(welded, components, names, landmarks, lids[1], false, skin, known);
  for (size_t c = 0; c < components.size(); ++c)
    parts.component_parts[c] = known[c] ? *known[c] : part_of(components[c], names[c], landmarks);
  const RowHeights rows = tell_rows_apart(components, names, landmarks, parts.component_parts);
  tell_gums_apart(components, names, rows, parts.component_parts);
  return parts;
}

}  // namespace fascia::prepare
