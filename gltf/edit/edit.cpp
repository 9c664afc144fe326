#include "gltf/edit/edit.h"

#include "geometry/error.h"
#include "gltf/read/container.h"

namespace fascia::gltf {
namespace {

/// Tells buffer 0 how long the binary chunk is.
void say_length(Json& root, std::size_t length) {
  if (length == 0) return;
  if (!root.contains("buffers") || root["buffers"].empty()) root["buffers"] = Json::array({Json::object()});
  root["buffers"][0]["byteLength"] = length;
}

}  // namespace

Edit::Edit(Document document)
    : json(parsed(document.json, "head")), bin_(std::move(document.bin)), appendix_(json, bin_) {}

Json& Edit::primitive(uint32_t mesh, uint32_t index) {
  if (!json.contains("meshes") || mesh >= json["meshes"].size() ||
      index >= json["meshes"][mesh].value("primitives", Json::array()).size())
    throw Error("mesh " + std::to_string(mesh) + " primitive " + std::to_string(index) +
                " is not in the file");
  return json["meshes"][mesh]["primitives"][index];
}

std::vector<std::size_t> Edit::nodes_of(uint32_t mesh) const {
  std::vector<std::size_t> nodes;
  if (!json.contains("nodes")) return nodes;
  for (std::size_t n = 0; n < json["nodes"].size(); ++n)
    if (json["nodes"][n].contains("mesh") && json["nodes"][n]["mesh"] == mesh) nodes.push_back(n);
  return nodes;
}

const tinygltf::Model& Edit::model() {
  if (!model_) model_ = std::make_shared<const tinygltf::Model>(load_model(bytes(), "head"));
  return *model_;
}

Document Edit::document() const {
  Json out = json;
  say_length(out, bin_.size());
  return {text_of(out), bin_};
}

std::vector<uint8_t> Edit::bytes() const {
  Json out = json;
  say_length(out, bin_.size());
  return glb_bytes(text_of(out), bin_);
}

Edit::Parts Edit::parts() {
  say_length(json, bin_.size());
  GlbFrame frame = glb_frame(text_of(json), bin_.size());
  return {std::move(frame.before), bin_, std::move(frame.after)};
}

}  // namespace fascia::gltf
