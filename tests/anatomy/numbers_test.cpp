#include <gtest/gtest.h>

#include <cstring>
#include <string>
#include <vector>

#include "anatomy/fields.h"
#include "geometry/error.h"

namespace fascia::anatomy {
namespace {

using nlohmann::literals::operator""_json_pointer;

/// Everything that is a number in an anatomy, in order.
class Numbers {
 public:
  explicit Numbers(const GenericAnatomy& anatomy) {
    for (const Landmark& l : anatomy.landmarks)
      add(l.skin.value_or(Vec3::Zero()), l.normal, l.tangent, l.bone.value_or(Vec3::Zero()), l.bone_normal);
    for (const Curve& curve : anatomy.curves)
      add(curve.points);
    for (const TissueDepthTable& table : anatomy.depth_tables)
      for (const TissueDepth& depth : table.depths)
        add(depth.mean, depth.deviation);
    for (const Muscle& muscle : anatomy.muscles)
      add(muscle);
    add(anatomy.tissue);
    add(anatomy.mechanics);
    for (const Actuator& actuator : anatomy.actuators)
      add(actuator.minimum, actuator.maximum, actuator.rest);
    for (const ExpressionSet& set : anatomy.expression_sets) {
      add(set.response_weights);
      for (const Expression& expression : set.expressions) {
        for (const auto& [name, weight] : expression.weights)
          add(weight);
        add(expression.response);
      }
    }
  }
  bool operator==(const Numbers&) const = default;

 private:
  void add(double number) { all_.push_back(number); }
  void add(const Vec3& point) { all_.insert(all_.end(), point.begin(), point.end()); }
  template <class Entry>
  void add(const std::vector<Entry>& entries) {
    for (const Entry& entry : entries)
      add(entry);
  }
  void add(const Muscle& m) {
    add(m.origin.polygon, m.insertion.polygon, m.waypoints, m.depth_fraction, m.peak_shortening,
        m.cross_section, static_cast<double>(m.bundles), m.prevalence);
    if (m.band) add(m.band->inner, m.band->outer, m.band->begin_angle, m.band->end_angle);
    for (const Variant& variant : m.variants)
      add(variant.prevalence, variant.width, variant.insertion_offset);
    for (const int unit : m.action_units)
      add(static_cast<double>(unit));
  }
  void add(const Zone& zone) { add(zone.polygon, zone.value, zone.falloff); }
  void add(const RetainingLigament& l) { add(l.bone, l.skin, l.stiffness); }
  void add(const SmasDepth& depth) { add(depth.fraction, depth.free_depth); }
  void add(const Tissue& t) {
    add(t.skin_attachment, t.glide, t.smas_depths, t.skin_attachments, t.gliding_planes, t.ligaments);
  }
  void add(const FacePlace& place) {
    for (const FacePlace::Part& part : place.parts)
      add(part.share);
    add(place.offset, place.radius);
  }
  void add(const AttachmentRegion& region) { add(region.place, region.bone, region.skin); }
  void add(const Hold& hold) { add(hold.place, hold.factor); }
  /// A section holds nothing but numbers.
  template <class Section>
  void add_section(const Section& section) {
    static_assert(std::is_trivially_copyable_v<Section> && sizeof(Section) % sizeof(double) == 0);
    std::vector<double> numbers(sizeof(Section) / sizeof(double));
    std::memcpy(numbers.data(), static_cast<const void*>(&section), sizeof(Section));
    add(numbers);
  }
  void add(const Mechanics& m) {
    add_section(m.tissue), add_section(m.skin), add_section(m.smas), add_section(m.fat);
    add_section(m.glide), add_section(m.attachment), add_section(m.lids), add_section(m.lips);
    add_section(m.vestibule), add_section(m.fibres), add_section(m.ligaments), add_section(m.depths);
    add_section(m.jaw_influence), add_section(m.region), add_section(m.jaw), add_section(m.contact);
    add_section(m.dynamics), add_section(m.muscles), add_section(m.smas_shape);
    add(m.attachment_regions, m.holds);
  }
  template <class First, class... Rest>
  requires(sizeof...(Rest) > 0) void add(const First& first, const Rest&... rest) {
    add(first);
    (add(rest), ...);
  }

  std::vector<double> all_;
};

using Pointer = Json::json_pointer;

void find_numbers(const Json& value, const Pointer& at, std::vector<Pointer>& found) {
  if (value.is_number()) found.push_back(at);
  if (value.is_object())
    for (const auto& [key, child] : value.items())
      find_numbers(child, at / key, found);
  if (value.is_array())
    for (size_t i = 0; i < value.size(); ++i)
      find_numbers(value[i], at / i, found);
}

/// A document that holds one entry of each of its lists, so that it is read quickly.
struct Piece {
  std::string file;
  Json document;
};

/// Reads a piece into an anatomy that has the landmarks and muscles which others refer to.
using Reader = void (*)(const DataFiles&, GenericAnatomy&);

Numbers read(const Piece& piece, Reader reader, const GenericAnatomy& others) {
  GenericAnatomy anatomy = others;
  reader(DataFiles(std::map<std::string, std::string>{{piece.file, piece.document.dump()}}), anatomy);
  return Numbers(anatomy);
}

/// Changes a number by a tenth; a range, which only refuses, so that its value lies outside.
void change(Json& document, const Pointer& at) {
  Json& number = document[at];
  const Pointer range = at.parent_pointer();
  if (!range.empty() && range.back() == "range") {
    Json& value = document[range.parent_pointer() / "value"];
    const double low = value.is_array() ? value[0].get<double>() : value.get<double>();
    const double high = value.is_array() ? value[1].get<double>() : value.get<double>();
    number = at.back() == "0" ? low + 0.01 * std::abs(low) + 1e-6 : high - 0.01 * std::abs(high) - 1e-6;
    return;
  }
  const double value = number.get<double>();
  number = value == 0.0 ? 0.1 : 1.1 * value;
}

/// How many numbers of the piece were tried.
int expect_each_is_read(const Piece& piece, Reader reader, const GenericAnatomy& others) {
  const Numbers before = read(piece, reader, others);
  std::vector<Pointer> numbers;
  find_numbers(piece.document, Pointer(), numbers);
  for (const Pointer& at : numbers) {
    Piece changed = piece;
    change(changed.document, at);
    bool is_seen = false;
    try {
      is_seen = !(read(changed, reader, others) == before);
    } catch (const Error&) {
      is_seen = true;  // refused
    }
    EXPECT_TRUE(is_seen) << piece.file << " " << at << ": nothing reads " << piece.document[at];
  }
  return static_cast<int>(numbers.size());
}

/// One piece for each entry of the lists `lists` of `file`; the rest of the file stays with the first.
std::vector<Piece> pieces_of(const std::string& file, const std::vector<Pointer>& lists) {
  const Json whole = Json::parse(embedded_file(file));
  Json rest = whole;
  for (const Pointer& list : lists)
    rest[list] = Json::array();
  if (lists.empty()) return {{file, whole}};
  std::vector<Piece> pieces;
  for (const Pointer& list : lists)
    for (const Json& entry : whole[list]) {
      Json document = rest;
      document[list].push_back(entry);
      pieces.push_back({file, document});
    }
  return pieces;
}

struct File {
  const char* name;
  std::vector<Pointer> lists;
  Reader reader;
  int least;  ///< numbers it has at least
};

class EveryNumber : public testing::TestWithParam<File> {};

TEST_P(EveryNumber, IsReadOrRefused) {
  GenericAnatomy others = load_generic();
  others.head.clear(), others.skull.clear();
  const std::string name = GetParam().name;
  if (name == "landmarks.json") others.landmarks.clear(), others.curves.clear();
  if (name == "tissue_depths.json") others.depth_tables.clear();
  if (name == "tissue.json") others.tissue = {};
  if (name == "mechanics.json") others.mechanics = {};
  if (name == "muscles.json") others.muscles.clear();
  others.actuators.clear(), others.wholes.clear(), others.expression_sets.clear();
  int numbers = 0;
  for (const Piece& piece : pieces_of(name, GetParam().lists))
    numbers += expect_each_is_read(piece, GetParam().reader, others);
  EXPECT_GE(numbers, GetParam().least);
}

INSTANTIATE_TEST_SUITE_P(
    Files, EveryNumber,
    testing::Values(
        File{"landmarks.json", {"/landmarks"_json_pointer, "/curves"_json_pointer}, load_landmarks, 2000},
        File{"tissue_depths.json", {"/tables"_json_pointer}, load_tissue_depths, 50},
        File{"muscles.json", {"/muscles"_json_pointer}, load_muscles, 1500},
        File{"tissue.json",
             {"/smas_depths/sites"_json_pointer, "/skin_attachments"_json_pointer,
              "/gliding_planes"_json_pointer, "/ligaments"_json_pointer},
             load_tissue,
             1000},
        File{"mechanics.json", {}, load_mechanics, 580},
        File{"actuators.json", {"/others"_json_pointer}, load_actuation, 20},
        File{"expressions/arkit.json", {"/expressions"_json_pointer}, load_actuation, 200},
        File{"expressions/facs.json", {"/expressions"_json_pointer}, load_actuation, 50},
        File{"expressions/visemes.json", {"/expressions"_json_pointer}, load_actuation, 50},
        File{"expressions/vrm.json", {"/expressions"_json_pointer}, load_actuation, 20},
        File{"expressions/smiles.json", {"/expressions"_json_pointer}, load_actuation, 5}),
    [](const auto& file) {
      std::string name = file.param.name;
      name = name.substr(name.find('/') == std::string::npos ? 0 : name.find('/') + 1);
      return name.substr(0, name.find('.'));
    });

}  // namespace
}  // namespace fascia::anatomy
