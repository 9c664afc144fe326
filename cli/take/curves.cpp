#include "cli/take/curves.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <set>

#include "anatomy/anatomy.h"
#include "formats/scene.h"
#include "geometry/error.h"
#include "geometry/text.h"

namespace fascia::cli {

Curves::Curves(const std::filesystem::path& path, double frames_per_second, double time_unit) {
  const std::vector<uint8_t> bytes = formats::read_bytes(path);
  const fascia_curves_options options = {sizeof options, 0, frames_per_second, time_unit};
  fascia_curves* curves = nullptr;
  check(fascia_curves_load_as(bytes.data(), bytes.size(), &options, &curves), "'" + path.string() + "'");
  curves_.reset(curves);
  info_.struct_size = sizeof info_;
  check(fascia_curves_get_info(curves, &info_), "'" + path.string() + "'");
  names_.assign(info_.names, info_.names + info_.count);
  to_ = length_ = info_.duration;
}

void Curves::add(Curves layer) {
  length_ = std::max(length_, layer.length_);
  to_ = length_;
  layers_.push_back(std::move(layer));
}

void Curves::trim(double from, double to) {
  if (to < 0.0) to = length_;
  if (!(from >= 0.0 && from <= to && to <= length_ + 1e-6))
    throw Error("the curves last " + std::to_string(length_) +
                " s: --from and --to must name a piece of that, --from before --to");
  from_ = from;
  to_ = std::min(to, length_);
}

std::vector<std::string> Curves::unmatched(const Face& face) const {
  std::vector<uint8_t> matched(names_.size());
  uint32_t count = 0;
  check(fascia_curves_match(curves_.get(), face.asset(), &count, matched.data()), "curves");
  std::vector<std::string> names;
  for (size_t i = 0; i < names_.size(); ++i)
    if (!matched[i]) names.push_back(names_[i]);
  return names;
}

void Curves::apply(double seconds, const Face& face) const {
  for (const auto& [name, value] : held_)
    check(fascia_face_set(face.handle(), name.c_str(), static_cast<float>(value)), name);
  const double now = std::min(from_ + seconds, to_);
  check(fascia_curves_apply(curves_.get(), now, static_cast<float>(weight_), face.handle()), "curves");
  for (const Curves& layer : layers_)
    layer.apply(now, face);
}

std::array<float, 4> Curves::head(double seconds) const {
  std::array<float, 4> quaternion = {};
  check(fascia_curves_head(curves_.get(), std::min(from_ + seconds, to_), quaternion.data()), "curves");
  return quaternion;
}

bool Curves::head_moves() const {
  constexpr double step = 1.0 / 30.0, turned = 1e-6;
  for (double seconds = 0.0; turns_head() && seconds <= duration() + step; seconds += step)
    if (const auto q = head(seconds); std::abs(q[0]) + std::abs(q[1]) + std::abs(q[2]) > turned) return true;
  return false;
}

namespace {

/// A name without case and separators, and without what is before the last separator of prefixes.
std::string bare(const std::string& name) {
  const size_t prefix = name.find_last_of(".:|/");
  std::string letters;
  for (const char c : lower_case(prefix == std::string::npos ? name : name.substr(prefix + 1)))
    if (c != '_' && c != '-' && c != ' ') letters += c;
  return letters;
}

/// Names of other programs, which may stand beside the rig's own for the same thing: avatars have both
/// jawOpen and mouthOpen.
std::set<std::string> names_of_other_programs() {
  std::set<std::string> names;
  const nlohmann::json table = nlohmann::json::parse(anatomy::embedded_file("aliases.json"));
  for (const nlohmann::json& vocabulary : table.at("vocabularies"))
    for (const auto& [name, targets] : vocabulary.at("names").items())
      names.insert(bare(name));
  return names;
}

/// Names that the rig knows although they drive nothing, since another name does. Throws fascia::Error where
/// it is the same name in another spelling; returns those of other programs, which are left out.
std::vector<std::string> repeated(const std::vector<std::string>& unmatched, const Face& face,
                                  const std::filesystem::path& path) {
  std::vector<std::string> known;
  for (const std::string& name : unmatched)
    if (float value = 0.0F; fascia_face_get(face.handle(), name.c_str(), &value) == FASCIA_OK)
      known.push_back(name);
  if (known.empty()) return known;
  const std::set<std::string> others = names_of_other_programs();
  for (const std::string& name : known)
    if (!others.contains(bare(name)))
      throw Error("'" + path.string() + "': '" + name +
                  "' is there twice, once in another spelling, and would count twice: take one of them out");
  return known;
}

}  // namespace

MatchedNames match(const Common& common, const Curves& curves, const Face& face,
                   const std::filesystem::path& path) {
  MatchedNames names;
  names.unmatched = curves.unmatched(face);
  const std::set<std::string> unmatched(names.unmatched.begin(), names.unmatched.end());
  for (const std::string& name : curves.names())
    if (unmatched.count(name) == 0) names.matched.push_back(name);
  const std::string kind = extension_of(path);
  // Of the meshes of one avatar, which bear the same names, the first speaks.
  if (kind != ".glb" && kind != ".gltf")
    for (const std::string& name : repeated(names.unmatched, face, path)) {
      common.warn("'" + path.filename().string() + "': '" + name +
                  "' means what another of its columns does, and is left out");
      std::erase(names.unmatched, name);
    }
  for (const std::string& note : curves.notes())
    common.warn("'" + path.filename().string() + "': " + note);
  if (names.matched.empty())
    throw Error("'" + path.string() + "': none of its " + std::to_string(curves.names().size()) +
                " curves has a name that the rig knows; 'fascia info --channels' lists the rig's names, "
                "'fascia info --names' those of other programs");
  if (!names.unmatched.empty()) {
    std::string list;
    for (size_t i = 0; i < names.unmatched.size() && i < 6; ++i)
      list += (i > 0 ? ", " : "") + names.unmatched[i] + face.suggestion(names.unmatched[i]);
    if (names.unmatched.size() > 6) list += " and " + std::to_string(names.unmatched.size() - 6) + " more";
    common.warn(std::to_string(names.unmatched.size()) + " of " + std::to_string(curves.names().size()) +
                " curves drive nothing in the rig: " + list);
  }
  return names;
}

}  // namespace fascia::cli
