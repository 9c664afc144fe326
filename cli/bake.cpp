#include <algorithm>
#include <chrono>
#include <memory>
#include <nlohmann/json.hpp>
#include <numeric>

#include "cli/bake_file.h"
#include "cli/common.h"

namespace fascia::cli {

namespace {

void run(const Common& common, const BakeRequest& request) {
  const auto started = std::chrono::steady_clock::now();
  const BakeFigures figures = bake_file(common, request);
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - started).count();
  char cost[64] = "";
  if (const auto [least, most] = std::minmax_element(figures.megabytes.begin(), figures.megabytes.end());
      least != figures.megabytes.end())
    std::snprintf(cost, sizeof cost, ", %.2f to %.2f MB a shape", *least, *most);
  char time[32];
  std::snprintf(time, sizeof time, "%.2f", seconds);
  common.say("wrote " + request.output.string() + ": " + std::to_string(figures.names.size()) +
             " shapes in " + time + " s" + cost);
  std::vector<std::string> files;
  for (const std::filesystem::path& path : figures.files)
    files.push_back(path.string());
  nlohmann::ordered_json by_shape = nlohmann::ordered_json::object();
  for (size_t s = 0; s < figures.megabytes.size(); ++s)
    by_shape[figures.names[s]] = figures.megabytes[s];
  common.report({{"output", request.output.string()},
                 {"files", files},
                 {"shapes", figures.names},
                 {"megabytes", std::accumulate(figures.megabytes.begin(), figures.megabytes.end(), 0.0)},
                 {"megabytes_by_shape", by_shape},
                 {"seconds", seconds}});
}

}  // namespace

void add_bake(const Command& tool, Common& common) {
  auto request = std::make_shared<BakeRequest>();
  const Command command = tool.command("bake", "Bake simulated shapes into morph targets");
  add_rig_argument(command, request->rig);
  command
      .option(
          "--shapes", &request->sets,
          "Shapes to bake, one set or several separated by commas: arkit, visemes, vrm, faces, au, muscles "
          "(every "
          "channel), or another of the rig's vocabularies")
      .separated_by_commas()
      .value("SET,...");
  command.option("--format", &request->format, "What to write; obj-sequence is a folder")
      .one_of({"glb", "obj-sequence", "pc2"})
      .default_text("by the output's name");
  command.flag("--correctives", request->correctives,
               "Also corrective shapes A_B for pairs of ARKit shapes, for a weight of A times B");
  command.flag("--replace", request->replaces,
               "Replace morph targets of the same names instead of renaming the shapes");
  command.flag("--keep-rig", request->keeps_rig, "Keep the FASCIA extensions in the file");
  add_solver_option(command, request->solver);
  add_level_option(command, request->level);
  command.option("-o,--output", &request->output, "File to write (.glb, .pc2), or folder").required();
  command.run([request, &common] { run(common, *request); });
}

}  // namespace fascia::cli
