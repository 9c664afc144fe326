#include "anatomy/checks.h"
#include "anatomy/fields.h"

namespace fascia::anatomy {
namespace {

std::optional<double> number_if_there(const Fields& fields, const char* key) {
  if (!fields.has(key)) return {};
  return fields.number(key);
}

CheckBound bound_of(const Fields& fields, std::string row) {
  CheckBound bound;
  bound.row = std::move(row);
  bound.unit = fields.text("unit");
  bound.scale = fields.text_or("scale", "");
  bound.least = number_if_there(fields, "least");
  bound.most = number_if_there(fields, "most");
  bound.remedy = fields.text("remedy");
  bound.source = fields.text("source");
  if (!bound.least && !bound.most) fields.fail("\"least\" or \"most\" must be there");
  if (bound.least && bound.most && *bound.least > *bound.most) fields.fail("\"least\" lies above \"most\"");
  return bound;
}

CheckPose pose_of(const Fields& fields) {
  CheckPose pose;
  pose.name = fields.text("name");
  pose.area = fields.text_or("area", "face");
  pose.is_quick = fields.has("quick") && fields.flag("quick");
  pose.is_symmetric = fields.has("symmetric") && fields.flag("symmetric");
  for (const auto& [name, value] : fields.raw("weights").items()) {
    if (!value.is_number()) fields.fail("the weight of " + name + " is not a number");
    pose.weights.emplace_back(name, value.get<double>());
  }
  return pose;
}

Checks checks_of(const DataFiles& files) {
  const Json document = files.json("checks.json");
  const Fields root(document, "checks.json"), adult = root.object("adult");
  Checks checks;
  checks.adult_face = adult.number("face_mm") * 1e-3;
  checks.adult_mouth = adult.number("mouth_mm") * 1e-3;
  checks.adult_eye = adult.number("eye_mm") * 1e-3;
  for (const Fields& entry : root.list("poses"))
    checks.poses.push_back(pose_of(entry));
  for (const Fields& entry : root.list("motions")) {
    CheckMotion motion;
    motion.pose = entry.text("pose");
    motion.landmark = entry.text("landmark");
    motion.direction = entry.text("direction");
    motion.bound = bound_of(entry, entry.text("name"));
    checks.motions.push_back(std::move(motion));
  }
  for (const Fields& entry : root.list("bounds"))
    checks.bounds.push_back(bound_of(entry, entry.text("name")));
  for (const CheckMotion& motion : checks.motions) {
    bool is_known = false;
    for (const CheckPose& pose : checks.poses)
      is_known = is_known || pose.name == motion.pose;
    if (!is_known) root.fail("the motion " + motion.bound.row + " is of no pose of the list");
  }
  return checks;
}

}  // namespace

const CheckBound& Checks::bound(const std::string& row) const {
  for (const CheckBound& entry : bounds)
    if (entry.row == row) return entry;
  throw Error("checks.json has no bound '" + row + "'; add it, or put the file back as it came");
}

Checks load_checks() {
  return checks_of(DataFiles());
}

Checks load_checks(const std::filesystem::path& directory) {
  return checks_of(DataFiles(directory));
}

}  // namespace fascia::anatomy
