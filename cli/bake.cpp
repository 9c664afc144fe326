#include <CLI/CLI.hpp>
#include <chrono>
#include <memory>

#include "cli/bake_file.h"
#include "cli/common.h"

namespace fascia::cli {

namespace {

void run(const Common& common, const BakeRequest& request) {
  const auto started = std::chrono::steady_clock::now();
  const BakeFigures figures = bake_file(common, request);
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - started).count();
  double megabytes = 0.0;
  for (const double shape : figures.megabytes)
    megabytes += shape;
  char cost[64] = "";
  if (!figures.megabytes.empty())
    std::snprintf(cost, sizeof cost, ", %.2f MB a shape",
                  megabytes / static_cast<double>(figures.megabytes.size()));
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
                 {"megabytes", megabytes},
                 {"megabytes_by_shape", by_shape},
                 {"seconds", seconds}});
}

}  // namespace

void add_bake(CLI::App& app, Common& common) {
  auto request = std::make_shared<BakeRequest>();
  CLI::App* command = app.add_subcommand("bake", "Bake simulated shapes into morph targets");
  command->add_option("RIG", request->rig, "Rig (.glb)")->required();
  command
      ->add_option(
          "--shapes", request->sets,
          "Which shapes, one set or several: arkit, visemes, vrm, faces, au, muscles (every channel), or "
          "another of the rig's vocabularies")
      ->delimiter(',')
      ->capture_default_str();
  command
      ->add_option("--format", request->format,
                   "glb, obj-sequence (a folder) or pc2 (default: by the output)")
      ->check(CLI::IsMember({"glb", "obj-sequence", "pc2"}));
  command->add_flag(
      "--correctives", request->correctives,
      "Also what pairs of ARKit shapes lack together, as A_B, for a weight of A times B (default: no)");
  command->add_flag("--replace", request->replaces,
                    "A shape takes the place of a morph target of its name (default: it gets another name)");
  command->add_flag("--keep-rig", request->keeps_rig, "Keep the FASCIA extensions in the file (default: no)");
  command->add_option("--solver", request->solver, "Solver")
      ->check(CLI::IsMember({"own", "reference", "bullet"}))
      ->capture_default_str();
  command->add_option("--level", request->level,
                      "Level of detail: low, medium or high (default: the rig's finest)");
  command->add_option("-o,--output", request->output, "File to write (.glb, .pc2), or folder")->required();
  command->callback([request, &common] { run(common, *request); });
}

}  // namespace fascia::cli
