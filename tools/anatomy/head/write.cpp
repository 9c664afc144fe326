#include "tools/anatomy/head/write.h"

#include <cstdio>
#include <fstream>
#include <set>

#include "geometry/error.h"

namespace fascia::head_maker {

namespace {

std::string number(double value, int digits) {
  char text[32];
  std::snprintf(text, sizeof text, "%.*f", digits, value);
  std::string out = text;
  while (out.back() == '0')
    out.pop_back();
  if (out.back() == '.') out.pop_back();
  return out == "-0" ? "0" : out;
}

/// The order in which faces are written: regions by name, faces of a region in the order they were made.
std::vector<std::vector<int>> faces_by_region(const PolygonMesh& mesh, std::vector<std::string>& names) {
  std::map<std::string, std::vector<int>> by_name;
  for (std::size_t f = 0; f < mesh.faces.size(); ++f)
    by_name[mesh.region[f]].push_back(static_cast<int>(f));
  std::vector<std::vector<int>> out;
  for (auto& [name, faces] : by_name) {
    names.push_back(name);
    out.push_back(std::move(faces));
  }
  return out;
}

void write_mesh(std::ofstream& obj, const PolygonMesh& mesh, int& first_vertex, int& first_uv) {
  obj << "o " << mesh.name << "\n";
  for (const Vec3& v : mesh.vertices)
    obj << "v " << number(v.x(), 4) << ' ' << number(v.y(), 4) << ' ' << number(v.z(), 4) << "\n";
  for (const Vec2& t : mesh.uv)
    obj << "vt " << number(t.x(), 6) << ' ' << number(t.y(), 6) << "\n";
  obj << "s 1\n";
  std::vector<std::string> names;
  const auto groups = faces_by_region(mesh, names);
  for (std::size_t g = 0; g < groups.size(); ++g) {
    obj << "g " << names[g] << "\n";
    for (int f : groups[g]) {
      obj << "f";
      for (std::size_t k = 0; k < mesh.faces[f].size(); ++k) {
        obj << ' ' << mesh.faces[f][k] + first_vertex;
        if (!mesh.face_uv.empty()) obj << '/' << mesh.face_uv[f][k] + first_uv;
      }
      obj << "\n";
    }
  }
  first_vertex += static_cast<int>(mesh.vertices.size());
  first_uv += static_cast<int>(mesh.uv.size());
}

void write_list(std::ofstream& json, const std::vector<int>& list) {
  json << '[';
  for (std::size_t k = 0; k < list.size(); ++k)
    json << (k ? "," : "") << list[k];
  json << ']';
}

void write_regions(std::ofstream& json, const PolygonMesh& mesh) {
  std::vector<std::string> names;
  const auto groups = faces_by_region(mesh, names);
  json << "  \"" << mesh.name << "\": {\n   \"faces\": {";
  int first = 0;
  for (std::size_t g = 0; g < groups.size(); ++g) {
    // Faces are written region by region, so that a region is a range.
    json << (g ? "," : "") << "\n    \"" << names[g] << "\": {\"first\": " << first
         << ", \"count\": " << groups[g].size() << "}";
    first += static_cast<int>(groups[g].size());
  }
  json << "\n   },\n   \"loops\": {";
  bool comma = false;
  for (const auto& [name, loop] : mesh.loops) {
    json << (comma ? "," : "") << "\n    \"" << name << "\": ";
    write_list(json, loop);
    comma = true;
  }
  json << "\n   }\n  }";
}

}  // namespace

void write_head(const std::vector<PolygonMesh>& meshes, const std::string& folder) {
  std::ofstream obj(folder + "/head.obj");
  obj << "# Fascia's generic head: own topology, shaped by tools/anatomy/make_head from anatomy/figures (see "
         "anatomy/SOURCES.md).\n"
         "# Millimetres; +X subject's left, +Y up, +Z front.\n";
  int first_vertex = 1, first_uv = 1;
  for (const PolygonMesh& mesh : meshes)
    write_mesh(obj, mesh, first_vertex, first_uv);
  if (!obj.flush()) throw Error(folder + "/head.obj: cannot be written");
  std::ofstream json(folder + "/head_regions.json");
  json << "{\n \"about\": \"Regions (ranges of faces) and loops (vertices) of head.obj, counted from 0 "
          "within each object; "
          "written by tools/anatomy/make_head\",\n \"units\": \"mm\",\n \"objects\": {\n";
  for (std::size_t m = 0; m < meshes.size(); ++m) {
    write_regions(json, meshes[m]);
    json << (m + 1 < meshes.size() ? ",\n" : "\n");
  }
  json << " }\n}\n";
  if (!json.flush()) throw Error(folder + "/head_regions.json: cannot be written");
}

}  // namespace fascia::head_maker
