#include "fit/subject.h"

#include <Eigen/Geometry>

namespace fascia::fit {
namespace {

size_t level_of(const rig::Tissue& tissue, const std::string& name) {
  if (tissue.levels.empty()) throw Error("the rig has no tissue to simulate: build it again");
  std::string known;
  for (size_t i = 0; i < tissue.levels.size(); ++i) {
    if (tissue.levels[i].name == name) return i;
    known += (known.empty() ? "" : ", ") + tissue.levels[i].name;
  }
  if (!name.empty()) throw Error("the rig has no level '" + name + "'; it has: " + known);
  return tissue.levels.size() - 1;
}

}  // namespace

Subject::Subject(rig::RigFile file, const std::string& level)
    : file_(std::move(file)), level_(level_of(file_.rig.tissue, level)) {
  const rig::TissueLevel& tissue = file_.rig.tissue.levels[level_];
  model_ = std::make_unique<sim::FaceModel>(sim::lattice_of(tissue), sim::jaw_of(file_.rig.skull.jaw),
                                            sim::face_options_of(file_.rig.tissue));
  if (!model_->valid())
    throw Error("FASCIA_tissue, level '" + tissue.name + "': " + model_->fault() + "; build the rig again");
  jaw_muscles_ = sim::jaw_muscles_of(file_.rig);
  fast_model_ = std::make_unique<sim::realtime::Model>(*model_);
  if (!fast_model_->valid())
    throw Error("FASCIA_tissue, level '" + tissue.name + "': " + fast_model_->fault() +
                "; build the rig again");
  face_ = std::make_unique<sim::realtime::Solver>(*fast_model_, channels().size());
  positions_.resize(model_->rest().size());
  nodes_ = model_->rest();
  size_t vertices = 0;
  for (const rig::Primitive& primitive : file_.primitives) {
    first_.push_back(vertices);
    vertices += primitive.positions.size();
  }
  first_.push_back(vertices);
  rest_.setZero(static_cast<Eigen::Index>(3 * vertices));
  jaw_shares_.assign(vertices, 0.0F);
  eyes_.assign(vertices, 0);
  for (size_t p = 0; p < file_.primitives.size(); ++p) {
    const Eigen::Matrix4d map = to_metres(p);
    for (size_t v = 0; v < file_.primitives[p].positions.size(); ++v)
      rest_.segment<3>(static_cast<Eigen::Index>(3 * (first_[p] + v))) =
          map.topLeftCorner<3, 3>() * file_.primitives[p].positions[v].cast<double>() +
          map.topRightCorner<3, 1>();
  }
  for (const rig::Binding& binding : file_.rig.tissue.bindings[level_])
    bind(file_.primitive_of(binding), binding);
  weights_.resize(static_cast<Eigen::Index>(vertices), static_cast<Eigen::Index>(nodes_.size()));
  weights_.setFromTriplets(entries_.begin(), entries_.end());
  entries_ = {};
}

Eigen::Matrix4d Subject::to_metres(size_t primitive) const {
  for (const rig::Binding& binding : file_.rig.tissue.bindings[level_])
    if (file_.primitive_of(binding) == primitive) return binding.to_rig.cast<double>();
  return file_.rig.input_to_metres.cast<double>();
}

void Subject::bind(size_t primitive, const rig::Binding& binding) {
  for (size_t v = 0; v < binding.vertex_count; ++v) {
    const size_t at = first_[primitive] + v;
    eyes_[at] = binding.eye[v];
    if (eyes_[at] != 0) continue;
    jaw_shares_[at] = binding.jaw_weights[v];
    for (size_t i = v * binding.influences; i < (v + 1) * binding.influences; ++i)
      if (binding.weights[i] != 0.0F)
        entries_.emplace_back(static_cast<int>(at), static_cast<int>(binding.nodes[i]),
                              static_cast<double>(binding.weights[i]));
  }
}

bool Subject::follows(size_t vertex) const {
  const auto row = static_cast<Eigen::Index>(vertex);
  return jaw_shares_[vertex] != 0.0F || weights_.outerIndexPtr()[row + 1] > weights_.outerIndexPtr()[row];
}

std::vector<Triangle> Subject::skin_triangles() const {
  std::vector<Triangle> triangles;
  for (const rig::Binding& binding : file_.rig.tissue.bindings.front()) {
    if (binding.part != "skin") continue;
    const size_t p = file_.primitive_of(binding);
    const int first = static_cast<int>(first_vertex(p));
    for (const auto& t : file_.primitives[p].triangles)
      triangles.push_back(
          {static_cast<int>(t[0]) + first, static_cast<int>(t[1]) + first, static_cast<int>(t[2]) + first});
  }
  return triangles;
}

int32_t Subject::channel(const std::string& name) const {
  for (size_t c = 0; c < channels().size(); ++c)
    if (channels()[c].name == name) return static_cast<int32_t>(c);
  return -1;
}

sim::Controls Subject::controls(std::span<const float> activations) const {
  const auto value = [&](const char* name) {
    const int32_t at = channel(name);
    return at < 0 ? 0.0F : activations[static_cast<size_t>(at)];
  };
  sim::Controls controls;
  controls.activations = activations;
  controls.jaw = sim::clamped(
      jaw_muscles_.moved({value("jaw_open"), value("jaw_forward"), value("jaw_lateral")}, activations));
  return controls;
}

/// Yaw to the subject's left about +Y, then pitch upward about the head's lateral axis.
Mat3 Subject::eye_turn(std::span<const float> activations, const std::string& side) const {
  const auto value = [&](const std::string& name) {
    const int32_t at = channel(name + side);
    return at < 0 ? 0.0 : static_cast<double>(activations[static_cast<size_t>(at)]);
  };
  return (Eigen::AngleAxisd(value("eye_yaw_"), Vec3::UnitY()) *
          Eigen::AngleAxisd(-value("eye_pitch_"), Vec3::UnitX()))
      .toRotationMatrix();
}

void Subject::pose(std::span<const float> activations, bool warm) {
  sim::PoseOptions options;
  options.solver.iterations = 800;  // as the runtime's static pose
  options.newton.iterations = 30;
  options.from_last_pose = warm;
  face_->static_pose(controls(activations), options, positions_);
  for (size_t i = 0; i < nodes_.size(); ++i)
    nodes_[i] = positions_[i].cast<double>();
}

Eigen::VectorXd Subject::displacements(std::span<const float> activations) const {
  Eigen::MatrixXd moved(static_cast<Eigen::Index>(nodes_.size()), 3);
  for (size_t i = 0; i < nodes_.size(); ++i)
    moved.row(static_cast<Eigen::Index>(i)) = (nodes_[i] - model_->rest()[i]).transpose();
  const Eigen::MatrixXd by_vertex = weights_ * moved;
  const sim::RigidTransform jaw = sim::jaw_transform(model_->jaw(), controls(activations).jaw);
  const std::array<Mat3, 2> turns = {eye_turn(activations, "left"), eye_turn(activations, "right")};
  const rig::Skull& skull = file_.rig.skull;
  Eigen::VectorXd result(rest_.size());
  for (size_t v = 0; v < vertex_count(); ++v) {
    const auto at = static_cast<Eigen::Index>(v);
    sim::Vec3 place = by_vertex.row(at).transpose();
    const sim::Vec3 rest = rest_.segment<3>(3 * at);
    if (eyes_[v] != 0) {
      const Vec3 arm = rest - (eyes_[v] == 1 ? skull.eye_left : skull.eye_right).centre.cast<double>();
      place = turns[eyes_[v] - 1U] * arm - arm;
    } else if (jaw_shares_[v] != 0.0F) {
      place += static_cast<double>(jaw_shares_[v]) * (jaw * rest - rest);
    }
    result.segment<3>(3 * at) = place;
  }
  return result;
}

Eigen::MatrixXd Subject::jaw_slopes(std::span<const float> activations) const {
  Eigen::MatrixXd slopes = Eigen::MatrixXd::Zero(rest_.size(), 3);
  const sim::JawPose at = controls(activations).jaw;
  for (int motion = 0; motion < 3; ++motion) {
    // The joint is closed form; a small turn either way, within its limits.
    const auto moved = [&](float by) {
      sim::JawPose pose = at;
      (motion == 0 ? pose.open : motion == 1 ? pose.forward : pose.lateral) += by;
      return sim::clamped(pose);
    };
    const auto value = [&](const sim::JawPose& pose) {
      return motion == 0 ? pose.open : motion == 1 ? pose.forward : pose.lateral;
    };
    const sim::JawPose low = moved(-1e-3F), high = moved(1e-3F);
    const double width = static_cast<double>(value(high)) - static_cast<double>(value(low));
    if (width <= 0.0) continue;
    const sim::RigidTransform before = sim::jaw_transform(model_->jaw(), low),
                              after = sim::jaw_transform(model_->jaw(), high);
    for (size_t v = 0; v < vertex_count(); ++v) {
      if (jaw_shares_[v] == 0.0F) continue;
      const auto row = static_cast<Eigen::Index>(3 * v);
      const sim::Vec3 rest = rest_.segment<3>(row);
      slopes.block<3, 1>(row, motion) =
          (static_cast<double>(jaw_shares_[v]) / width) * (after * rest - before * rest);
    }
  }
  return slopes;
}

}  // namespace fascia::fit
