#include "bench/expressions/sculpted_head.h"

#include <sys/wait.h>

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <iterator>

#include "builder/rigging/embedded_head.h"
#include "formats/morph_shapes.h"
#include "formats/scene.h"
#include "geometry/error.h"
#include "runtime/drivers/response.h"
#include "tests/paths/paths.h"

namespace fascia::bench {
namespace {

namespace fs = std::filesystem;

/// ICT-FaceKit's head mesh lists its face first; neck and the linings of mouth and eye sockets follow.
constexpr size_t ict_face_vertices = 9916;

uint64_t hash_of(const fs::path& path, uint64_t hash = 1469598103934665603ULL) {
  std::ifstream file(path, std::ios::binary);
  for (std::istreambuf_iterator<char> at(file), end; at != end; ++at)  // FNV-1a
    hash = (hash ^ static_cast<uint8_t>(*at)) * 1099511628211ULL;
  return hash;
}

std::string quoted(const fs::path& path) {
  return "'" + path.string() + "'";
}

/// ARKit's own name: some makers write `browDown_L`.
std::string arkit_name(const std::string& name) {
  if (name.size() < 2 || name[name.size() - 2] != '_') return name;
  const std::string stem = name.substr(0, name.size() - 2);
  return name.back() == 'L' ? stem + "Left" : name.back() == 'R' ? stem + "Right" : name;
}

}  // namespace

std::vector<SculptedHead> sculpted_heads() {
  const fs::path data = test::measured_data() / "data";
  std::vector<SculptedHead> heads;
  const auto add = [&](const std::string& family, const fs::path& head, const fs::path& shapes) {
    if (fs::exists(head)) heads.push_back({head.stem().string(), family, head, shapes, {}});
  };
  add("ict", data / "ict/neutral.glb", data / "ict/expressions.glb");
  for (int person = 0; person < 6; ++person)
    add("ict", data / "ict" / ("person_" + std::to_string(person) + ".glb"), data / "ict/expressions.glb");
  const auto own = [&](const std::string& family, const char* name) {
    const fs::path file = data / "wild" / (std::string(name) + ".glb");
    add(family, file, file);
  };
  own("avatar", "rpm_avatar");
  own("avatar", "brunette_t");
  own("avatar", "asian_business");
  own("facecap", "facecap_plain");
  return heads;
}

SculptedHead generic_head() {
  const fs::path head = fs::temp_directory_path() / "fascia_embedded_head.obj";
  rigging::write_embedded_head(head, fs::path(head).replace_extension(".mrk.json"));
  return {"embedded", "generic", head, {}, {}};
}

fs::path rig_of(const SculptedHead& head, const std::string& detail) {
  const fs::path folder = fs::temp_directory_path() / "fascia_bench_rigs";
  fs::create_directories(folder);
  static const uint64_t tool = hash_of(test::tool());
  char key[32];
  std::snprintf(key, sizeof key, "%016llx", static_cast<unsigned long long>(hash_of(head.head, tool)));
  const bool is_kept = head.anatomy.empty();
  const std::string stem = head.name + "_" + detail + "_";
  const fs::path rig = folder / (stem + (is_kept ? key : "corrected") + ".glb");
  if (is_kept && fs::exists(rig)) return rig;
  for (const auto& old : fs::directory_iterator(folder))  // of another tool or head
    if (old.path().filename().string().rfind(stem, 0) == 0) fs::remove(old.path());
  const fs::path answer = folder / (stem + "answer.txt");
  std::string command =
      quoted(test::tool()) + " build " + quoted(head.head) + " -o " + quoted(rig) + " --detail " + detail;
  if (!is_kept) command += " --anatomy " + quoted(head.anatomy);
  const int status = std::system((command + " --threads 1 --quiet >" + quoted(answer) + " 2>&1").c_str());
  if (!fs::exists(rig)) {
    std::ifstream file(answer);
    throw Error(head.name + " (" + std::to_string(WEXITSTATUS(status)) +
                "): " + std::string(std::istreambuf_iterator<char>(file), {}));
  }
  return rig;
}

KnownFace::KnownFace(const SculptedHead& head, const std::string& detail) : head_(head) {
  const fs::path rig = rig_of(head, detail);
  subject_ = std::make_unique<fit::Subject>(rig::read(formats::read_bytes(rig), rig.string()), detail);
  read_shapes();
}

void KnownFace::read_shapes() {
  const formats::Scene scene = formats::read(head_.shapes);
  const std::vector<formats::Shape> shapes = formats::morph_shapes(scene);
  // The skin is the largest mesh that the shapes move; people share the shapes of another file's mesh `head`.
  const bool is_own = head_.head == head_.shapes;
  const auto is_same = [&](const rig::Primitive& primitive, const formats::ShapePart& part) {
    return is_own ? static_cast<int>(primitive.mesh) == part.mesh &&
                        static_cast<int>(primitive.primitive) == part.primitive
                  : primitive.name == "head";
  };
  const auto& primitives = subject_->file().primitives;
  size_t skin = primitives.size(), count = 0;
  for (const formats::Shape& shape : shapes)
    for (const formats::ShapePart& part : shape.parts)
      for (size_t p = 0; p < primitives.size(); ++p)
        if (is_same(primitives[p], part) && part.displacements.size() > count) {
          skin = p;
          count = part.displacements.size();
        }
  if (skin == primitives.size()) throw Error(head_.name + ": its shapes move none of the rig's meshes");
  if (head_.family == "ict") count = ict_face_vertices;
  const size_t first = subject_->first_vertex(skin);
  for (size_t v = 0; v < count; ++v)
    face_.push_back(first + v);
  for (const auto& t : primitives[skin].triangles)
    if (std::all_of(t.begin(), t.end(), [&](auto v) { return static_cast<size_t>(v) < count; }))
      triangles_.push_back({static_cast<int>(t[0]), static_cast<int>(t[1]), static_cast<int>(t[2])});
  const Mat3 linear = subject_->to_metres(skin).topLeftCorner<3, 3>();
  for (const formats::Shape& shape : shapes) {
    const std::string name = arkit_name(shape.name);
    Eigen::VectorXd truth = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(3 * count));
    for (const formats::ShapePart& part : shape.parts)
      if (is_same(primitives[skin], part))
        for (size_t v = 0; v < count && v < part.displacements.size(); ++v)
          truth.segment<3>(static_cast<Eigen::Index>(3 * v)) = linear * part.displacements[v];
    if (truth.squaredNorm() > 0.0) shapes_[name] = {{{name, 1.0}}, truth};
  }
  if (const auto close = shapes_.find("mouthClose"); close != shapes_.end() && shapes_.contains("jawOpen")) {
    close->second.values["jawOpen"] = 1.0;
    close->second.truth += shapes_.at("jawOpen").truth;
  }
}

std::vector<float> KnownFace::activations(const anatomy::ExpressionSet& table,
                                          const std::map<std::string, double>& values) const {
  const auto& channels = subject_->channels();
  std::vector<float> result;
  for (const rig::Channel& channel : channels)
    result.push_back(channel.rest);
  for (const auto& [name, value] : values) {
    const anatomy::Expression* row = table.find(name);
    if (row == nullptr) continue;
    const std::vector<float> knots(table.response_weights.begin(), table.response_weights.end());
    const std::vector<float> response(row->response.begin(), row->response.end());
    const float share = response.empty()
                            ? static_cast<float>(value)
                            : runtime::Response(knots, response).share(static_cast<float>(value));
    for (const auto& [actuator, weight] : row->weights) {
      const int32_t at = subject_->channel(actuator);
      if (at < 0) continue;
      const auto c = static_cast<size_t>(at);
      result[c] +=
          static_cast<float>(weight) * (channels[c].group == "eye" ? static_cast<float>(value) : share);
    }
  }
  for (size_t c = 0; c < channels.size(); ++c)
    result[c] = std::clamp(result[c], channels[c].minimum, channels[c].maximum);
  return result;
}

Eigen::VectorXd KnownFace::pose(const std::vector<float>& activations) {
  subject_->pose(activations, false);
  return face_rows(subject_->displacements(activations));
}

Eigen::VectorXd KnownFace::face_rows(const Eigen::VectorXd& all) const {
  Eigen::VectorXd rows(static_cast<Eigen::Index>(3 * face_.size()));
  for (size_t v = 0; v < face_.size(); ++v)
    rows.segment<3>(static_cast<Eigen::Index>(3 * v)) =
        all.segment<3>(static_cast<Eigen::Index>(3 * face_[v]));
  return rows;
}

}  // namespace fascia::bench
