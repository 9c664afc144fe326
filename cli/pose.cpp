#include <memory>
#include <nlohmann/json.hpp>

#include "cli/common.h"
#include "cli/posed_output.h"
#include "cli/posing.h"
#include "geometry/error.h"
#include "geometry/text.h"

namespace fascia::cli {

namespace {

struct Request {
  std::filesystem::path rig, output, file;
  std::vector<std::string> set;
  std::string solver = "own", level;
};

void run(const Common& common, const Request& request) {
  check_output(request.output, {request.rig, request.file});
  const std::string extension = extension_of(request.output);
  if (extension != ".glb" && extension != ".obj" && extension != ".ply")
    throw Error("'" + request.output.string() + "': a pose is written as .glb, .obj or .ply");
  const auto values = activations(request.set, request.file);
  Face face(request.rig,
            {extension == ".glb" ? FASCIA_SPACE_MESH : FASCIA_SPACE_INPUT, request.solver, request.level});
  set_all(common, face, values);
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

void add_pose(const Command& tool, Common& common) {
  auto request = std::make_shared<Request>();
  const Command command = tool.command("pose", "Pose a rig statically and write the posed mesh");
  add_rig_argument(command, request->rig);
  add_set_options(command, request->set, request->file);
  add_solver_option(command, request->solver);
  add_level_option(command, request->level);
  command.option("-o,--output", &request->output, "Mesh to write: .glb, .obj or .ply").required();
  command.run([request, &common] { run(common, *request); });
}

}  // namespace fascia::cli
