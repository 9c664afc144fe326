#include "gltf/edit/edit.h"

#include "geometry/error.h"
#include "gltf/read/container.h"

namespace fascia::gltf {

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

std::vector<uint8_t> Edit::bytes() const {
  Json out = json;
  if (!bin_.empty()) {
    if (!out.contains("buffers")) out["buffers"] = Json::array({Json::object()});
    out["buffers"][0]["byteLength"] = bin_.size();
  }
  return glb_bytes(text_of(out), bin_);
}

Edit::Parts Edit::parts() {
  if (!bin_.empty()) {
    if (!json.contains("buffers")) json["buffers"] = Json::array({Json::object()});
    json["buffers"][0]["byteLength"] = bin_.size();
  }
  GlbFrame frame = glb_frame(text_of(json), bin_.size());
  return {std::move(frame.before), bin_, std::move(frame.after)};
}

}  // namespace fascia::gltf
