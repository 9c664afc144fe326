#include "tests/builder/swept_face.h"

#include <algorithm>
#include <cmath>

#include "geometry/error.h"
#include "sim/energies.h"

namespace fascia::testing {
namespace {

constexpr uint32_t least_members = 2, most_members = 5;

/// The columns' skin as a mesh.
TriangleMesh skin_layer(const rig::TissueLevel& level) {
  TriangleMesh mesh;
  for (uint32_t c = 0; c < level.columns; ++c)
    mesh.vertices.push_back(level.rest[c].cast<double>());
  for (const auto& t : level.triangles)
    mesh.triangles.push_back({static_cast<int>(t[0]), static_cast<int>(t[1]), static_cast<int>(t[2])});
  return mesh;
}

}  // namespace

SweptFace::SweptFace(std::shared_ptr<const runtime::Asset> asset, size_t level, const rig::TissueLevel& marks)
    : asset_(std::move(asset)),
      model_(&asset_->model(level)),
      face_(asset_->realtime_model(level), asset_->channel_names.size()),
      values_(asset_->channel_rest),
      displacements_(model_->rest().size(), sim::Vec3f::Zero()) {
  bones_.displacements = displacements_;
  lattice_ = std::make_unique<Crossings>(skin_layer(marks), column_sides(marks, 0));
  std::vector<uint8_t> sides;
  for (size_t i = 0; i < asset_->primitives().size(); ++i) {
    const rig::Binding* binding = asset_->binding(level, i);
    if (binding == nullptr || binding->part != "skin") continue;
    meshes_.emplace_back(*asset_->shapes(level, FASCIA_SPACE_METRES)[i]);
    const auto first = static_cast<int>(sides.size());
    const std::vector<uint8_t> own = vertex_sides(*binding, marks);
    sides.insert(sides.end(), own.begin(), own.end());
    for (const auto& t : asset_->primitives()[i].triangles)
      triangles_.push_back(
          {first + static_cast<int>(t[0]), first + static_cast<int>(t[1]), first + static_cast<int>(t[2])});
  }
  rendered_ = std::make_unique<Crossings>(skin(), sides);
}

void SweptFace::relax() {
  values_ = asset_->channel_rest;
}

void SweptFace::add(const runtime::Target& target, float value) {
  if (target.kind == runtime::Target::Kind::channel)
    values_[target.index] += value;
  else
    asset_->members()[target.index].add(value, values_);
  for (size_t c = 0; c < values_.size(); ++c)
    values_[c] = std::clamp(values_[c], asset_->channel_minimum[c], asset_->channel_maximum[c]);
}

void SweptFace::add(const std::string& name, float value) {
  const auto target = asset_->find(name);
  if (!target) throw Error("the rig has neither a channel nor a member '" + name + "'");
  add(*target, value);
}

std::vector<std::string> SweptFace::shapes() const {
  std::vector<std::string> names;
  for (const rig::NamedSet& set : asset_->rig().actuation.sets)
    if (set.name == "arkit")
      for (const std::string& member : set.members)
        names.push_back("arkit:" + member);
  return names;
}

void SweptFace::draw(std::mt19937& random) {
  const auto chance = [&] { return static_cast<float>(random() % 10000U) / 9999.0F; };
  relax();
  if (random() % 2U == 0) {
    const std::vector<std::string> names = shapes();
    const uint32_t count =
        least_members + static_cast<uint32_t>(random() % (most_members - least_members + 1));
    for (uint32_t k = 0; !names.empty() && k < count; ++k) {
      const std::string& name = names[random() % names.size()];
      add(name, chance());
    }
    return;
  }
  for (size_t c = 0; c < values_.size(); ++c) {
    const bool is_active = random() % 4U == 0;
    const float value =
        asset_->channel_minimum[c] + chance() * (asset_->channel_maximum[c] - asset_->channel_minimum[c]);
    if (is_active) values_[c] = value;
  }
}

sim::JawPose SweptFace::wanted_jaw() const {
  const runtime::BoneChannels& bones = asset_->bones();
  const auto value = [&](int32_t channel) {
    return channel < 0 ? 0.0F : values_[static_cast<size_t>(channel)];
  };
  return sim::clamped(asset_->jaw_muscles().moved(
      {value(bones.jaw_open), value(bones.jaw_forward), value(bones.jaw_lateral)}, values_));
}

void SweptFace::pass(double seconds) {
  jaw_ = sim::approached(jaw_, wanted_jaw(), seconds, asset_->rig().skull.jaw.travel_time);
}

sim::Controls SweptFace::drive() const {
  sim::Controls drive;
  drive.activations = values_;
  drive.jaw = jaw_;
  drive.acceleration = acceleration_;
  drive.touches = touches_;
  return drive;
}

void SweptFace::follow() {
  face_.displacements(displacements_);
  bones_.jaw = sim::jaw_transform(model_->jaw(), jaw_);
  for (runtime::BoundMesh& mesh : meshes_)
    mesh.follow(bones_);
}

void SweptFace::pose() {
  jaw_ = wanted_jaw();
  sim::PoseOptions options;
  options.solver.iterations = 400;
  face_.settle(drive(), options);
  follow();
}

bool SweptFace::step(double seconds) {
  pass(seconds);
  const bool is_sound = face_.step(seconds, drive()).status == sim::StepStatus::done;
  follow();
  return is_sound;
}

TriangleMesh SweptFace::skin() const {
  TriangleMesh mesh{{}, triangles_};
  for (runtime::BoundMesh& part : meshes_)
    for (const sim::Vec3f& p : part.positions(bones_))
      mesh.vertices.push_back(p.cast<double>());
  return mesh;
}

int SweptFace::turned_prisms() const {
  std::vector<Vec3> now(displacements_.size());
  for (size_t i = 0; i < now.size(); ++i)
    now[i] = model_->rest()[i] + displacements_[i].cast<double>();
  int turned = 0;
  for (const sim::Prism& prism : model_->prisms())
    if (!(sim::prism_volume(prism.nodes, now.data()) > 0.0)) ++turned;
  return turned;
}

SweptFace::State SweptFace::state(double tolerance) const {
  State state;
  std::vector<Vec3> columns(model_->lattice().columns);
  for (size_t i = 0; i < displacements_.size(); ++i)
    state.is_finite = state.is_finite && displacements_[i].allFinite();
  if (!state.is_finite) return state;
  state.turned_prisms = turned_prisms();
  for (size_t c = 0; c < columns.size(); ++c)
    columns[c] = model_->rest()[c] + displacements_[c].cast<double>();
  const std::vector<Vec3> vertices = skin().vertices;
  for (int opening = 0; opening < 3; ++opening) {
    state.lattice[static_cast<size_t>(opening)] = lattice_->find(columns, opening, tolerance);
    state.rendered[static_cast<size_t>(opening)] = rendered_->find(vertices, opening, tolerance);
  }
  return state;
}

void SweptFace::State::take(const State& other) {
  is_finite = is_finite && other.is_finite;
  turned_prisms += other.turned_prisms;
  for (size_t k = 0; k < 3; ++k) {
    lattice[k].take(other.lattice[k]);
    rendered[k].take(other.rendered[k]);
  }
}

}  // namespace fascia::testing
