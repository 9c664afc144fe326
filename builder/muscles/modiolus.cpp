#include <algorithm>

#include "builder/muscles/parts.h"

namespace fascia::muscles {

std::vector<Modiolus> gather_modioli(const Carrier& smas, std::vector<Course>& courses, double radius) {
  std::vector<Modiolus> modioli;
  if (!(radius > 0.0)) return modioli;
  for (const anatomy::Side side : {anatomy::Side::left, anatomy::Side::right}) {
    std::vector<Course*> members;
    for (Course& course : courses)
      if (course.muscle.side == side && course.insertion.on == anatomy::Attachment::modiolus)
        members.push_back(&course);
    Vec3 middle = Vec3::Zero();
    int counted = 0;
    for (const Course* course : members)
      if (!course->insertion.is_sketched) {
        middle += course->insertion.centre();
        ++counted;
      }
    if (counted == 0) continue;
    const SurfacePoint place = smas.closest(middle / counted);
    Modiolus node;
    node.side = side;
    node.name = side == anatomy::Side::left ? "modiolus_left" : "modiolus_right";
    node.centre = smas.at(place);
    const Vec3 normal = smas.normal(place);
    const auto flat = [&](const Vec3& p) {
      return Vec3(p - node.centre - normal * normal.dot(p - node.centre));
    };
    double farthest = 0.0;
    for (const Course* course : members)
      if (!course->insertion.is_sketched)
        for (const Vec3& p : course->insertion.polygon)
          farthest = std::max(farthest, flat(p).norm());
    const double share = farthest > radius ? radius / farthest : 1.0;
    for (Course* course : members) {
      node.muscles.push_back(course->muscle.name);
      if (course->insertion.is_sketched) continue;
      for (Vec3& p : course->insertion.polygon)
        p -= (1.0 - share) * flat(p);
    }
    node.radius = radius;
    modioli.push_back(std::move(node));
  }
  return modioli;
}

}  // namespace fascia::muscles
