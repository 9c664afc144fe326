#include "view/face/appearance.h"

#include <algorithm>
#include <cmath>

#include "geometry/error.h"
#include "gltf/read/accessors.h"
#include "gltf/read/model.h"

namespace fascia::view {

namespace {

const tinygltf::Value* member(const tinygltf::Value* value, const char* name) {
  return value && value->IsObject() && value->Has(name) ? &value->Get(name) : nullptr;
}

const tinygltf::Value* extension(const tinygltf::ExtensionMap& extensions, const char* name) {
  const auto found = extensions.find(name);
  return found == extensions.end() ? nullptr : &found->second;
}

double number(const tinygltf::Value* value, double otherwise) {
  return value && value->IsNumber() ? value->GetNumberAsDouble() : otherwise;
}

double encoded(double linear) {
  return std::pow(std::clamp(linear, 0.0, 1.0), 1.0 / 2.2);
}

Vec3 encoded(const std::vector<double>& linear) {
  return linear.size() < 3 ? Vec3(Vec3::Ones())
                           : Vec3(encoded(linear[0]), encoded(linear[1]), encoded(linear[2]));
}

std::vector<double> numbers(const tinygltf::Value* value) {
  std::vector<double> list;
  for (size_t k = 0; value && value->IsArray() && k < value->ArrayLen(); ++k)
    list.push_back(number(&value->Get(k), 1.0));
  return list;
}

/// A map's place in the file: texture, set of coordinates, transform.
struct MapPlace {
  int texture = -1, set = 0;
  Vec2 offset = Vec2::Zero(), scale = Vec2::Ones();
  double turn = 0.0;

  Vec2 operator()(const Vec2& uv) const {  // KHR_texture_transform
    const Vec2 s = uv.cwiseProduct(scale);
    return offset + Vec2(std::cos(turn) * s[0] + std::sin(turn) * s[1],
                         -std::sin(turn) * s[0] + std::cos(turn) * s[1]);
  }
};

MapPlace map_place(int texture, int set, const tinygltf::Value* transform) {
  MapPlace place{texture, set, Vec2::Zero(), Vec2::Ones(), 0.0};
  const std::vector<double> offset = numbers(member(transform, "offset")),
                            scale = numbers(member(transform, "scale"));
  if (offset.size() >= 2) place.offset = Vec2(offset[0], offset[1]);
  if (scale.size() >= 2) place.scale = Vec2(scale[0], scale[1]);
  place.turn = number(member(transform, "rotation"), 0.0);
  return place;
}

class Reader {
 public:
  Reader(const tinygltf::Model& model, const std::string& name, const Appearance::Options& options,
         std::vector<std::string>& warnings)
      : model_(model), name_(name), options_(options), warnings_(warnings) {}

  PrimitiveLook look(const tinygltf::Primitive& primitive) {
    PrimitiveLook look;
    MapPlace place;
    if (primitive.material >= 0 && primitive.material < static_cast<int>(model_.materials.size()))
      place = read_material(model_.materials[static_cast<size_t>(primitive.material)], look);
    try {
      read_vertices(primitive, place, look);
    } catch (const Error& error) {
      warnings_.push_back(error.what());
    }
    return look;
  }

 private:
  MapPlace read_material(const tinygltf::Material& material, PrimitiveLook& look) {
    look.material = material.name;
    const auto& pbr = material.pbrMetallicRoughness;
    MapPlace base = map_place(pbr.baseColorTexture.index, pbr.baseColorTexture.texCoord,
                              extension(pbr.baseColorTexture.extensions, "KHR_texture_transform"));
    std::vector<double> factor = pbr.baseColorFactor;
    look.roughness = pbr.roughnessFactor;
    look.metalness = pbr.metallicFactor;
    if (const tinygltf::Value* old = extension(material.extensions, "KHR_materials_pbrSpecularGlossiness")) {
      const tinygltf::Value* map = member(old, "diffuseTexture");
      base = map_place(static_cast<int>(number(member(map, "index"), -1)),
                       static_cast<int>(number(member(map, "texCoord"), 0)), nullptr);
      if (member(old, "diffuseFactor")) factor = numbers(member(old, "diffuseFactor"));
      look.roughness = 1.0 - 0.6 * number(member(old, "glossinessFactor"), 0.5);
      look.metalness = 0.0;
    }
    look.colour = encoded(factor);
    look.opacity = factor.size() > 3 ? std::clamp(factor[3], 0.0, 1.0) : 1.0;
    look.colour_map = texture(base.texture, true);
    look.surface_map = texture(pbr.metallicRoughnessTexture.index, false);
    // glTF's default metal is 1, which files that never thought of it do not mean.
    if (!look.surface_map && look.metalness > 0.9) look.metalness = 0.0;
    look.normal_map = texture(material.normalTexture.index, false);
    look.normal_strength = material.normalTexture.scale;
    if (material.emissiveTexture.index < 0) look.glow = encoded(material.emissiveFactor);
    look.is_two_sided = material.doubleSided;
    if (material.alphaMode == "MASK") look.alpha_cutoff = material.alphaCutoff;
    if (material.alphaMode == "BLEND") look.is_blended = true;
    if (!look.is_blended) look.opacity = 1.0;
    // White and grey are what exporters write where nobody chose a colour.
    look.has_material = look.colour_map || look.colour.maxCoeff() - look.colour.minCoeff() > 0.02;
    return base;
  }

  void read_vertices(const tinygltf::Primitive& primitive, const MapPlace& place, PrimitiveLook& look) const {
    const std::string path = "'" + name_ + "': a material's ";
    const auto position = primitive.attributes.find("POSITION");
    if (position == primitive.attributes.end()) return;
    const size_t count = gltf::accessor_view(model_, position->second, path + "vertices").count;
    const auto uv = primitive.attributes.find("TEXCOORD_" + std::to_string(place.set));
    if (uv != primitive.attributes.end()) {
      const std::vector<float> flat = gltf::decode_floats(model_, uv->second, path + "texture coordinates");
      if (flat.size() == 2 * count)
        for (size_t i = 0; i < count; ++i)
          look.uvs.push_back(place(Vec2(flat[2 * i], flat[2 * i + 1])));
    }
    const auto colour = primitive.attributes.find("COLOR_0");
    if (colour != primitive.attributes.end()) {
      const gltf::AccessorView view = gltf::accessor_view(model_, colour->second, path + "colours");
      const std::vector<float> flat = gltf::decode_floats(model_, colour->second, path + "colours");
      if (view.count == count && flat.size() == count * view.components && view.components >= 3)
        for (size_t i = 0; i < count; ++i) {
          const float* c = &flat[i * view.components];
          look.colours.push_back(encoded(std::vector<double>{c[0], c[1], c[2]}).cwiseProduct(look.colour));
        }
    }
  }

  std::shared_ptr<const Texture> texture(int index, bool is_srgb) {
    if (index < 0 || index >= static_cast<int>(model_.textures.size())) return nullptr;
    const int source = model_.textures[static_cast<size_t>(index)].source;
    if (source < 0 || source >= static_cast<int>(model_.images.size())) {
      warn("a texture's picture is in a form that is not shown (WebP or KTX2)");
      return nullptr;
    }
    const auto [entry, is_new] = decoded_.try_emplace({source, is_srgb});
    if (is_new) {
      entry->second = decode_texture(bytes_of(model_.images[static_cast<size_t>(source)]), is_srgb,
                                     options_.largest_texture);
      if (!entry->second) warn("picture " + std::to_string(source) + " is no PNG or JPEG that can be shown");
    }
    return entry->second;
  }

  std::span<const uint8_t> bytes_of(const tinygltf::Image& image) {
    if (image.bufferView < 0 || image.bufferView >= static_cast<int>(model_.bufferViews.size())) return {};
    const tinygltf::BufferView& view = model_.bufferViews[static_cast<size_t>(image.bufferView)];
    if (view.buffer < 0 || view.buffer >= static_cast<int>(model_.buffers.size())) return {};
    const std::vector<unsigned char>& data = model_.buffers[static_cast<size_t>(view.buffer)].data;
    if (view.byteOffset > data.size() || view.byteLength > data.size() - view.byteOffset) return {};
    return {data.data() + view.byteOffset, view.byteLength};
  }

  void warn(const std::string& what) {
    const std::string line = "'" + name_ + "': " + what + ": drawn without it";
    if (std::find(warnings_.begin(), warnings_.end(), line) == warnings_.end()) warnings_.push_back(line);
  }

  const tinygltf::Model& model_;
  const std::string& name_;
  const Appearance::Options& options_;
  std::vector<std::string>& warnings_;
  std::map<std::pair<int, bool>, std::shared_ptr<Texture>> decoded_;
};

}  // namespace

Appearance Appearance::read(std::span<const uint8_t> glb, const std::string& name, const Options& options) {
  Appearance appearance;
  const tinygltf::Model model = gltf::load_model(glb, name);
  Reader reader(model, name, options, appearance.warnings_);
  for (size_t m = 0; m < model.meshes.size(); ++m)
    for (size_t p = 0; p < model.meshes[m].primitives.size(); ++p)
      appearance.looks_[{static_cast<uint32_t>(m), static_cast<uint32_t>(p)}] =
          reader.look(model.meshes[m].primitives[p]);
  return appearance;
}

const PrimitiveLook& Appearance::of(uint32_t mesh, uint32_t primitive) const {
  static const PrimitiveLook plain;
  const auto found = looks_.find({mesh, primitive});
  return found == looks_.end() ? plain : found->second;
}

}  // namespace fascia::view
