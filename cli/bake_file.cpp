#include "cli/bake_file.h"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <set>

#include "anatomy/anatomy.h"
#include "cli/gltf_edit.h"
#include "cli/motion.h"
#include "cli/posed_output.h"
#include "cli/take/point_cache.h"
#include "formats/partial.h"
#include "formats/scene.h"
#include "geometry/error.h"
#include "geometry/nearest_names.h"
#include "geometry/text.h"
#include "rig/write/write.h"

namespace fascia::cli {

namespace {

/// The rig's own name of a vocabulary as people write it.
std::string vocabulary(const Face& face, const std::string& word) {
  const std::vector<std::string> known = face.set_names();
  const auto has = [&](const std::string& name) {
    return std::find(known.begin(), known.end(), name) != known.end();
  };
  if (has(word)) return word;
  if (word == "visemes" && has("viseme")) return "viseme";
  if (word == "faces" && has("face")) return "face";
  if (word == "faces" && has("smile")) return "smile";
  if (word == "aus" && has("au")) return "au";
  std::string list = "muscles";
  for (const std::string& name : known)
    list += ", " + name;
  throw Error("--shapes " + word + ": the rig has no such vocabulary" + did_you_mean(word, known) +
              "; it has " + list);
}

/// A member's name as hosts expect it: viseme_PP, AU12, AU12L.
std::string shape_name(const std::string& set, const std::string& member) {
  if (set == "viseme") return "viseme_" + member;
  if (set != "au") return member;
  const bool has_side = member.starts_with('L') || member.starts_with('R');
  return has_side ? "AU" + member.substr(1) + member[0] : "AU" + member;
}

/// Pairs of shapes, each as what is set and what is taken off again.
void add_correctives(const Common& common, std::vector<ShapeToBake>& shapes) {
  const size_t before = shapes.size();
  const nlohmann::json table = nlohmann::json::parse(anatomy::embedded_file("correctives.json"));
  for (const auto& pair : table.at("pairs")) {
    std::vector<size_t> parts;
    for (const auto& name : pair)
      for (size_t s = 0; s < shapes.size(); ++s)
        if (shapes[s].name == name.get<std::string>()) parts.push_back(s);
    if (parts.size() != 2) continue;
    shapes.push_back({shapes[parts[0]].name + "_" + shapes[parts[1]].name,
                      {shapes[parts[0]].sets[0], shapes[parts[1]].sets[0]},
                      parts});
  }
  if (shapes.size() == before)
    common.warn("--correctives: the shapes contain none of the pairs that have one (they are ARKit's)");
}

std::vector<ShapeToBake> shapes_of(const Common& common, const Face& face, const BakeRequest& request) {
  std::vector<ShapeToBake> shapes;
  std::set<std::string> names;
  const auto add = [&](const std::string& name, const std::string& what) {
    if (names.insert(name).second) shapes.push_back({name, {what}, {}});
  };
  for (const std::string& word : request.sets) {
    if (word == "muscles") {
      for (const std::string& name : face.channel_names())
        add(name, name);
      continue;
    }
    const std::string set = vocabulary(face, word);
    for (const std::string& member : face.set_members(set))
      add(shape_name(set, member), set + ":" + member);
  }
  if (request.correctives) add_correctives(common, shapes);
  return shapes;
}

std::string format_of(const BakeRequest& request) {
  const std::string extension = extension_of(request.output);
  if (!request.format.empty()) {
    if (request.format != "obj-sequence" && extension != "." + request.format)
      throw Error("'" + request.output.string() + "': --format " + request.format + " writes ." +
                  request.format + ": end the output's name so, or leave --format out");
    return request.format;
  }
  if (extension == ".glb") return "glb";
  if (extension == ".pc2") return "pc2";
  throw Error("'" + request.output.string() +
              "': baked shapes are written as .glb or .pc2, or with --format obj-sequence as a folder");
}

void write_glb(const Common& common, const BakeRequest& request, const Face& face,
               const std::vector<ShapeToBake>& shapes, BakeFigures& figures) {
  const BakedShapes baked = bake_shapes(common, face, shapes);
  const std::vector<uint8_t> bytes = formats::read_bytes(request.rig);
  auto source = rig::glb_source(bytes, request.rig.string());
  GltfEdit edit(request.keeps_rig ? std::move(source) : rig::original(source));
  const size_t before = edit.parts().size();
  gltf::MorphOptions options;
  if (request.replaces) options.existing = gltf::MorphOptions::Existing::replace;
  std::vector<std::string> warnings;
  gltf::add_morph_targets(edit, baked.names, baked.shapes, options, &warnings);
  for (const std::string& warning : warnings)
    common.warn(warning);
  const GltfEdit::Parts out = edit.parts();
  formats::write_parts(request.output, {out.before, out.binary, out.after});
  figures.files = {request.output};
  size_t all = 0;
  std::vector<size_t> moved;
  for (const auto& shape : baked.shapes) {
    size_t count = 0;
    for (const PrimitiveMotion& motion : shape)
      count += static_cast<size_t>(std::count_if(motion.displacement.begin(), motion.displacement.end(),
                                                 [](const auto& d) { return !d.isZero(0); }));
    moved.push_back(count);
    all += count;
  }
  const double grown = 1e-6 * static_cast<double>(out.size() > before ? out.size() - before : 0);
  for (const size_t count : moved)
    figures.megabytes.push_back(all > 0 ? grown * static_cast<double>(count) / static_cast<double>(all)
                                        : 0.0);
}

void write_sequence(const Common& common, const BakeRequest& request, const Face& face,
                    const std::vector<ShapeToBake>& shapes, BakeFigures& figures) {
  formats::PartialGroup together;
  make_output_folder(request.output, &together);
  const auto write = [&](const std::string& name, const Face& posed) {
    figures.files.push_back(request.output / (name + ".obj"));
    together.add(figures.files.back());
    write_posed_mesh(request.rig, posed, figures.files.back());
  };
  write("rest", face);
  for_each_shape(common, face, shapes, [&](size_t s, const Face& posed) { write(shapes[s].name, posed); });
  together.keep();
}

void write_cache(const Common& common, const BakeRequest& request, const Face& face,
                 const std::vector<ShapeToBake>& shapes, BakeFigures& figures) {
  std::vector<float> times;
  for (size_t s = 0; s <= shapes.size(); ++s)
    times.push_back(static_cast<float>(s));
  PointCaches caches(request.output, CacheKind::pc2, cached_objects(common, request.rig, face), times);
  caches.add(face);
  for_each_shape(common, face, shapes, [&](size_t, const Face& posed) { caches.add(posed); });
  figures.files = caches.finish();
}

}  // namespace

BakeFigures bake_file(const Common& common, const BakeRequest& request) {
  check_output(request.output, {request.rig});
  const std::string format = format_of(request);
  Face face(request.rig,
            {format == "glb" ? FASCIA_SPACE_MESH : FASCIA_SPACE_INPUT, request.solver, request.level});
  const std::vector<ShapeToBake> shapes = shapes_of(common, face, request);
  if (shapes.empty()) throw Error("--shapes names no shape");
  BakeFigures figures;
  for (const ShapeToBake& shape : shapes)
    figures.names.push_back(shape.name);
  if (format == "glb")
    write_glb(common, request, face, shapes, figures);
  else if (format == "pc2")
    write_cache(common, request, face, shapes, figures);
  else
    write_sequence(common, request, face, shapes, figures);
  return figures;
}

}  // namespace fascia::cli
