#include "cli/reconstructed_head.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <numbers>
#include <tuple>

#include "builder/rigging/gltf_source.h"
#include "cli/gltf_edit.h"
#include "cli/landmark_units.h"
#include "formats/obj_lines.h"
#include "formats/scene.h"
#include "geometry/error.h"
#include "geometry/text.h"
#include "view/renderer.h"

namespace fascia::cli {

namespace {

using reconstruction::Result;

constexpr double obj_unit = 1e-3;  // metres: the generic head's file is in millimetres

formats::Scene generic_scene(const anatomy::GenericAnatomy& anatomy) {
  return formats::read("head.obj",
                       std::vector<uint8_t>(anatomy.head_source.begin(), anatomy.head_source.end()));
}

/// A part of the generic head as a mesh with a vertex for each pair of place and texture coordinates.
formats::SceneMesh part_of(const anatomy::MeshObject& object) {
  formats::SceneMesh mesh;
  mesh.name = object.name;
  if (object.corner_uvs.size() != object.mesh.triangles.size()) {
    mesh.positions = object.mesh.vertices;
    mesh.triangles = object.mesh.triangles;
    return mesh;
  }
  std::map<std::tuple<int, double, double>, int> known;
  for (size_t t = 0; t < object.mesh.triangles.size(); ++t) {
    Triangle corners;
    for (size_t k = 0; k < 3; ++k) {
      const int v = object.mesh.triangles[t][k];
      const Vec2& uv = object.corner_uvs[t][k];
      const auto [entry, is_new] =
          known.try_emplace({v, uv.x(), uv.y()}, static_cast<int>(mesh.positions.size()));
      if (is_new) {
        mesh.positions.push_back(object.mesh.vertices[static_cast<size_t>(v)]);
        mesh.uvs.push_back(uv);
      }
      corners[k] = entry->second;
    }
    mesh.triangles.push_back(corners);
  }
  return mesh;
}

/// From the scan's axes and units to metres, +Y up, +Z front. Axes that are nearly those of a scanner stay
/// so.
Mat4 scan_to_metres(const Result& result) {
  Mat3 turn = result.placement.rotation.transpose();
  Mat3 axes = Mat3::Zero();
  for (int row = 0; row < 3; ++row) {
    int longest = 0;
    turn.row(row).cwiseAbs().maxCoeff(&longest);
    axes(row, longest) = turn(row, longest) > 0 ? 1.0 : -1.0;
  }
  const double nearly = std::cos(30.0 * std::numbers::pi / 180.0);
  const bool is_straight = std::abs(axes.determinant() - 1.0) < 1e-9 &&
                           (axes.cwiseProduct(turn).rowwise().sum().array() > nearly).all();
  Mat4 map = Mat4::Identity();
  map.topLeftCorner<3, 3>() = result.metres * (is_straight ? axes : turn);
  return map;
}

void write_obj(const std::filesystem::path& path, const anatomy::GenericAnatomy& anatomy,
               const Result& result, const Vec3& offset) {
  const formats::Scene scene = generic_scene(anatomy);
  std::map<int, Vec3> moved;
  for (const formats::SceneMesh& mesh : scene.meshes) {
    std::vector<Vec3> metres = mesh.positions;
    for (Vec3& p : metres)
      p *= obj_unit;
    const std::vector<Vec3> places = result.place(result.mean, metres);
    for (size_t v = 0; v < places.size(); ++v)
      moved[mesh.source_vertices[v]] = places[v] + offset;
  }
  const int decimals = std::clamp(static_cast<int>(std::ceil(7.0 + std::log10(result.metres / 0.3))), 0, 15);
  formats::write_text(path, formats::with_vertices(anatomy.head_source, moved, decimals));
}

void write_glb(const std::filesystem::path& path, const anatomy::GenericAnatomy& anatomy,
               const Result& result) {
  formats::Scene scene;
  scene.path = path;
  scene.kind = formats::FileKind::obj;  // made from scratch, as for other formats than glTF
  std::vector<std::vector<PrimitiveMotion>> band(2);
  for (uint32_t m = 0; m < anatomy.head.size(); ++m) {
    formats::SceneMesh mesh = part_of(anatomy.head[m]);
    const std::vector<Vec3> mean = result.place(result.mean, mesh.positions);
    for (size_t side = 0; side < 2; ++side) {
      const std::vector<Vec3> there = result.place(side == 0 ? result.thin : result.thick, mesh.positions);
      PrimitiveMotion motion{m, 0, {}};
      for (size_t v = 0; v < mean.size(); ++v)
        motion.displacement.push_back((there[v] - mean[v]).cast<float>());
      band[side].push_back(std::move(motion));
    }
    mesh.positions = mean;
    scene.meshes.push_back(std::move(mesh));
  }
  GltfEdit edit(rigging::gltf_source(scene, scan_to_metres(result)));
  add_morph_targets(edit, {thin_target, thick_target}, band);
  const std::vector<uint8_t> bytes = edit.bytes();
  formats::write_bytes(path, bytes.data(), bytes.size());
}

view::DrawSurface surface(const TriangleMesh& mesh, const Vec3& colour) {
  view::DrawSurface drawn;
  drawn.positions = mesh.vertices;
  drawn.triangles = mesh.triangles;
  drawn.colour = colour;
  return drawn;
}

/// All parts of the head, upright in metres.
std::vector<view::DrawSurface> head_surfaces(const anatomy::GenericAnatomy& anatomy, const Result& result,
                                             const skull::BoneMap& map, const Mat4& upright) {
  std::vector<view::DrawSurface> drawn;
  for (const anatomy::MeshObject& object : anatomy.head) {
    TriangleMesh mesh = object.mesh;
    mesh.vertices = result.place(map, mesh.vertices);
    for (Vec3& p : mesh.vertices)
      p = transform_point(upright, p);
    drawn.push_back(surface(mesh, object.name == "skin" ? Vec3(0.86, 0.69, 0.59) : Vec3(0.93, 0.93, 0.92)));
  }
  return drawn;
}

/// Blue where people differ by a millimetre or less to red at seven.
Vec3 spread_colour(double metres) {
  const double t = std::clamp((metres - 0.001) / 0.006, 0.0, 1.0);
  return {0.25 + 0.65 * t, 0.45 + 0.3 * std::sin(std::numbers::pi * t) - 0.2 * t, 0.85 - 0.7 * t};
}

}  // namespace

void write_reconstructed_head(const std::filesystem::path& path, const anatomy::GenericAnatomy& anatomy,
                              const Result& result, const Vec3& offset) {
  if (extension_of(path) == ".obj")
    write_obj(path, anatomy, result, offset);
  else if (extension_of(path) == ".glb")
    write_glb(path, anatomy, result);
  else
    throw Error("'" + path.string() + "': a head is written as .glb or .obj");
}

void write_reconstructed_landmarks(const std::filesystem::path& path, const std::filesystem::path& head,
                                   const anatomy::GenericAnatomy& anatomy, const Result& result,
                                   const Vec3& offset) {
  using Json = nlohmann::ordered_json;
  Json json;
  const bool is_upright = extension_of(head) == ".glb";
  const double unit = is_upright ? 1.0 : result.metres;
  const Mat4 upright = scan_to_metres(result);
  json["units"] = landmark_units(unit);
  const auto triple = [&](const Vec3& scan) {
    const Vec3 p = is_upright ? transform_point(upright, scan) : Vec3(scan + offset);
    return Json::array({p[0], p[1], p[2]});
  };
  json["landmarks"] = Json::object();
  for (const anatomy::Landmark& landmark : anatomy.landmarks)
    if (landmark.skin)
      json["landmarks"][landmark.name] = {{"skin", triple(result.placement(result.mean(*landmark.skin)))}};
  for (const reconstruction::SkinOverBone& landmark : result.landmarks) {
    json["landmarks"][landmark.name]["bone"] = triple(landmark.bone);
    json["landmarks"][landmark.name]["depth_mm"] = 1e3 * landmark.depth;
    json["landmarks"][landmark.name]["deviation_mm"] = 1e3 * landmark.deviation;
  }
  formats::write_text(path, json.dump(1) + "\n");
}

view::Image reconstruction_sheet(const anatomy::GenericAnatomy& anatomy, const Result& result,
                                 const TriangleMesh& scan) {
  const Mat4 upright = scan_to_metres(result);
  TriangleMesh bone = scan;
  for (Vec3& p : bone.vertices)
    p = transform_point(upright, p);
  const std::vector<view::DrawSurface> mean = head_surfaces(anatomy, result, result.mean, upright),
                                       thin = head_surfaces(anatomy, result, result.thin, upright),
                                       thick = head_surfaces(anatomy, result, result.thick, upright);
  view::DrawList alone, over_bone, band;
  alone.surfaces = mean;
  over_bone.surfaces = mean;
  for (view::DrawSurface& drawn : over_bone.surfaces)
    drawn.opacity = 0.55;
  over_bone.surfaces.push_back(surface(bone, Vec3(0.92, 0.88, 0.78)));
  band.surfaces = mean;
  for (size_t s = 0; s < mean.size(); ++s)
    for (size_t v = 0; v < mean[s].positions.size(); ++v)
      band.surfaces[s].vertex_colours.push_back(
          spread_colour(0.5 * (thick[s].positions[v] - thin[s].positions[v]).norm()));
  const view::Renderer renderer(480, 480);
  const Bounds box = bounds(mean.front().positions);
  std::vector<view::Tile> tiles;
  const std::array<std::pair<const view::DrawList*, std::string>, 3> rows = {
      {{&alone, ""}, {&over_bone, " over the skull"}, {&band, ": SD 1 to 7 mm"}}};
  for (const auto& [list, title] : rows)
    for (const char* name : {"front", "three-quarter", "side"})
      tiles.push_back({renderer.draw(*list, view::named_camera(name, box)), name + title});
  return view::contact_sheet(tiles, 3);
}

}  // namespace fascia::cli
