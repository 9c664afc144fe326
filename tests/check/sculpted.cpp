#include "tests/check/sculpted.h"

#include <cstdio>

#include "anatomy/anatomy.h"
#include "bench/expressions/measured_shapes.h"
#include "builder/rigging/find_landmarks.h"
#include "formats/scene.h"
#include "geometry/error.h"
#include "tests/paths/paths.h"

namespace fascia::testing {
namespace {

/// Displacements of every part's vertices by shape, rig frame.
using Shapes = std::map<std::string, check::Shape>;

std::string arkit_name(const std::string& name) {
  if (name.ends_with("_L")) return name.substr(0, name.size() - 2) + "Left";
  if (name.ends_with("_R")) return name.substr(0, name.size() - 2) + "Right";
  return name;
}

check::Player player_of(const check::Head& head, Shapes shapes) {
  return [rest = check::rest_shape(head),
          shapes = std::move(shapes)](const check::Weights& weights) -> std::optional<check::Shape> {
    check::Shape now = rest;
    for (const auto& [name, value] : weights) {
      const auto at = shapes.find(name);
      if (at == shapes.end()) return std::nullopt;
      for (size_t p = 0; p < now.size(); ++p)
        for (size_t v = 0; v < at->second[p].size(); ++v)
          now[p][v] += value * at->second[p][v];
    }
    return now;
  };
}

/// What of a prepared mesh is one part, and which of its vertices that are.
struct Piece {
  check::Part part;
  std::vector<size_t> vertices;
};

std::vector<Piece> pieces_of(const prepare::PreparedMesh& mesh) {
  std::map<prepare::Part, Piece> pieces;
  std::vector<int> index(mesh.positions.size(), -1);
  for (size_t v = 0; v < index.size(); ++v) {
    Piece& piece = pieces[mesh.parts[v]];
    index[v] = static_cast<int>(piece.vertices.size());
    piece.vertices.push_back(v);
    piece.part.mesh.vertices.push_back(mesh.positions[v]);
  }
  for (const Triangle& t : mesh.triangles) {
    const prepare::Part part = mesh.parts[static_cast<size_t>(t[0])];
    if (mesh.parts[static_cast<size_t>(t[1])] != part || mesh.parts[static_cast<size_t>(t[2])] != part)
      continue;
    pieces[part].part.mesh.triangles.push_back({index[static_cast<size_t>(t[0])],
                                                index[static_cast<size_t>(t[1])],
                                                index[static_cast<size_t>(t[2])]});
  }
  std::vector<Piece> out;
  for (auto& [part, piece] : pieces) {
    piece.part.name = prepare::part_name(part);
    out.push_back(std::move(piece));
  }
  return out;
}

bool is_in_mouth(const std::string& part) {
  return part.rfind("teeth", 0) == 0 || part.rfind("gums", 0) == 0 || part == "mouth_interior" ||
         part == "tongue";
}

SculptedHead assemble(const std::string& name, const formats::Scene& scene, const std::string& skin,
                      const std::vector<std::vector<bench::MeasuredShape>>& shapes_of_mesh) {
  static const anatomy::GenericAnatomy anatomy = anatomy::load_generic();
  prepare::PrepareOptions options;
  options.skin = skin;
  const rigging::FoundLandmarks found = rigging::find_landmarks(scene, {}, anatomy, options);
  SculptedHead out;
  out.name = name;
  Shapes shapes;
  for (size_t m = 0; m < found.head.meshes.size(); ++m) {
    const Mat3 turn = (found.head.input_to_metres * scene.meshes[m].to_file).topLeftCorner<3, 3>();
    for (Piece& piece : pieces_of(found.head.meshes[m])) {
      if (is_in_mouth(piece.part.name) && shapes_of_mesh[m].empty()) continue;
      const size_t p = out.head.parts.size();
      for (const bench::MeasuredShape& shape : shapes_of_mesh[m]) {
        check::Shape& moved = shapes[arkit_name(shape.name)];
        moved.resize(std::max(moved.size(), p + 1));
        for (const size_t v : piece.vertices)
          moved[p].push_back(turn * shape.displacement[v]);
      }
      out.head.parts.push_back(std::move(piece.part));
    }
  }
  // Eyes without shapes of their own are turned by bones, which are not played here.
  bool turns_eyes = false;
  for (size_t p = 0; p < out.head.parts.size(); ++p)
    if (out.head.parts[p].name.rfind("eye_", 0) == 0)
      for (const auto& [shape, parts] : shapes)
        turns_eyes = turns_eyes || (shape.rfind("eyeLook", 0) == 0 && p < parts.size() && !parts[p].empty());
  if (!turns_eyes)
    std::erase_if(shapes, [](const auto& entry) { return entry.first.rfind("eyeLook", 0) == 0; });
  for (auto& [shape, parts] : shapes)
    parts.resize(out.head.parts.size());
  for (const auto& [landmark, place] : found.landmarks)
    out.head.landmarks[landmark] = place.position;
  for (const auto& [k, eye] : {std::pair(0, &found.head.eye_left), std::pair(1, &found.head.eye_right)})
    if (*eye)
      out.head.eyes[static_cast<size_t>(k)] = check::Eye{(*eye)->centre, (*eye)->radius, (*eye)->gaze};
  out.player = player_of(out.head, std::move(shapes));
  return out;
}

}  // namespace

SculptedHead sculpted_head(const std::filesystem::path& file, const std::string& skin) {
  const formats::Scene scene = formats::read(file);
  std::vector<std::vector<bench::MeasuredShape>> shapes;
  for (const formats::SceneMesh& mesh : scene.meshes)
    shapes.push_back(
        bench::measured_shapes(file, static_cast<size_t>(mesh.mesh), static_cast<size_t>(mesh.primitive)));
  return assemble(file.stem(), scene, skin, shapes);
}

SculptedHead ict_person(const std::string& name) {
  const std::filesystem::path ict = test::measured_data() / "data/ict";
  const formats::Scene scene = formats::read(ict / (name + ".glb"));
  std::vector<std::vector<bench::MeasuredShape>> shapes(scene.meshes.size());
  for (size_t m = 0; m < scene.meshes.size(); ++m)
    if (scene.meshes[m].name == "head") shapes[m] = bench::measured_shapes(ict / "expressions.glb", "head");
  return assemble("ict_" + name, scene, "", shapes);
}

std::vector<SculptedHead> sculpted_heads() {
  std::vector<SculptedHead> all;
  const auto take = [&](const std::string& name, auto make) {
    try {
      all.push_back(make());
    } catch (const Error& error) {
      std::fprintf(stderr, "%s: %s\n", name.c_str(), error.what());
    }
  };
  for (const char* name : {"neutral", "person_0", "person_1", "person_2", "person_3", "person_4", "person_5"})
    take(name, [&] { return ict_person(name); });
  const std::filesystem::path wild = test::measured_data() / "data/wild";
  for (const auto& [file, skin] :
       {std::pair("facecap_plain.glb", ""), std::pair("asian_business.glb", "Wolf3D_Head"),
        std::pair("brunette_t.glb", "Wolf3D_Head"), std::pair("rpm_avatar.glb", "Wolf3D_Head")})
    if (std::filesystem::exists(wild / file))
      take(file, [&, f = file, s = skin] { return sculpted_head(wild / f, s); });
  return all;
}

}  // namespace fascia::testing
