#include <CLI/CLI.hpp>
#include <chrono>
#include <memory>

#include "cli/common.h"
#include "cli/gltf_edit.h"
#include "cli/motion.h"
#include "cli/rig_build.h"
#include "formats/scene.h"
#include "geometry/error.h"
#include "rig/write/write.h"

namespace fascia::cli {

namespace {

struct Request {
  std::filesystem::path rig, output;
  std::string shapes = "arkit", solver = "own", level;
};

/// Names of the targets, and what to set for each.
std::vector<std::pair<std::string, std::string>> targets(const Face& face, const std::string& shapes) {
  std::vector<std::pair<std::string, std::string>> list;
  if (shapes == "muscles") {
    for (const std::string& name : face.channel_names())
      list.emplace_back(name, name);
  } else {
    const std::string set = shapes == "visemes" ? "viseme" : shapes;
    for (const std::string& member : face.set_members(set))
      list.emplace_back(member, set + ":" + member);
  }
  return list;
}

void run(const Common& common, const Request& request) {
  const auto started = std::chrono::steady_clock::now();
  const std::vector<std::string> names =
      bake_file(common, request.rig, request.shapes, request.output, request.solver, request.level);
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - started).count();
  common.say("wrote " + request.output.string() + ": " + std::to_string(names.size()) + " shapes in " +
             std::to_string(seconds).substr(0, 5) + " s");
  common.report({{"output", request.output.string()}, {"shapes", names}, {"seconds", seconds}});
}

}  // namespace

std::vector<std::string> bake_file(const Common& common, const std::filesystem::path& rig,
                                   const std::string& shapes, const std::filesystem::path& output,
                                   const std::string& solver, const std::string& level) {
  check_output(output, {rig});
  if (output.extension() != ".glb")
    throw Error("'" + output.string() + "': baked shapes are written as .glb");
  Face face(rig, {FASCIA_SPACE_MESH, solver, level});
  const BakedShapes baked = bake_shapes(common, face, targets(face, shapes));
  const std::vector<uint8_t> bytes = formats::read_bytes(rig);
  GltfEdit edit(rig::original(rig::glb_source(bytes, rig.string())));
  std::vector<std::string> warnings;
  gltf::add_morph_targets(edit, baked.names, baked.shapes, {}, &warnings);
  for (const std::string& warning : warnings)
    common.warn(warning);
  const std::vector<uint8_t> out = edit.bytes();
  formats::write_bytes(output, out.data(), out.size());
  return baked.names;
}

void add_bake(CLI::App& app, Common& common) {
  auto request = std::make_shared<Request>();
  CLI::App* command = app.add_subcommand("bake", "Bake simulated shapes into morph targets");
  command->add_option("RIG", request->rig, "Rig (.glb)")->required();
  command->add_option("--shapes", request->shapes, "Which shapes")
      ->check(CLI::IsMember({"arkit", "muscles", "visemes"}));
  command->add_option("--solver", request->solver, "Solver")
      ->check(CLI::IsMember({"own", "reference", "bullet"}));
  command->add_option("--level", request->level, "Level of detail: low, medium or high");
  command->add_option("-o,--output", request->output, "File to write (.glb)")->required();
  command->callback([request, &common] { run(common, *request); });
}

}  // namespace fascia::cli
