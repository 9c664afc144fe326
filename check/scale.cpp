#include "check/scale.h"

namespace fascia::check {

AdultSizes distances(const Landmarks& landmarks) {
  AdultSizes out;
  const auto find = [&](const char* name) {
    const auto at = landmarks.find(name);
    return at == landmarks.end() ? nullptr : &at->second;
  };
  Vec3 middle = Vec3::Zero();
  constexpr const char* face[] = {"exocanthion_left", "exocanthion_right", "cheilion_left",
                                  "cheilion_right",   "sellion",           "gnathion"};
  bool is_whole = true;
  for (const char* name : face) {
    if (const Vec3* p = find(name))
      middle += *p / 6.0;
    else
      is_whole = false;
  }
  if (is_whole)
    for (const char* name : face)
      out.face += (*find(name) - middle).norm() / 6.0;
  const Vec3 *left = find("cheilion_left"), *right = find("cheilion_right");
  if (left && right) out.mouth = (*left - *right).norm();
  int eyes = 0;
  for (const char* side : {"_left", "_right"}) {
    const Vec3 *inner = find((std::string("endocanthion") + side).c_str()),
               *outer = find((std::string("exocanthion") + side).c_str());
    if (!inner || !outer) continue;
    out.eye += (*inner - *outer).norm();
    ++eyes;
  }
  if (eyes > 0) out.eye /= eyes;
  return out;
}

Sizes sizes(const Landmarks& landmarks, const AdultSizes& adult) {
  const AdultSizes here = distances(landmarks);
  Sizes out;
  if (here.face > 0.0 && adult.face > 0.0) out.face = here.face / adult.face;
  if (here.mouth > 0.0 && adult.mouth > 0.0) out.mouth = here.mouth / adult.mouth;
  if (here.eye > 0.0 && adult.eye > 0.0) out.eye = here.eye / adult.eye;
  return out;
}

std::optional<Eye> plausible_eye(const Head& head, bool left) {
  const std::string side = left ? "_left" : "_right";
  const auto inner = head.landmarks.find("endocanthion" + side),
             outer = head.landmarks.find("exocanthion" + side);
  if (inner == head.landmarks.end() || outer == head.landmarks.end()) return {};
  const Vec3 middle = 0.5 * (inner->second + outer->second);
  const double width = (inner->second - outer->second).norm();
  const std::optional<Eye>& eye = head.eyes[left ? 0 : 1];
  if (eye && eye->radius > 0.28 * width && eye->radius < 1.1 * width &&
      (middle - eye->centre).norm() < width && middle.z() > eye->centre.z() - 0.1 * width)
    return eye;
  // The globe is 24 mm across behind a fissure of some 30 mm, its centre some 5 mm behind the canthi.
  Eye likely;
  likely.radius = 0.4 * width;
  likely.centre = middle - Vec3(0.0, 0.0, 0.16 * width);
  return likely;
}

}  // namespace fascia::check
