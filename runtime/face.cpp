#include "runtime/face.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace fascia::runtime {
namespace {

/// Rotation of an eye: yaw to the subject's left about +Y, then pitch upward about the head's lateral axis.
Eigen::Matrix3f eye_rotation(float yaw, float pitch) {
  if (yaw == 0.0F && pitch == 0.0F) return Eigen::Matrix3f::Identity();
  return (Eigen::AngleAxisf(yaw, Vec3f::UnitY()) * Eigen::AngleAxisf(-pitch, Vec3f::UnitX()))
      .toRotationMatrix();
}

float finite(float value) {
  return std::isfinite(value) ? value : 0.0F;
}

std::size_t chosen_level(const Asset& asset, int32_t level) {
  const std::size_t levels = asset.rig().tissue.levels.size();
  if (level == -1) return levels - 1;
  require(level >= 0 && static_cast<std::size_t>(level) < levels, "the rig has no such level of detail");
  return static_cast<std::size_t>(level);
}

}  // namespace

Face::Face(std::shared_ptr<const Asset> asset, const fascia_face_options& options)
    : asset_(std::move(asset)), level_(chosen_level(*asset_, options.level)) {
  const std::size_t channels = asset_->channel_names.size();
  model_ = &asset_->model(level_);
  solver_ = make_solver(options, *asset_, level_);
  values_ = effective_ = asset_->channel_rest;
  curve_channels_.assign(channels, 0.0F);
  taken_ = taken_weight_ = curve_channels_;
  members_.assign(asset_->members().size(), 0.0F);
  curve_members_ = members_;
  const rig::Rig& rig = asset_->rig();
  displacements_.assign(rig.tissue.levels[level_].rest.size(), Vec3f::Zero());
  fibre_points_ = rig.tissue.levels[level_].fibre_rest;
  touches_.reserve(256);
  for (const sim::Vec3& place : model_->rest())
    face_centre_ += place / static_cast<double>(model_->rest().size());
  bones_.displacements = displacements_;
  bones_.eye_centres = {rig.skull.eye_left.centre, rig.skull.eye_right.centre};
  for (const auto& shape : asset_->shapes(level_, options.space))
    meshes_.emplace_back(*shape);
}

void Face::set(const Target& target, float value) {
  (target.kind == Target::Kind::channel ? values_ : members_)[target.index] = value;
}

float Face::get(const Target& target) const {
  return (target.kind == Target::Kind::channel ? values_ : members_)[target.index];
}

void Face::clear() {
  values_ = asset_->channel_rest;
  std::fill(members_.begin(), members_.end(), 0.0F);
}

void Face::add(const Target& target, float value, float weight) {
  if (target.kind == Target::Kind::channel)
    curve_channels_[target.index] += weight * (value - asset_->channel_rest[target.index]);
  else
    curve_members_[target.index] += weight * value;
}

void Face::take_over(uint32_t channel, float value, float weight) {
  taken_[channel] += weight * value;
  taken_weight_[channel] += weight;
}

void Face::gather() {
  for (std::size_t c = 0; c < values_.size(); ++c)
    effective_[c] =
        (std::isfinite(values_[c]) ? values_[c] : asset_->channel_rest[c]) + finite(curve_channels_[c]);
  for (std::size_t m = 0; m < members_.size(); ++m) {
    const float value = finite(members_[m]) + finite(curve_members_[m]);
    if (value == 0.0F) continue;
    for (const auto& [channel, weight] : asset_->members()[m].entries)
      effective_[channel] += weight * value;
  }
  for (std::size_t c = 0; c < effective_.size(); ++c) {
    if (taken_weight_[c] <= 0.0F || !std::isfinite(taken_[c])) continue;
    const float share = std::min(taken_weight_[c], 1.0F);
    effective_[c] = (1.0F - share) * effective_[c] + taken_[c] * (share / taken_weight_[c]);
  }
  std::fill(taken_.begin(), taken_.end(), 0.0F);
  std::fill(taken_weight_.begin(), taken_weight_.end(), 0.0F);
  for (std::size_t c = 0; c < effective_.size(); ++c)
    effective_[c] = std::clamp(effective_[c], asset_->channel_minimum[c], asset_->channel_maximum[c]);
  std::fill(curve_channels_.begin(), curve_channels_.end(), 0.0F);
  std::fill(curve_members_.begin(), curve_members_.end(), 0.0F);
}

sim::JawPose Face::wanted_jaw() const {
  const BoneChannels& channels = asset_->bones();
  return sim::clamped(asset_->jaw_muscles().moved(
      {effective(channels.jaw_open), effective(channels.jaw_forward), effective(channels.jaw_lateral)},
      effective_));
}

sim::Controls Face::controls() const {
  sim::Controls controls;
  controls.activations = effective_;
  controls.jaw = jaw_;
  controls.acceleration = acceleration_ + inertia_;
  controls.touches = touches_;
  return controls;
}

void Face::follow() {
  solver_->displacements(displacements_);
  const BoneChannels& channels = asset_->bones();
  bones_.jaw = sim::jaw_transform(model_->jaw(), shown_jaw_);
  for (std::size_t eye = 0; eye < 2; ++eye)
    bones_.eyes[eye] = eye_rotation(effective(channels.eye_yaw[eye]), effective(channels.eye_pitch[eye]));
  for (BoundMesh& mesh : meshes_)
    mesh.follow(bones_);
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
  strain_.resize(model_->lattice().columns);
  sim::skin_strain(*model_, displacements_, strain_);
  compression_.assign(asset_->primitives()[mesh].positions.size(), Vec3f::Zero());
  const rig::Binding* binding = asset_->binding(level_, mesh);
  if (binding == nullptr) return compression_;
  for (std::size_t v = 0; v < compression_.size(); ++v) {
    sim::Strain sum = sim::Strain::Zero();
    for (std::size_t i = v * binding->influences; i < (v + 1) * binding->influences; ++i)
      if (binding->nodes[i] < strain_.size()) sum += binding->weights[i] * strain_[binding->nodes[i]];
    compression_[v] = sim::strongest_compression(sum);
  }
  return compression_;
}

void Face::pose() {
  head_.known = 0;
  inertia_.setZero();
  gather();
  jaw_ = wanted_jaw();
  solver_->settle(controls());
  shown_jaw_ = jaw_;
  follow();
}

bool Face::step(double seconds) {
  inertia_ = inertia(seconds);
  gather();
  if (std::isfinite(seconds)) {
    seconds = std::min(seconds, solver_->longest_frame());  // what the solver loses is lost for the jaw too
    jaw_ = sim::approached(jaw_, wanted_jaw(), seconds);
  }
  const bool is_sound = solver_->step(seconds, controls()).status == sim::StepStatus::done;
  shown_jaw_ = solver_->shown_jaw(jaw_);
  follow();
  return is_sound;
}

void Face::reset() {
  head_.known = 0;
  inertia_.setZero();
  gather();
  jaw_ = wanted_jaw();
  solver_->reset(controls());
  shown_jaw_ = jaw_;
  follow();
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
