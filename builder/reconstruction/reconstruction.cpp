#include "builder/reconstruction/reconstruction.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "geometry/error.h"

namespace fascia::reconstruction {

namespace {

// Diagonal of the box about a skull, with or without mandible, vault and some neck, metres.
constexpr double smallest = 0.12, largest = 0.50;
constexpr double little_bone = 0.6;  // of the generic skull

}  // namespace

double guess_unit(const TriangleMesh& scan) {
  const double diagonal = bounds(scan.vertices).size().norm();
  for (double metres : {1.0, 0.001, 0.01, 0.0254})
    if (diagonal * metres >= smallest && diagonal * metres <= largest) return metres;
  throw Error(
      "it is " + std::to_string(diagonal) +
      " units across, which is the size of a skull in no usual unit: say --units m, cm, mm or metres a unit");
}

std::string nearest_table(const anatomy::GenericAnatomy& anatomy, const Person& person,
                          std::vector<std::string>& warnings) {
  const auto known = [&](const anatomy::TissueDepthTable& table) {
    return std::array<std::pair<std::string, std::string>, 3>{
        {{person.sex, table.sex}, {person.age, table.age}, {person.ancestry, table.ancestry}}};
  };
  const anatomy::TissueDepthTable* best = nullptr;
  int most = -1;
  for (const anatomy::TissueDepthTable& table : anatomy.depth_tables) {
    int agreed = 0;
    bool contradicts = false;
    for (const auto& [asked, given] : known(table)) {
      agreed += !asked.empty() && asked == given;
      // A table of one group says nothing of a person of whom that is not known.
      contradicts = contradicts || (!given.empty() && given != "adult" && asked != given) ||
                    (given == "adult" && !asked.empty() && asked != given);
    }
    if (!contradicts && agreed > most) {
      best = &table;
      most = agreed;
    }
  }
  if (!best) best = &anatomy.depth_tables.front();
  constexpr std::array names = {"--sex", "--age", "--ancestry"};
  const auto words = known(*best);
  for (size_t k = 0; k < words.size(); ++k)
    if (!words[k].first.empty() && words[k].first != words[k].second)
      warnings.push_back(std::string(names[k]) + " " + words[k].first +
                         ": no tissue depth table tells it apart; '" + best->name + "' (" + best->population +
                         ") is taken; give a table with --depths FILE");
  return best->name;
}

std::vector<Vec3> Result::place(const skull::BoneMap& map, std::span<const Vec3> generic) const {
  std::vector<Vec3> out = map(generic);
  for (Vec3& p : out)
    p = placement(p);
  return out;
}

Result reconstruct(const anatomy::GenericAnatomy& anatomy, const TriangleMesh& scan, const Options& options) {
  if (!(options.tissue_scale > 0.1 && options.tissue_scale < 10))
    throw Error("--tissue-scale lies between 0.1 and 10");
  Result out;
  out.metres = options.metres > 0.0 ? options.metres : guess_unit(scan);
  SkullRegistration skull = register_skull(anatomy, scan, out.metres, options.bone);
  out.placement = skull.fit.placement;
  out.bone_residual = skull.mean_residual * out.placement.scale * out.metres;
  out.covered_share = skull.covered_share;
  out.warnings = std::move(skull.warnings);
  DepthChoice choice{options.table, options.tissue_scale, 0.0};
  out.mean = skin_map(anatomy, skull, out.metres, options.bone, choice, &out.landmarks);
  choice.deviations = -1.0;
  out.thin = skin_map(anatomy, skull, out.metres, options.bone, choice);
  choice.deviations = 1.0;
  out.thick = skin_map(anatomy, skull, out.metres, options.bone, choice);
  if (out.covered_share < little_bone) {
    const int share = static_cast<int>(std::lround(100 * out.covered_share));
    out.warnings.push_back(
        "only " + std::to_string(share) +
        " % of a skull's outer surface is there: skin over the rest follows the generic head");
  }
  return out;
}

}  // namespace fascia::reconstruction
