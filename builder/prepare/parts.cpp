#include "builder/prepare/parts.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cctype>
#include <cmath>
#include <set>

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
  for (Component& component : all) component.box = bounds(component.points);
  return all;
}

std::string lower(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(), [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return text;
}

bool contains_any(const std::string& text, std::initializer_list<const char*> words) {
  return std::any_of(words.begin(), words.end(), [&](const char* word) { return text.find(word) != std::string::npos; });
}

/// What the names of a component's meshes and materials say, or nothing.
std::optional<Part> part_by_name(const std::string& name) {
  if (contains_any(name, {"eyelash", "lash"})) return Part::lashes;
  if (contains_any(name, {"eyebrow", "brow"})) return Part::brows;
  if (contains_any(name, {"lacrimal", "tearline", "tear_line", "eye_occlusion", "eyeocclusion", "eye_blend", "eyeblend",
                          "eyeshadow", "eye_shadow", "eyewet", "cartilage"}))
    return Part::eye_surround;
  if (contains_any(name, {"tongue"}) && !contains_any(name, {"gum"})) return Part::tongue;
  if (contains_any(name, {"gum", "palate", "mouth_inner", "mouthbag", "mouth_bag", "mouth_lining"})) return Part::mouth_interior;
  if (contains_any(name, {"teeth", "tooth", "dent"})) return Part::teeth_upper;  // which jaw is told by place
  if (contains_any(name, {"hair", "scalp_card", "beard", "mustache"})) return Part::hair;
  return std::nullopt;
}

std::string names_of(const formats::Scene& scene, const Component& component) {
  std::string names;
  for (int m : component.meshes)
    names += " " + lower(scene.meshes[static_cast<size_t>(m)].name) + " " + lower(scene.meshes[static_cast<size_t>(m)].material);
  return names;
}

std::optional<Vec3> landmark(const std::map<std::string, Vec3>& landmarks, const char* name) {
  const auto at = landmarks.find(name);
  if (at == landmarks.end()) return std::nullopt;
  return at->second;
}

int skin_component(const formats::Scene& scene, const WeldedScene& welded, const std::vector<Component>& components,
                   const std::map<std::string, Vec3>& landmarks, const PrepareOptions& options) {
  std::vector<double> score(components.size());
  for (size_t c = 0; c < components.size(); ++c) score[c] = 1e-6 * components[c].area;
  if (!options.skin.empty()) {
    joined_meshes(scene, options.skin);  // says which names there are when this is none
    for (size_t c = 0; c < components.size(); ++c)
      for (int m : components[c].meshes)
        if (scene.meshes[static_cast<size_t>(m)].name == options.skin) score[c] += 1e3 * components[c].area;
  }
  if (!landmarks.empty()) {
    const spatial::SurfaceQuery surface(welded.surface);
    for (const auto& [name, p] : landmarks) {
      const spatial::ClosestPoint hit = surface.closest(p);
      if (hit.found()) score[static_cast<size_t>(welded.component[static_cast<size_t>(hit.surface.triangle)])] += 1.0;
    }
  }
  return static_cast<int>(std::max_element(score.begin(), score.end()) - score.begin());
}

/// An eyeball is round, about 12 mm in radius, and lies behind the lids.
std::optional<Eyeball> as_eyeball(const Component& component, const std::optional<Vec3>& outer,
                                  const std::optional<Vec3>& inner, const std::string& names) {
  if (component.points.size() < 20) return std::nullopt;
  double rms = 0.0;
  Eyeball eye = fit_sphere(component.points, &rms);
  const Vec3 size = component.box.size();
  const bool is_round = rms < 0.12 * eye.radius && size.minCoeff() > 0.6 * size.maxCoeff();
  if (!is_round || eye.radius < 0.006 || eye.radius > 0.025) return std::nullopt;
  if (outer && inner) {
    const Vec3 lids = 0.5 * (*outer + *inner);
    if ((eye.centre - lids).norm() > 0.03) return std::nullopt;
  } else if (names.find("eye") == std::string::npos) {
    return std::nullopt;
  }
  return eye;
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

/// Parts of the mouth and lids by where they lie, when names do not tell.
Part part_by_place(const Component& component, const std::map<std::string, Vec3>& landmarks) {
  const auto left = landmark(landmarks, "cheilion_left"), right = landmark(landmarks, "cheilion_right");
  const Vec3 centre = component.box.centre();
  if (left && right) {
    const Vec3 mouth = 0.5 * (*left + *right);
    const Vec3 from = centre - mouth;
    const bool is_inside = std::abs(from[0]) < 0.04 && from[1] > -0.045 && from[1] < 0.035 && from[2] > -0.07 &&
                           component.box.upper[2] < mouth[2] + 0.02;
    if (is_inside) {
      const Vec3 size = component.box.size();
      const bool is_tongue = std::abs(from[0]) < 0.004 && size[0] > 0.02 && size[0] < 0.06 && size[1] < 0.048 && size[2] > 0.03 &&
                             from[1] < 0.003 && from[2] < -0.02 && !is_arch(component);
      if (is_tongue) return Part::tongue;
      if (size[1] > 0.035 || size.maxCoeff() > 0.07) return Part::mouth_interior;
      return from[1] > -0.003 ? Part::teeth_upper : Part::teeth_lower;
    }
  }
  for (const char* side : {"left", "right"}) {
    const auto outer = landmark(landmarks, ("exocanthion_" + std::string(side)).c_str());
    const auto inner = landmark(landmarks, ("endocanthion_" + std::string(side)).c_str());
    if (!outer || !inner) continue;
    const Vec3 from = centre - 0.5 * (*outer + *inner), size = component.box.size();
    const double width = (*outer - *inner).norm();
    // A brow lies above the lids and is longer than high; lashes stand out in front of the lids.
    const bool is_brow = from[1] > 0.35 * width && from[1] < 1.3 * width && std::abs(from[0]) < 0.6 * width && size[0] > 0.8 * width &&
                         size[0] < 2.2 * width && size[1] < 0.8 * width && size[2] < 1.5 * width;
    if (is_brow) return Part::brows;
    if (from.norm() < 0.022 && size.maxCoeff() < 0.05) return from[2] > 0.2 * width ? Part::lashes : Part::eye_surround;
  }
  // Hair goes over the crown and is about as wide as the head.
  const auto glabella = landmark(landmarks, "glabella"), menton = landmark(landmarks, "menton");
  const auto ear_left = landmark(landmarks, "tragion_left"), ear_right = landmark(landmarks, "tragion_right");
  if (glabella && menton && ear_left && ear_right) {
    const double height = (*glabella - *menton).norm(), width = (*ear_left - *ear_right).norm();
    const bool is_over_crown = component.box.upper[1] > (*glabella)[1] + 0.45 * height && component.box.upper[1] < (*glabella)[1] + 1.6 * height;
    if (is_over_crown && component.box.size()[0] > 0.7 * width && component.box.size()[0] < 3.0 * width) return Part::hair;
  }
  return Part::other;
}

/// x of the plane between the two sides.
double middle_of_face(const std::map<std::string, Vec3>& landmarks) {
  double sum = 0.0, count = 0.0;
  for (const char* pair : {"exocanthion_", "endocanthion_", "cheilion_"})
    if (const auto left = landmark(landmarks, (pair + std::string("left")).c_str()), right = landmark(landmarks, (pair + std::string("right")).c_str());
        left && right) {
      sum += (*left)[0] + (*right)[0];
      count += 2.0;
    }
  return count > 0.0 ? sum / count : 0.0;
}

/// Two rows of teeth that place alone took for upper ones: the lower of them is the lower row.
void tell_rows_apart(const std::vector<Component>& components, const std::vector<bool>& is_by_place, std::vector<Part>& parts) {
  double lowest = 1e300, highest = -1e300;
  bool has_both = false;
  for (size_t c = 0; c < parts.size(); ++c) {
    if (parts[c] != Part::teeth_upper && parts[c] != Part::teeth_lower) continue;
    has_both |= parts[c] == Part::teeth_lower;
    lowest = std::min(lowest, components[c].box.centre()[1]);
    highest = std::max(highest, components[c].box.centre()[1]);
  }
  if (has_both || highest - lowest < 0.004) return;
  for (size_t c = 0; c < parts.size(); ++c)
    if (is_by_place[c] && parts[c] == Part::teeth_upper && components[c].box.centre()[1] < 0.5 * (lowest + highest)) parts[c] = Part::teeth_lower;
}

}  // namespace

const char* part_name(Part part) {
  static constexpr const char* names[] = {"skin",        "eye_left",       "eye_right", "eye_surround",
                                          "teeth_upper", "teeth_lower",    "mouth_interior", "tongue",
                                          "lashes",      "brows",          "hair",      "other"};
  return names[static_cast<int>(part)];
}

Eyeball fit_sphere(const std::vector<Vec3>& points, double* rms) {
  // |p|^2 = 2 c.p + (r^2 - |c|^2) is linear in c and the bracket; centred for conditioning.
  Vec3 mean = Vec3::Zero();
  for (const Vec3& p : points) mean += p / static_cast<double>(points.size());
  Eigen::MatrixX4d rows(points.size(), 4);
  Eigen::VectorXd squares(points.size());
  for (size_t i = 0; i < points.size(); ++i) {
    const Vec3 p = points[i] - mean;
    rows.row(static_cast<Eigen::Index>(i)) << 2 * p[0], 2 * p[1], 2 * p[2], 1.0;
    squares[static_cast<Eigen::Index>(i)] = p.squaredNorm();
  }
  const Eigen::Vector4d solution = rows.colPivHouseholderQr().solve(squares);
  Eyeball sphere;
  sphere.centre = solution.head<3>() + mean;
  sphere.radius = std::sqrt(std::max(0.0, solution[3] + solution.head<3>().squaredNorm()));
  double sum = 0.0;
  for (const Vec3& p : points) sum += std::pow((p - sphere.centre).norm() - sphere.radius, 2);
  if (rms) *rms = std::sqrt(sum / static_cast<double>(points.size()));
  return sphere;
}

Parts recognise_parts(const formats::Scene& scene, const WeldedScene& welded,
                      const std::map<std::string, Vec3>& landmarks, const PrepareOptions& options) {
  const std::vector<Component> components = gather(welded);
  Parts parts;
  parts.component_parts.assign(components.size(), Part::other);
  const int skin = skin_component(scene, welded, components, landmarks, options);
  const auto mouth = landmark(landmarks, "stomion");
  std::vector<bool> is_by_place(components.size(), false);
  for (size_t c = 0; c < components.size(); ++c) {
    if (static_cast<int>(c) == skin) {
      parts.component_parts[c] = Part::skin;
      continue;
    }
    const std::string names = names_of(scene, components[c]);
    const std::optional<Part> named = part_by_name(names);
    bool is_eye = false;
    const double midline = middle_of_face(landmarks);
    for (const bool is_left : {true, false}) {
      const auto outer = landmark(landmarks, is_left ? "exocanthion_left" : "exocanthion_right");
      const auto inner = landmark(landmarks, is_left ? "endocanthion_left" : "endocanthion_right");
      if (named || (components[c].box.centre()[0] > midline) != is_left) continue;
      if (const auto eye = as_eyeball(components[c], outer, inner, names)) {
        std::optional<Eyeball>& best = is_left ? parts.eye_left : parts.eye_right;
        if (!best || eye->radius > best->radius) best = eye;
        parts.component_parts[c] = is_left ? Part::eye_left : Part::eye_right;
        is_eye = true;
      }
    }
    if (is_eye) continue;
    parts.component_parts[c] = named ? *named : part_by_place(components[c], landmarks);
    is_by_place[c] = !named;
    if (named == Part::teeth_upper) {
      const bool says_lower = contains_any(names, {"lower", "bottom", "mandib"});
      const bool says_upper = contains_any(names, {"upper", "top", "maxill"});
      const bool is_below = mouth && components[c].box.centre()[1] < (*mouth)[1] - 0.003;
      if (says_lower || (!says_upper && is_below)) parts.component_parts[c] = Part::teeth_lower;
    }
  }
  tell_rows_apart(components, is_by_place, parts.component_parts);
  return parts;
}

}  // namespace fascia::prepare
