#include <Eigen/LU>
#include <memory>
#include <nlohmann/json.hpp>

#include "builder/rigging/gltf_source.h"
#include "cli/common.h"
#include "cli/landmark_units.h"
#include "cli/picture.h"
#include "cli/posing.h"
#include "formats/scene.h"
#include "formats/write.h"
#include "geometry/error.h"
#include "geometry/text.h"
#include "rig/read/read.h"

namespace fascia::cli {

namespace {

using Json = nlohmann::ordered_json;

struct ExportRequest {
  std::filesystem::path rig, output;
  std::string part;
};

/// Brings the rig's metres back to the input's axes and units.
class ToInput {
 public:
  explicit ToInput(const rig::RigFile& file)
      : map_(file.rig.input_to_metres.cast<double>().inverse()), offset_(rigging::input_offset(file.source)) {
    map_.topRightCorner<3, 1>() += offset_;
  }
  Vec3 operator()(const rig::Vec3f& p) const { return transform_point(map_, p.cast<double>()); }
  double scale() const { return map_.topLeftCorner<3, 1>().norm(); }
  const Vec3& offset() const { return offset_; }

 private:
  Mat4 map_;
  Vec3 offset_;
};

formats::NamedSurface surface_of(const std::string& name, const rig::Surface& surface,
                                 const ToInput& to_input) {
  formats::NamedSurface out{name, {}, Vec3(0.85, 0.82, 0.72)};
  for (const auto& p : surface.positions)
    out.mesh.vertices.push_back(to_input(p));
  for (const auto& t : surface.triangles)
    out.mesh.triangles.push_back({static_cast<int>(t[0]), static_cast<int>(t[1]), static_cast<int>(t[2])});
  return out;
}

void add_face_parts(formats::Drawing& drawing, const ExportRequest& request, const Vec3& offset,
                    const std::function<bool(const std::string&)>& wanted) {
  const Face face(request.rig, {FASCIA_SPACE_INPUT, "own", ""});
  for (size_t m = 0; m < face.meshes().size(); ++m) {
    if (!wanted(face.meshes()[m].part)) continue;
    formats::NamedSurface surface{
        face.meshes()[m].name, {{}, face.meshes()[m].triangles}, Vec3(0.86, 0.69, 0.59)};
    const auto flat = face.positions(m);
    for (size_t i = 0; i + 2 < flat.size(); i += 3)
      surface.mesh.vertices.push_back(Vec3(flat[i], flat[i + 1], flat[i + 2]) + offset);
    drawing.surfaces.push_back(std::move(surface));
  }
}

void add_muscles(formats::Drawing& drawing, const rig::Rig& rig, const ToInput& to_input) {
  for (const rig::Muscle& muscle : rig.muscles) {
    formats::NamedLines bundle{muscle.name, {}, view::muscle_colour(muscle.name)};
    for (size_t f = 0; f + 1 < muscle.fibre_offsets.size(); ++f) {
      std::vector<Vec3> line;
      for (uint32_t p = muscle.fibre_offsets[f]; p < muscle.fibre_offsets[f + 1]; ++p)
        line.push_back(to_input(muscle.points[p]));
      bundle.lines.push_back(std::move(line));
    }
    drawing.lines.push_back(std::move(bundle));
  }
}

void write_landmarks(const std::filesystem::path& output, const rig::Rig& rig, const ToInput& to_input) {
  if (extension_of(output) != ".json")
    throw Error("'" + output.string() + "': landmarks are written as .json");
  Json json;
  json["units"] = landmark_units(1.0 / to_input.scale());
  const auto triple = [&](const rig::Vec3f& p) {
    const Vec3 q = to_input(p);
    return Json::array({q[0], q[1], q[2]});
  };
  json["landmarks"] = Json::object();
  for (const rig::Landmark& landmark : rig.skull.landmarks)
    json["landmarks"][landmark.name] = {{"skin", triple(landmark.skin)},
                                        {"bone", triple(landmark.bone)},
                                        {"depth_mm", 1e3 * landmark.depth},
                                        {"confidence", landmark.confidence}};
  formats::write_text(output, json.dump(1) + "\n");
}

void run(const Common& common, const ExportRequest& request) {
  check_output(request.output, {request.rig});
  const rig::RigFile file = rig::read(formats::read_bytes(request.rig), request.rig.string());
  const rig::Rig& rig = file.rig;
  const ToInput to_input(file);
  const bool all = request.part == "all";
  if (request.part == "landmarks") {
    write_landmarks(request.output, rig, to_input);
  } else {
    formats::Drawing drawing;
    const auto is = [&](const char* part) { return all || request.part == part; };
    if (is("skin"))
      add_face_parts(drawing, request, to_input.offset(),
                     [](const std::string& part) { return part == "skin"; });
    if (is("eyes"))
      add_face_parts(drawing, request, to_input.offset(),
                     [](const std::string& part) { return part == "eye_left" || part == "eye_right"; });
    if (is("cranium")) drawing.surfaces.push_back(surface_of("cranium", rig.skull.cranium, to_input));
    if (is("mandible")) drawing.surfaces.push_back(surface_of("mandible", rig.skull.mandible, to_input));
    if (is("teeth")) {
      drawing.surfaces.push_back(surface_of("teeth_upper", rig.skull.teeth_upper, to_input));
      drawing.surfaces.push_back(surface_of("teeth_lower", rig.skull.teeth_lower, to_input));
    }
    if (is("smas")) drawing.surfaces.push_back(surface_of("smas", rig.smas.surface, to_input));
    if (is("muscles")) add_muscles(drawing, rig, to_input);
    std::erase_if(drawing.surfaces, [](const auto& surface) { return surface.mesh.empty(); });
    if (drawing.surfaces.empty() && drawing.lines.empty())
      throw Error("'" + request.rig.string() + "' has no " + request.part);
    formats::write(request.output, drawing);
  }
  common.say("wrote " + request.output.string());
  common.report({{"output", request.output.string()}, {"part", request.part}});
}

}  // namespace

void add_export(const Command& tool, Common& common) {
  auto request = std::make_shared<ExportRequest>();
  const Command command = tool.command("export", "Export one part of a rig as a mesh");
  add_rig_argument(command, request->rig);
  command.option("--part", &request->part, "What to write")
      .required()
      .one_of({"skin", "cranium", "mandible", "teeth", "eyes", "smas", "muscles", "landmarks", "all"})
      .value("PART");
  command.option("-o,--output", &request->output, "File to write: .ply, .obj, .stl or .glb; landmarks .json")
      .required();
  command.run([request, &common] { run(common, *request); });
}

}  // namespace fascia::cli
