#include "runtime/face.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <string>

#include "geometry/smoothstep.h"
#include "runtime/fnv.h"

namespace fascia::runtime {
namespace {

std::size_t chosen_level(const Asset& asset, int32_t level) {
  const std::size_t levels = asset.rig().tissue.levels.size();
  if (level == -1) return levels - 1;
  require(level >= 0 && static_cast<std::size_t>(level) < levels, "the rig has no such level of detail");
  return static_cast<std::size_t>(level);
}

constexpr std::size_t most_touches = 64, most_influences = 8;  // the latter of the builder's rigs

}  // namespace

Eigen::Matrix3f eye_rotation(float yaw, float pitch) {
  if (yaw == 0.0F && pitch == 0.0F) return Eigen::Matrix3f::Identity();
  return (Eigen::AngleAxisf(yaw, Vec3f::UnitY()) * Eigen::AngleAxisf(-pitch, Vec3f::UnitX()))
      .toRotationMatrix();
}

Face::Face(std::shared_ptr<const Asset> asset, const fascia_face_options& options)
    : asset_(std::move(asset)), options_(options), mixer_(*asset_) {
  bones_.eye_centres = {asset_->rig().skull.eye_left.centre, asset_->rig().skull.eye_right.centre};
  touches_.reserve(most_touches * most_influences);
  compression_.resize(asset_->primitives().size());
  take_level(chosen_level(*asset_, options.level));
  for (const auto& shape : asset_->shapes(level_, options.space))
    meshes_.emplace_back(*shape);
}

void Face::take_level(std::size_t level) {
  const sim::FaceModel& model = asset_->model(level);
  asset_->shapes(level, options_.space);  // made before anything changes, as it may fail
  auto solver = make_solver(options_, *asset_, level);
  level_ = level;
  model_ = &model;
  solver_ = std::move(solver);
  sensitivity_.reset();
  is_linearised_ = false;
  const rig::TissueLevel& tissue = asset_->rig().tissue.levels[level];
  displacements_.assign(tissue.rest.size(), Vec3f::Zero());
  nodes_.clear();
  fibre_points_ = tissue.fibre_rest;
  touches_.clear();
  face_centre_.setZero();
  for (const sim::Vec3& place : model_->rest())
    face_centre_ += place / static_cast<double>(model_->rest().size());
  bones_.displacements = displacements_;
}

void Face::set_level(int32_t level, float seconds) {
  const std::size_t chosen = chosen_level(*asset_, level);
  if (chosen == level_) return;
  take_level(chosen);
  solver_->settle(controls());
  shown_jaw_ = jaw_;
  head_.known = 0;
  find_bones();
  const auto& shapes = asset_->shapes(level_, options_.space);
  for (std::size_t i = 0; i < meshes_.size(); ++i)
    meshes_[i].change_shape(*shapes[i], bones_, seconds > 0.0F);
  fade_length_ = seconds;
  fade_passed_ = 0.0F;
}

uint64_t Face::state_kind() const {
  const uint64_t rig = asset_->contents();
  Fnv1a kind;
  kind.add(&rig, sizeof rig);
  kind.add(&level_, sizeof level_);
  kind.add(&options_.solver, sizeof options_.solver);
  return kind.value();
}

bool Face::has_layers_of(const uint8_t* bytes, std::size_t size) const {
  return mixer_.has_layers_of({bytes, size});
}

bool Face::exchange_state(sim::StateBytes& bytes) {
  if (!mixer_.exchange_state(bytes)) return false;
  bytes.value(jaw_);
  bytes.value(shown_jaw_);
  bytes.value(acceleration_);
  bytes.value(inertia_);
  bytes.value(head_.place);
  for (double* number : {&head_.scale, head_.centre.data(), head_.centre.data() + 1, head_.centre.data() + 2,
                         head_.velocity.data(), head_.velocity.data() + 1, head_.velocity.data() + 2})
    bytes.value(*number);
  auto known = static_cast<uint32_t>(head_.known), is_moved = static_cast<uint32_t>(head_.is_moved),
       touches = static_cast<uint32_t>(touches_.size());
  for (uint32_t* number : {&known, &is_moved, &touches})
    bytes.value(*number);
  if (bytes.reads()) {
    if (known > 2 || touches > touches_.capacity()) return false;
    head_.known = static_cast<int>(known);
    head_.is_moved = is_moved != 0;
    touches_.resize(touches);
  }
  for (sim::NodeForce& touch : touches_) {
    bytes.value(touch.node);
    bytes.value(touch.force);
  }
  if (!solver_->exchange_state(bytes) || bytes.is_short()) return false;
  if (!bytes.reads()) return true;
  for (BoundMesh& mesh : meshes_)
    mesh.let_go();
  fade_length_ = fade_passed_ = 0.0F;
  follow();
  return std::all_of(displacements_.begin(), displacements_.end(),
                     [](const Vec3f& moved) { return moved.allFinite(); });
}

sim::JawPose Face::wanted_jaw(std::span<const float> channels) const {
  const BoneChannels& bones = asset_->bones();
  const auto value = [&](int32_t channel) {
    return channel < 0 ? 0.0F : channels[static_cast<std::size_t>(channel)];
  };
  return sim::clamped(asset_->jaw_muscles().moved(
      {value(bones.jaw_open), value(bones.jaw_forward), value(bones.jaw_lateral)}, channels));
}

sim::Controls Face::controls() const {
  sim::Controls controls;
  controls.activations = mixer_.effective();
  controls.jaw = jaw_;
  controls.acceleration = acceleration_ + inertia_;
  controls.touches = touches_;
  return controls;
}

void Face::find_bones() {
  solver_->displacements(displacements_);
  is_linearised_ = false;
  const BoneChannels& channels = asset_->bones();
  bones_.jaw = sim::jaw_transform(model_->jaw(), shown_jaw_);
  for (std::size_t eye = 0; eye < 2; ++eye)
    bones_.eyes[eye] =
        eye_rotation(mixer_.effective(channels.eye_yaw[eye]), mixer_.effective(channels.eye_pitch[eye]));
}

void Face::follow() {
  find_bones();
  for (BoundMesh& mesh : meshes_)
    mesh.follow(bones_, held_share());
}

float Face::held_share() const {
  if (fade_passed_ >= fade_length_) return 0.0F;
  return 1.0F - smoothstep(fade_passed_ / fade_length_);
}

void Face::move_head(const Eigen::Matrix4f& place, float inertia_scale) {
  head_.place = place.cast<double>();
  head_.scale = inertia_scale;
  head_.is_moved = true;
}

sim::Vec3 Face::inertia(double seconds) {
  constexpr double teleport = 0.5, largest = 60.0;  // metres in one step; m/s^2, some six times gravity
  if (!head_.is_moved || seconds <= 0.0) return sim::Vec3::Zero();
  const Eigen::Matrix3d turn = head_.place.topLeftCorner<3, 3>();
  const sim::Vec3 centre = turn * face_centre_ + head_.place.topRightCorner<3, 1>();
  const sim::Vec3 moved = centre - head_.centre;
  if (head_.known > 0 && moved.norm() > teleport) head_.known = 0;
  const sim::Vec3 velocity = head_.known > 0 ? sim::Vec3(moved / seconds) : sim::Vec3(sim::Vec3::Zero());
  sim::Vec3 felt = sim::Vec3::Zero();
  if (head_.known > 1) felt = -head_.scale * (turn.transpose() * ((velocity - head_.velocity) / seconds));
  if (felt.norm() > largest) felt *= largest / felt.norm();
  head_.centre = centre;
  head_.velocity = velocity;
  head_.known = std::min(head_.known + 1, 2);
  return felt;
}

bool Face::touch(std::size_t mesh, std::size_t vertex, const sim::Vec3& force) {
  const rig::Binding* binding = asset_->binding(level_, mesh);
  if (binding == nullptr) return true;  // what stands still cannot be pressed
  if (touches_.size() + binding->influences > touches_.capacity()) return false;
  for (std::size_t i = vertex * binding->influences; i < (vertex + 1) * binding->influences; ++i)
    if (binding->weights[i] != 0.0F)
      touches_.push_back({binding->nodes[i], static_cast<double>(binding->weights[i]) * force});
  return true;
}

const std::vector<Vec3f>& Face::compression(std::size_t mesh) {
  std::vector<Vec3f>& compression = compression_[mesh];
  strain_.resize(model_->lattice().columns);
  sim::skin_strain(*model_, displacements_, strain_);
  compression.assign(asset_->primitives()[mesh].positions.size(), Vec3f::Zero());
  const rig::Binding* binding = asset_->binding(level_, mesh);
  if (binding == nullptr) return compression;
  for (std::size_t v = 0; v < compression.size(); ++v) {
    sim::Strain sum = sim::Strain::Zero();
    for (std::size_t i = v * binding->influences; i < (v + 1) * binding->influences; ++i)
      if (binding->nodes[i] < strain_.size()) sum += binding->weights[i] * strain_[binding->nodes[i]];
    compression[v] = sim::strongest_compression(sum);
  }
  return compression;
}

void Face::pose() {
  fade_passed_ = fade_length_;
  head_.known = 0;
  inertia_.setZero();
  mixer_.gather(0.0);
  jaw_ = wanted_jaw(mixer_.effective());
  solver_->settle(controls());
  shown_jaw_ = jaw_;
  follow();
}

bool Face::step(double seconds) {
  inertia_ = inertia(seconds);
  mixer_.gather(std::isfinite(seconds) ? seconds : 0.0);
  fade_passed_ = std::min(fade_length_, fade_passed_ + static_cast<float>(seconds));
  if (std::isfinite(seconds)) {
    seconds = std::min(seconds, solver_->longest_frame());  // what the solver loses is lost for the jaw too
    jaw_ =
        sim::approached(jaw_, wanted_jaw(mixer_.effective()), seconds, asset_->rig().skull.jaw.travel_time);
  }
  const bool is_sound = solver_->step(seconds, controls()).status == sim::StepStatus::done;
  shown_jaw_ = solver_->shown_jaw(jaw_);
  follow();
  return is_sound;
}

void Face::reset() {
  fade_passed_ = fade_length_;
  head_.known = 0;
  inertia_.setZero();
  mixer_.gather(0.0);
  jaw_ = wanted_jaw(mixer_.effective());
  solver_->reset(controls());
  shown_jaw_ = jaw_;
  follow();
}

const std::vector<Vec3f>& Face::nodes() {
  nodes_ = asset_->rig().tissue.levels[level_].rest;
  for (std::size_t i = 0; i < nodes_.size(); ++i)
    nodes_[i] += displacements_[i];
  return nodes_;
}

const sim::Sensitivity& Face::sensitivity() {
  if (is_linearised_) return *sensitivity_;
  if (!sensitivity_) sensitivity_ = std::make_unique<sim::Sensitivity>(*model_);
  sim::Positions places = model_->rest();
  for (std::size_t i = 0; i < places.size(); ++i)
    places[i] += displacements_[i].cast<double>();
  if (!sensitivity_->linearise(controls(), places))
    throw Failure(FASCIA_ERROR_DIVERGED, "the pose has no derivatives: its curvature could not be factored");
  is_linearised_ = true;
  return *sensitivity_;
}

const std::vector<Vec3f>& Face::fibre_points() {
  const rig::TissueLevel& level = asset_->rig().tissue.levels[level_];
  for (std::size_t p = 0; p < fibre_points_.size(); ++p) {
    fibre_points_[p] = level.fibre_rest[p];
    if (level.fibre_anchor[p] == rig::FibreEnd::cranium) continue;
    if (level.fibre_anchor[p] == rig::FibreEnd::mandible) {
      fibre_points_[p] = (bones_.jaw * level.fibre_rest[p].cast<double>()).cast<float>();
      continue;
    }
    for (int k = 0; k < 3; ++k)
      fibre_points_[p] +=
          level.fibre_weights[p][k] * displacements_[level.fibre_nodes[p][static_cast<std::size_t>(k)]];
  }
  return fibre_points_;
}

}  // namespace fascia::runtime
