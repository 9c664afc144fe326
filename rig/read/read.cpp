#include "rig/read/read.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <set>
#include <string>

#include "geometry/error.h"
#include "gltf/read/accessors.h"
#include "gltf/read/container.h"
#include "gltf/read/model.h"
#include "rig/model/extensions.h"
#include "rig/read/visitor.h"

namespace fascia::rig {
namespace {

/// Root object of extension `name`. Throws when it is not there or of a version this build does not know.
const tinygltf::Value& root_object(const tinygltf::Model& model, const std::string& name,
                                   const std::string& file) {
  const auto found = model.extensions.find(name);
  if (found == model.extensions.end())
    throw Error(file + ": no " + name + " extension: this is not a Fascia rig; make one with `fascia build`");
  const tinygltf::Value& object = found->second;
  if (!object.IsObject() || !object.Has("specVersion") || !object.Get("specVersion").IsString())
    throw Error(file + ": " + name + "/specVersion: missing");
  const auto version = object.Get("specVersion").Get<std::string>();
  if (version != spec_version)
    throw VersionError(file + ": " + name + "/specVersion: version " + version +
                       " is not known to this build, which reads " + spec_version +
                       "; update Fascia or build the rig again");
  return object;
}

void check_unique(const std::vector<Channel>& channels, const std::string& path) {
  std::set<std::string> seen;
  for (std::size_t i = 0; i < channels.size(); ++i) {
    const Channel& channel = channels[i];
    const std::string at = path + "/channels/" + std::to_string(i);
    if (channel.name.empty()) throw Error(at + "/name: empty");
    if (!seen.insert(channel.name).second) throw Error(at + "/name: " + channel.name + " is there twice");
    if (!(channel.minimum <= channel.rest && channel.rest <= channel.maximum))
      throw Error(at + ": the rest value of " + channel.name + " lies outside its range");
  }
}

/// Index of buffer view `name` of `object`, as bytes; nothing when it is left out.
std::vector<uint8_t> stored_bytes(const tinygltf::Model& model, const tinygltf::Value& object,
                                  const char* name, const std::string& path) {
  if (!object.Has(name)) return {};
  const int index = object.Get(name).IsInt() ? object.Get(name).Get<int>() : -1;
  if (index < 0 || static_cast<std::size_t>(index) >= model.bufferViews.size())
    throw Error(path + "/" + name + ": no such buffer view");
  const tinygltf::BufferView& view = model.bufferViews[static_cast<std::size_t>(index)];
  if (view.buffer != 0 || model.buffers.empty() || view.byteOffset > model.buffers[0].data.size() ||
      view.byteLength > model.buffers[0].data.size() - view.byteOffset)
    throw Error(path + "/" + name + ": the buffer view reaches beyond the file");
  const uint8_t* data = model.buffers[0].data.data() + view.byteOffset;
  return {data, data + view.byteLength};
}

SourceRecord source_record(const tinygltf::Model& model, const tinygltf::Value& tissue,
                           const std::string& path) {
  SourceRecord record;
  if (!tissue.Has("source")) return record;
  const tinygltf::Value& source = tissue.Get("source");
  if (!source.IsObject()) throw Error(path + ": not an object");
  if (source.Has("format") && source.Get("format").IsString())
    record.format = source.Get("format").Get<std::string>();
  const std::vector<uint8_t> notes = stored_bytes(model, source, "notes", path);
  record.json.assign(notes.begin(), notes.end());
  record.bytes = stored_bytes(model, source, "file", path);
  return record;
}

Tissue tissue_of(const tinygltf::Model& model, const tinygltf::Value& object, const std::string& path,
                 const TissueLimits& limits, Mat4f& input_to_metres) {
  Tissue tissue;
  Reader reader(model, object, path);
  reader.matrix("inputToMetres", input_to_metres);
  if (reader.has("mechanics"))
    reader.object("mechanics", [&](Reader& inner) { mechanics_fields(inner, tissue.mechanics.emplace()); });
  reader.array("levels", tissue.levels, [&](Reader& inner, TissueLevel& level, std::size_t index) {
    tissue_level_fields(inner, level, limits);
    tissue.bindings.resize(index + 1);
    inner.array("bindings", tissue.bindings[index], [&](Reader& bound, Binding& binding, std::size_t) {
      binding_fields(bound, binding, 3 * std::size_t{level.columns});
    });
  });
  if (tissue.levels.empty()) throw Error(path + "/levels: none");
  return tissue;
}

std::vector<Vec3f> vec3_attribute(const tinygltf::Model& model, int accessor, std::size_t count,
                                  const std::string& path) {
  const std::vector<float> numbers = gltf::decode_floats(model, accessor, path);
  if (count != any && numbers.size() != 3 * count) throw Error(path + ": not as many as positions");
  std::vector<Vec3f> vectors(numbers.size() / 3);
  for (std::size_t i = 0; i < vectors.size(); ++i) {
    vectors[i] = {numbers[3 * i], numbers[3 * i + 1], numbers[3 * i + 2]};
    if (!Element<Vec3f>::finite(vectors[i])) throw Error(path + ": a value is not finite");
  }
  return vectors;
}

/// Weights a mesh's targets have before any animation plays: the first node's that shows it, else the mesh's
/// own.
const std::vector<double>& default_weights(const tinygltf::Model& model, uint32_t mesh) {
  for (const tinygltf::Node& node : model.nodes)
    if (node.mesh == static_cast<int>(mesh) && !node.weights.empty()) return node.weights;
  return model.meshes[mesh].weights;
}

/// Adds the deltas of attribute `name` that default weights switch on. Returns whether there were any.
bool add_default_morphs(const tinygltf::Model& model, const Binding& binding, const char* name,
                        std::vector<Vec3f>& vectors, const std::string& path) {
  const auto& targets = model.meshes[binding.mesh].primitives[binding.primitive].targets;
  const std::vector<double>& weights = default_weights(model, binding.mesh);
  bool any_on = false;
  for (std::size_t t = 0; t < std::min(targets.size(), weights.size()); ++t) {
    const auto delta = targets[t].find(name);
    if (weights[t] == 0.0 || delta == targets[t].end()) continue;
    const std::vector<Vec3f> moves = vec3_attribute(model, delta->second, vectors.size(), path);
    for (std::size_t v = 0; v < vectors.size(); ++v)
      vectors[v] += static_cast<float>(weights[t]) * moves[v];
    any_on = true;
  }
  return any_on;
}

/// An attribute for shading only, of vectors with as many components as Vector; empty where the file has none
/// or it is malformed.
template <class Vector>
std::vector<Vector> shading_attribute(const tinygltf::Model& model, const tinygltf::Primitive& primitive,
                                      const char* name, std::size_t count, const std::string& path) {
  constexpr auto components = static_cast<std::size_t>(Vector::RowsAtCompileTime);
  const auto found = primitive.attributes.find(name);
  if (found == primitive.attributes.end()) return {};
  std::vector<float> numbers;
  try {
    if (gltf::accessor_view(model, found->second, path).components == components)
      numbers = gltf::decode_floats(model, found->second, path);
  } catch (const Error&) {  // the face moves without
  }
  if (numbers.size() != count * components) return {};
  std::vector<Vector> vectors(count);
  for (std::size_t i = 0; i < count; ++i) {
    vectors[i] = Eigen::Map<const Vector>(numbers.data() + i * components);
    if (!vectors[i].allFinite()) return {};
  }
  return vectors;
}

/// The geometry `binding` names, its fingerprint checked, as it is seen: default weights of morph targets on.
Primitive bound_primitive(const tinygltf::Model& model, const Binding& binding, const std::string& path) {
  if (binding.mesh >= model.meshes.size() ||
      binding.primitive >= model.meshes[binding.mesh].primitives.size())
    throw Error(path + ": mesh " + std::to_string(binding.mesh) + " primitive " +
                std::to_string(binding.primitive) + " is not in the file");
  const tinygltf::Mesh& mesh = model.meshes[binding.mesh];
  const tinygltf::Primitive& primitive = mesh.primitives[binding.primitive];
  const auto position = primitive.attributes.find("POSITION");
  if (position == primitive.attributes.end()) throw Error(path + ": the primitive has no POSITION");
  if (gltf::accessor_view(model, position->second, path).components != 3)
    throw Error(path + ": POSITION is not a VEC3");
  Primitive result;
  result.mesh = binding.mesh;
  result.primitive = binding.primitive;
  result.name = mesh.name;
  result.positions = vec3_attribute(model, position->second, any, path);
  const std::string remedy =
      "; another tool has changed the mesh since the rig was built: build the rig again from the changed "
      "head";
  if (result.positions.size() != binding.vertex_count)
    throw MismatchError(path + ": mesh \"" + mesh.name + "\" has " + std::to_string(result.positions.size()) +
                        " vertices where the rig was built for " + std::to_string(binding.vertex_count) +
                        remedy);
  if (gltf::attribute_hash(model, position->second, path) != binding.position_hash)
    throw MismatchError(path + ": the positions of mesh \"" + mesh.name +
                        "\" are not those the rig was built for" + remedy);
  add_default_morphs(model, binding, "POSITION", result.positions, path);
  result.triangles = gltf::decode_triangles(model, primitive, result.positions.size(), path);
  const auto normal = primitive.attributes.find("NORMAL");
  if (normal != primitive.attributes.end() &&
      gltf::accessor_view(model, normal->second, path).components == 3)
    result.normals = vec3_attribute(model, normal->second, result.positions.size(), path);
  result.tangents = shading_attribute<Vec4f>(model, primitive, "TANGENT", result.positions.size(), path);
  result.texture = shading_attribute<Vec2f>(model, primitive, "TEXCOORD_0", result.positions.size(), path);
  if (add_default_morphs(model, binding, "NORMAL", result.normals, path))
    for (Vec3f& n : result.normals)
      n.normalize();
  return result;
}

/// Throws when a binding's map carries its first vertex out of the rig's surroundings: single precision would
/// lose the shape there. `positions` in the mesh's units.
void check_place(const Binding& binding, const std::vector<Vec3f>& positions, const std::string& path) {
  constexpr float farthest = 1e4F;  // metres
  if (positions.empty()) return;
  const Vec3f first = (binding.to_rig * positions[0].homogeneous()).head<3>();
  if (!(first.cwiseAbs().maxCoeff() < farthest))
    throw Error(path + ": it carries the mesh kilometres away from the rig");
}

void read_primitives(const tinygltf::Model& model, RigFile& file, const std::string& path) {
  for (std::size_t level = 0; level < file.rig.tissue.bindings.size(); ++level)
    for (std::size_t b = 0; b < file.rig.tissue.bindings[level].size(); ++b) {
      const Binding& binding = file.rig.tissue.bindings[level][b];
      const std::string at = path + "/levels/" + std::to_string(level) + "/bindings/" + std::to_string(b);
      const std::size_t known = file.primitive_of(binding);
      if (known == file.primitives.size()) {
        file.primitives.push_back(bound_primitive(model, binding, at));
      } else if (file.primitives[known].positions.size() != binding.vertex_count) {
        throw Error(at + "/vertexCount: disagrees with another level's");
      }
      check_place(binding, file.primitives[known].positions, at + "/toRig");
    }
}

/// Throws unless `matrix` is an affine map that turns and scales by something between a millionth of a
/// millionth and its inverse: others have no use, and no inverse in single precision.
void check_map(const Mat4f& matrix, const std::string& path) {
  if (matrix.row(3) != Eigen::RowVector4f(0.0F, 0.0F, 0.0F, 1.0F))
    throw Error(path + ": the last row of the matrix is not 0, 0, 0, 1");
  const Eigen::Matrix3d linear = matrix.topLeftCorner<3, 3>().cast<double>();
  const double volume = std::abs(linear.determinant()), largest = linear.cwiseAbs().maxCoeff();
  if (!(largest > 1e-12 && largest < 1e12 && volume > 1e-6 * largest * largest * largest))
    throw Error(path + ": not an invertible map of a sensible scale");
  if (!(matrix.topRightCorner<3, 1>().cast<double>().cwiseAbs().maxCoeff() < 1e13 * largest))
    throw Error(path + ": it moves by more than ten million million units");
}

/// Numbers that are finite and yet absurd would come out of the solver as no numbers.
void check_ranges(const Rig& rig, const std::string& name) {
  const std::string tissue = name + ": " + tissue_extension;
  check_map(rig.input_to_metres, tissue + "/inputToMetres");
  for (std::size_t level = 0; level < rig.tissue.levels.size(); ++level) {
    const std::string path = tissue + "/levels/" + std::to_string(level);
    for (const Binding& binding : rig.tissue.bindings[level]) {
      check_map(binding.to_rig, path + "/bindings/toRig");
      for (const float weight : binding.weights)
        if (!(std::abs(weight) < 100.0F)) throw Error(path + "/bindings/weights: a weight is above 100");
      for (const float weight : binding.jaw_weights)
        if (!(weight >= -0.01F && weight <= 1.01F))
          throw Error(path + "/bindings/jawWeights: a weight is not within 0..1");
    }
  }
}

}  // namespace

std::size_t RigFile::primitive_of(const Binding& binding) const {
  std::size_t i = 0;
  while (i < primitives.size() &&
         (primitives[i].mesh != binding.mesh || primitives[i].primitive != binding.primitive))
    ++i;
  return i;
}

bool is_rig(std::span<const uint8_t> bytes) {
  if (!gltf::is_glb(bytes)) return false;
  try {
    return gltf::glb_chunks(bytes, "").json.find("\"FASCIA_") != std::string_view::npos;
  } catch (const Error&) {
    return false;
  }
}

RigFile read(std::span<const uint8_t> bytes, const std::string& name) {
  tinygltf::Model model = gltf::load_model(bytes, name);
  const std::string prefix = name + ": ";
  RigFile file;
  Rig& rig = file.rig;
  Reader skull(model, root_object(model, skull_extension, name), prefix + skull_extension);
  skull_fields(skull, rig.skull);
  Reader smas(model, root_object(model, smas_extension, name), prefix + smas_extension);
  smas_fields(smas, rig.smas);

  Reader muscles(model, root_object(model, muscles_extension, name), prefix + muscles_extension);
  MuscleTable table;
  muscle_table_fields(muscles, table, rig.smas.surface.triangles.size());
  rig.muscles = unpack_muscles(std::move(table));

  const std::string actuation_path = prefix + actuation_extension;
  Reader actuation(model, root_object(model, actuation_extension, name), actuation_path);
  actuation_fields(actuation, rig.actuation);
  check_unique(rig.actuation.channels, actuation_path);
  for (const Channel& channel : rig.actuation.channels)
    if (channel.muscle < -1 || channel.muscle >= static_cast<int64_t>(rig.muscles.size()))
      throw Error(actuation_path + ": channel " + channel.name + " contracts a muscle that does not exist");

  const std::string tissue_path = prefix + tissue_extension;
  const tinygltf::Value& tissue = root_object(model, tissue_extension, name);
  rig.tissue = tissue_of(model, tissue, tissue_path, {rig.muscles.size(), rig.actuation.channels.size()},
                         rig.input_to_metres);
  check_ranges(rig, name);
  file.source = source_record(model, tissue, tissue_path + "/source");
  read_primitives(model, file, tissue_path);

  file.json = gltf::glb_chunks(bytes, name).json;
  if (!model.buffers.empty()) file.bin = std::move(model.buffers[0].data);
  return file;
}

}  // namespace fascia::rig
