#include "builder/rigging/embedded_head.h"

#include <cstdio>
#include <nlohmann/json.hpp>
#include <string>

#include "formats/scene.h"
#include "formats/write.h"
#include "geometry/error.h"

namespace fascia::rigging {

namespace {

// Pictures and colours (sRGB) of the head's own materials.
const char* materials = R"(newmtl skin
Kd 1 1 1
map_Kd head_skin.jpg
norm head_skin_normal.jpg
map_Pr head_skin_roughness.jpg
Pr 0.5
newmtl sclera
Kd 0.90 0.87 0.84
Pr 0.3
newmtl iris
Kd 0.33 0.43 0.49
Pr 0.2
newmtl pupil
Kd 0.02 0.02 0.02
Pr 0.2
newmtl enamel
Kd 0.90 0.87 0.78
Pr 0.3
newmtl mucosa
Kd 0.68 0.36 0.35
Pr 0.4
newmtl lashes
Kd 0.10 0.075 0.06
Pr 0.5
)";

size_t vertices_in(const std::string& obj) {
  size_t count = 0;
  for (size_t at = 0; at < obj.size(); at = obj.find('\n', at), at = at == std::string::npos ? at : at + 1)
    if (obj.compare(at, 2, "v ") == 0) ++count;
  return count;
}

/// `obj` with a material named after each of the lines `start`, such as "o skin" or "g iris".
std::string with_material(std::string obj, const std::string& start, const std::string& material) {
  const std::string line = start + "\n", use = "usemtl " + material + "\n";
  for (size_t at = obj.find(line); at != std::string::npos; at = obj.find(line, at + line.size()))
    obj.insert(at + line.size(), use);
  return obj;
}

std::string object_text(const std::string& name, const TriangleMesh& mesh, size_t first) {
  std::string text = "o " + name + "\n";
  for (const Vec3& p : mesh.vertices) {
    char line[96];
    std::snprintf(line, sizeof line, "v %.4f %.4f %.4f\n", 1e3 * p[0], 1e3 * p[1], 1e3 * p[2]);
    text += line;
  }
  for (const Triangle& t : mesh.triangles) {
    text += "f";
    for (int corner : t)
      text += " " + std::to_string(first + static_cast<size_t>(corner));
    text += "\n";
  }
  return text;
}

/// The faces of `obj` counted from `offset` vertices on.
std::string moved_on(const std::string& obj, size_t offset) {
  std::string text;
  for (size_t at = 0; at < obj.size();) {
    const size_t end = std::min(obj.find('\n', at), obj.size());
    const std::string line = obj.substr(at, end - at);
    at = end + 1;
    if (line.rfind("f ", 0) != 0) {
      text += line + "\n";
      continue;
    }
    text += "f";
    for (size_t word = 2; word < line.size(); word = std::min(line.find(' ', word), line.size() - 1) + 1)
      text += " " + std::to_string(offset + std::stoul(line.substr(word)));
    text += "\n";
  }
  return text;
}

void write_landmarks(const anatomy::GenericAnatomy& anatomy, const std::filesystem::path& path) {
  nlohmann::ordered_json json = {{"units", "mm"}, {"landmarks", nlohmann::ordered_json::object()}};
  for (const anatomy::Landmark& landmark : anatomy.landmarks)
    if (landmark.skin) {
      const Vec3 mm = 1e3 * *landmark.skin;
      json["landmarks"][landmark.name] = {mm[0], mm[1], mm[2]};
    }
  formats::write_text(path, json.dump(1) + "\n");
}

}  // namespace

void write_embedded_head(const anatomy::GenericAnatomy& anatomy, const std::filesystem::path& head,
                         const std::filesystem::path& landmarks) {
  // The head as it is in the data, quads and texture coordinates too; the skull's teeth, gums, tongue and
  // lashes with it.
  std::string text = with_material(anatomy.head_source, "o skin", "skin");
  for (const char* region : {"sclera", "iris", "pupil"})
    text = with_material(text, std::string("g ") + region, region);
  text = "mtllib " + head.stem().string() + ".mtl\n" + text;
  size_t count = vertices_in(text);
  for (const char* name : {"teeth_upper", "teeth_lower"})
    if (const anatomy::MeshObject* teeth = anatomy.skull_object(name)) {
      text += with_material(object_text(name, teeth->mesh, count + 1), std::string("o ") + name, "enamel");
      count += teeth->mesh.vertices.size();
    }
  const std::string parts = moved_on(std::string(anatomy::embedded_file("head_parts.obj")), count);
  text += with_material(with_material(parts, "o mouth_interior", "mucosa"), "o lashes", "lashes");
  formats::write_text(head, text);
  std::filesystem::path library = head;
  formats::write_text(library.replace_extension(".mtl"), materials);
  for (const char* picture : {"head_skin.jpg", "head_skin_normal.jpg", "head_skin_roughness.jpg"}) {
    const std::string_view bytes = anatomy::embedded_file(picture);
    formats::write_bytes(head.parent_path() / picture, bytes.data(), bytes.size());
  }
  write_landmarks(anatomy, landmarks);
}

void write_embedded_head(const std::filesystem::path& head, const std::filesystem::path& landmarks) {
  write_embedded_head(anatomy::load_generic(), head, landmarks);
}

}  // namespace fascia::rigging
