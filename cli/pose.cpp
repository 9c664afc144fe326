#include <CLI/CLI.hpp>
#include <memory>

#include "cli/common.h"
#include "cli/posed_output.h"
#include "cli/posing.h"
#include "geometry/error.h"

namespace fascia::cli {

namespace {

struct Request {
  std::filesystem::path rig, output, file;
  std::vector<std::string> set;
  std::string solver = "own", level;
};

void run(const Common& common, const Request& request) {
  check_output(request.output, {request.rig, request.file});
  const std::string extension = request.output.extension().string();
  if (extension != ".glb" && extension != ".obj" && extension != ".ply")
    throw Error("'" + request.output.string() + "': a pose is written as .glb, .obj or .ply");
  const auto values = activations(request.set, request.file);
  Face face(request.rig,
            {extension == ".glb" ? FASCIA_SPACE_MESH : FASCIA_SPACE_INPUT, request.solver, request.level});
  for (const auto& [name, value] : values)
    face.set(name, value);
  face.pose();
  if (extension == ".glb")
    write_posed_glb(request.rig, face, request.output);
  else
    write_posed_mesh(request.rig, face, request.output);
  common.say("wrote " + request.output.string());
  nlohmann::ordered_json report = {{"output", request.output.string()}, {"solver", request.solver}};
  for (const auto& [name, value] : values)
    report["activations"][name] = value;
  common.report(report);
}

}  // namespace

void add_pose(CLI::App& app, Common& common) {
  auto request = std::make_shared<Request>();
  CLI::App* command = app.add_subcommand("pose", "Pose a rig statically and write the posed mesh");
  command->add_option("RIG", request->rig, "Rig (.glb)")->required();
  command->add_option("--set", request->set, "NAME=VALUE: an actuator, arkit:NAME, au:N or viseme:NAME")
      ->take_all();
  command->add_option("--activations", request->file, "Activations (.json)");
  command->add_option("--solver", request->solver, "Solver")
      ->check(CLI::IsMember({"own", "reference", "bullet"}));
  command->add_option("--level", request->level, "Level of detail: low, medium or high");
  command->add_option("-o,--output", request->output, "Mesh to write: .glb, .obj or .ply")->required();
  command->callback([request, &common] { run(common, *request); });
}

}  // namespace fascia::cli
