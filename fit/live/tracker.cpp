#include "fit/live/tracker.h"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "fit/live/dearness.h"
#include "fit/live/tracker_system.h"
#include "geometry/dense.h"
#include "geometry/error.h"

namespace fascia::fit {
namespace {

constexpr double square_mm = 1e6;       // of a square metre
constexpr int first_iterations = 8;     // of the frame that finds the face
constexpr double farthest_step = 0.25;  // of a channel: what the Jacobian is trusted for
constexpr double little_seen = 0.2;     // of what a channel moves: below, it begins to hold
constexpr double hold = 1e3;            // how much dearer change is for a channel that nothing is seen of

double share_seen(const Eigen::MatrixXd& reach, std::span<const double> weights, Eigen::Index channel) {
  double seen = 0.0, all = 0.0;
  for (size_t l = 0; l < weights.size(); ++l) {
    const double square = reach(static_cast<Eigen::Index>(l), channel);
    all += square;
    seen += std::min(1.0, weights[l]) * square;
  }
  return all > 0.0 ? seen / all : 0.0;
}

size_t count_seen(std::span<const double> weights) {
  return static_cast<size_t>(
      std::count_if(weights.begin(), weights.end(), [](double weight) { return weight > 0.0; }));
}

}  // namespace

Tracker::Tracker(const sim::FaceModel& model, const sim::realtime::Model& fast_model,
                 const rig::Actuation& actuation, std::vector<Landmark> landmarks,
                 const TrackerOptions& options)
    : model_(&model),
      landmarks_(std::move(landmarks)),
      options_(options),
      face_(std::make_unique<sim::realtime::Solver>(fast_model, actuation.channels.size())),
      nodes_(model.rest().size()) {
  const std::vector<double> dearness = dearness_of(actuation);
  const sim::Sensitivity sensitivity(model);
  const auto add = [&](uint32_t channel) {
    const rig::Channel& c = actuation.channels[channel];
    fitted_.push_back(channel);
    dearness_.push_back(dearness[channel]);
    ranges_.push_back({static_cast<double>(c.minimum), static_cast<double>(c.maximum), 0.0, false});
  };
  std::vector<uint32_t> jaw;
  for (uint32_t c = 0; c < actuation.channels.size(); ++c) {
    const rig::Channel& channel = actuation.channels[c];
    rest_.push_back(channel.rest);
    if (channel.group != "eye" && channel.group != "jaw" && sensitivity.listens(c)) add(c);
  }
  for (const char* name : {"jaw_open", "jaw_forward", "jaw_lateral"}) {
    const auto at = std::find_if(actuation.channels.begin(), actuation.channels.end(),
                                 [&](const rig::Channel& channel) { return channel.name == name; });
    if (at == actuation.channels.end())
      throw Error(std::string("the rig has no channel '") + name + "': build it again");
    add(static_cast<uint32_t>(at - actuation.channels.begin()));
  }
  if (landmarks_.empty()) throw Error("there are no landmarks on the rig's skin to follow");
  for (const Landmark& landmark : landmarks_)
    places_.push_back(landmark.rest);
  places_before_ = targets_ = places_;
  offsets_.assign(places_.size(), Vec3::Zero());
  bounds_ = ranges_;
  ridge_ = smoothness_ = dearness_;
  values_ = last_ = rest_;
  const auto count = static_cast<Eigen::Index>(fitted_.size());
  move_ = Eigen::VectorXd::Zero(count);
  system_ = std::make_unique<System>(static_cast<Eigen::Index>(landmarks_.size()), count);
  result_.landmarks = result_.at_rest = places_;
  result_.activations = rest_;
  renewed_ = std::make_unique<LandmarkJacobian>(model, landmarks_, fitted_);
  reach_.resize(static_cast<Eigen::Index>(landmarks_.size()), count);
  for (Eigen::Index l = 0; l < reach_.rows(); ++l)
    reach_.row(l) = renewed_->at_rest().middleRows<3>(3 * l).colwise().squaredNorm();
  reset();
}

Tracker::~Tracker() = default;

void Tracker::reset() {
  is_tracking_ = false;
  values_ = last_ = rest_;
  jacobian_ = renewed_->at_rest();
  renewed_->forget();
}

sim::Controls Tracker::controls() const {
  const size_t jaw = fitted_.size() - 3;
  sim::Controls controls;
  controls.activations = values_;
  controls.jaw = sim::clamped({values_[fitted_[jaw]], values_[fitted_[jaw + 1]], values_[fitted_[jaw + 2]]});
  return controls;
}

void Tracker::pose(bool is_first) {
  sim::PoseOptions options;
  options.solver.iterations = is_first ? 800 : 400;
  options.newton.iterations = is_first ? 30 : 0;
  options.from_last_pose = !is_first;
  if (!is_first) options.solver.tolerance = 1e-5;  // metres; landmarks are known to a tenth of a millimetre
  const sim::Controls now = controls();
  face_->static_pose(now, options, nodes_);
  const sim::RigidTransform jaw = sim::jaw_transform(model_->jaw(), now.jaw);
  places_before_ = places_;
  for (size_t l = 0; l < landmarks_.size(); ++l) {
    const Landmark& landmark = landmarks_[l];
    Vec3 place = landmark.rest;
    for (const auto& [node, weight] : landmark.influences)
      place += weight * (nodes_[node].cast<double>() - model_->rest()[node]);
    if (landmark.jaw_share != 0.0) place += landmark.jaw_share * (jaw * landmark.rest - landmark.rest);
    places_[l] = place;
  }
}

/// How far a landmark is from where it should be, in the head's frame and metres, and which part of the
/// head's motion is seen: all, or what is across the ray to a camera.
Vec3 Tracker::miss(size_t landmark, const Vec3& point, Mat3& seen) const {
  const Vec3 place = places_[landmark] + offsets_[landmark];
  if (!options_.camera) {
    seen.setIdentity();
    return head_.back(point) - place;
  }
  Vec3 at = head_ * place;
  at.z() = std::max(at.z(), 1e-3);
  seen.setZero();
  seen.row(0) = head_.rotation.row(0) - at.x() / at.z() * head_.rotation.row(2);
  seen.row(1) = head_.rotation.row(1) - at.y() / at.z() * head_.rotation.row(2);
  return options_.camera->across(point, at);
}

double Tracker::mean_square(std::span<const Vec3> points, std::span<const double> weights) const {
  double sum = 0.0, weight = 0.0;
  Mat3 seen;
  for (size_t l = 0; l < landmarks_.size(); ++l) {
    if (!(weights[l] > 0.0)) continue;
    sum += weights[l] * miss(l, points[l], seen).squaredNorm();
    weight += weights[l];
  }
  return weight > 0.0 ? square_mm * sum / weight : 0.0;
}

/// What a frame's steps make small, mm^2.
double Tracker::objective(std::span<const Vec3> points, std::span<const double> weights) const {
  double seen = 0.0;
  for (const double weight : weights)
    seen += std::max(0.0, weight);
  double sum = mean_square(points, weights) * seen / static_cast<double>(landmarks_.size());
  for (size_t i = 0; i < fitted_.size(); ++i) {
    const double value = values_[fitted_[i]], change = value - static_cast<double>(last_[fitted_[i]]);
    sum += ridge_[i] * value * value + bounds_[i].price * std::abs(value) + smoothness_[i] * change * change;
  }
  return sum;
}

/// The head's pose for the face as it stands.
bool Tracker::find_head(std::span<const Vec3> points, std::span<const double> weights, bool is_first) {
  constexpr size_t enough = 6;
  constexpr double lost = 400.0;  // mm^2
  if (!is_first && count_seen(weights) < enough) return true;
  for (size_t l = 0; l < places_.size(); ++l)
    targets_[l] = places_[l] + offsets_[l];
  if (!options_.camera) {
    const bool finds_scale = is_first && options_.finds_scale && neutral_scale_ == 0.0;
    const double scale = finds_scale ? 1.0 : is_first ? std::max(neutral_scale_, 0.0) : head_.scale;
    const double given = scale > 0.0 ? scale : 1.0;
    if (!finds_scale)
      for (Vec3& target : targets_)
        target *= given;
    std::optional<HeadPose> found = pose_between(targets_, points, weights, finds_scale);
    if (!found) return !is_first;
    if (!finds_scale) found->scale = given;
    head_ = *found;
    return true;
  }
  if (!is_first) refine_head(points, weights, 2);
  if (is_first || mean_square(points, weights) > lost) {
    const auto found = seen_by(*options_.camera, targets_, points, weights);
    if (!found) return !is_first;
    head_ = *found;
  }
  refine_head(points, weights, is_first ? 10 : 1);
  return true;
}

/// Gauss-Newton steps of the head alone.
void Tracker::refine_head(std::span<const Vec3> points, std::span<const double> weights, int steps) {
  for (int step = 0; step < steps; ++step) {
    System::HeadMatrix curvature = System::HeadMatrix::Zero();
    System::HeadVector slope = System::HeadVector::Zero();
    for (size_t l = 0; l < landmarks_.size(); ++l) {
      if (!(weights[l] > 0.0)) continue;
      Mat3 seen;
      const Vec3 missing = miss(l, points[l], seen);
      const auto rows = (seen * System::head_motion(places_[l] + offsets_[l], false)).eval();
      curvature += weights[l] * rows.transpose() * rows;
      slope += weights[l] * rows.transpose() * missing;
    }
    const System::HeadVector move = System::with_floor(curvature).ldlt().solve(slope);
    head_.move(move.head<3>(), move.segment<3>(3), 0.0);
  }
}

/// Costs and limits of the channels for what this frame shows of them.
void Tracker::weigh_channels(std::span<const double> weights, bool is_first) {
  for (size_t i = 0; i < fitted_.size(); ++i) {
    const double seen = share_seen(reach_, weights, static_cast<Eigen::Index>(i));
    const double unseen = std::max(0.0, 1.0 - seen / little_seen);
    ridge_[i] = seen * options_.ridge * dearness_[i];
    bounds_[i].price = seen * options_.sparsity * dearness_[i];
    smoothness_[i] = (is_first ? 0.0 : options_.smoothness) + hold * unseen * unseen * options_.smoothness;
  }
}

/// One step of the channels and the head together; the largest change of a channel.
double Tracker::step(std::span<const Vec3> points, std::span<const double> weights, bool moves_scale) {
  System& s = *system_;
  const double per_landmark = square_mm / static_cast<double>(landmarks_.size());
  for (size_t l = 0; l < landmarks_.size(); ++l) {
    const auto row = static_cast<Eigen::Index>(3 * l);
    const double weight = per_landmark * std::max(0.0, weights[l]);
    Mat3 seen = Mat3::Zero();
    Vec3 missing = Vec3::Zero();
    if (weight > 0.0) missing = miss(l, points[l], seen);
    s.missing.segment<3>(row) = weight * missing;
    s.rows.middleRows<3>(row).noalias() = seen * jacobian_.middleRows<3>(row);
    s.head_rows.middleRows<3>(row).noalias() =
        seen * System::head_motion(places_[l] + offsets_[l], moves_scale);
    s.weighted.middleRows<3>(row) = weight * s.rows.middleRows<3>(row);
    s.head_weighted.middleRows<3>(row) = weight * s.head_rows.middleRows<3>(row);
  }
  s.curvature.setZero();
  s.across.setZero();
  s.slope.setZero();
  System::HeadMatrix head = System::HeadMatrix::Zero();
  System::HeadVector head_slope = System::HeadVector::Zero();
  dense::add_transposed_product(1.0, s.rows, s.weighted, s.curvature);
  dense::add_transposed_product(1.0, s.head_rows, s.weighted, s.across);
  dense::add_transposed_product(-1.0, s.rows, s.missing, s.slope);
  dense::add_transposed_product(1.0, s.head_rows, s.head_weighted, head);
  dense::add_transposed_product(-1.0, s.head_rows, s.missing, head_slope);
  const Eigen::LDLT<System::HeadMatrix> factor(System::with_floor(head));
  for (Eigen::Index i = 0; i < s.across.cols(); ++i) {
    const System::HeadVector column = s.across.col(i);
    s.solved.col(i) = factor.solve(column);
  }
  dense::add_transposed_product(-1.0, s.across, s.solved, s.curvature);
  dense::add_transposed_product(-1.0, s.solved, head_slope, s.slope);
  for (size_t i = 0; i < fitted_.size(); ++i) {
    const auto at = static_cast<Eigen::Index>(i);
    const double value = values_[fitted_[i]];
    s.curvature(at, at) += ridge_[i] + smoothness_[i] + 1e-12;
    s.slope[at] += ridge_[i] * value + smoothness_[i] * (value - static_cast<double>(last_[fitted_[i]]));
    bounds_[i].least = std::max(ranges_[i].least, value - farthest_);
    bounds_[i].most = std::min(ranges_[i].most, value + farthest_);
  }
  bounded_step(
      s.curvature, s.slope,
      [&](Eigen::Index i) -> const StepBound& { return bounds_[static_cast<size_t>(i)]; },
      [&](Eigen::Index i) { return static_cast<double>(values_[fitted_[static_cast<size_t>(i)]]); }, s.move,
      s.pull, 1e-4);
  System::HeadVector head_move = -factor.solve(head_slope);
  dense::add_product(-1.0, s.solved, s.move, head_move);
  head_.move(head_move.head<3>(), head_move.segment<3>(3), head_move[6]);
  double largest = 0.0;
  for (size_t i = 0; i < fitted_.size(); ++i) {
    float& value = values_[fitted_[i]];
    const float before = value;
    value = std::clamp(value + static_cast<float>(s.move[static_cast<Eigen::Index>(i)]),
                       static_cast<float>(ranges_[i].least), static_cast<float>(ranges_[i].most));
    move_[static_cast<Eigen::Index>(i)] = static_cast<double>(value) - static_cast<double>(before);
    largest = std::max(largest, std::abs(move_[static_cast<Eigen::Index>(i)]));
  }
  return largest;
}

/// Broyden's correction by what the last step did.
void Tracker::correct_jacobian() {
  constexpr double least = 1e-4;  // below, the pose's tolerance tells more than the step
  const double square = move_.squaredNorm();
  if (square < least) return;
  for (size_t l = 0; l < landmarks_.size(); ++l) {
    const auto row = static_cast<Eigen::Index>(3 * l);
    const Vec3 wrong = places_[l] - places_before_[l] - jacobian_.middleRows<3>(row) * move_;
    jacobian_.middleRows<3>(row).noalias() += wrong / square * move_.transpose();
  }
}

bool Tracker::take_neutral(std::span<const Vec3> points, std::span<const double> weights) {
  const std::vector<Vec3> offsets = offsets_;
  const double scale = neutral_scale_;
  offsets_.assign(offsets_.size(), Vec3::Zero());
  neutral_scale_ = 0.0;
  reset();
  pose(true);
  if (!find_head(points, weights, true)) {
    offsets_ = offsets;
    neutral_scale_ = scale;
    return false;
  }
  for (size_t l = 0; l < landmarks_.size(); ++l) {
    if (!(weights[l] > 0.0)) continue;
    Mat3 seen;
    const Vec3 missing = miss(l, points[l], seen);  // of a camera's: across its rays
    offsets_[l] = options_.camera ? Vec3(head_.rotation.transpose() * missing) : missing;
  }
  neutral_scale_ = head_.scale;
  return true;
}

const Tracked& Tracker::follow(std::span<const Vec3> points, std::span<const double> weights) {
  const bool is_first = !is_tracking_;
  if (is_first) {
    values_ = rest_;
    pose(true);
  }
  result_.seen = static_cast<uint32_t>(count_seen(weights));
  if (result_.seen == 0 || !find_head(points, weights, is_first)) {
    result_.rms_mm = 0.0;
    result_.steps = 0;
    result_.is_settled = false;
    if (is_first) result_.seen = 0;
    return result_;
  }
  is_tracking_ = true;
  result_.steps = 0;
  last_ = values_;
  weigh_channels(weights, is_first);
  const bool moves_scale =
      is_first && options_.finds_scale && neutral_scale_ == 0.0 && !options_.camera.has_value();
  const int iterations = is_first ? std::max(first_iterations, options_.iterations) : options_.iterations;
  if (options_.may_take_time) renewed_->renew_whole(controls(), nodes_, jacobian_);
  iterate(points, weights, iterations, moves_scale);
  // The first frame may stand far from where the Jacobian was computed.
  for (int again = 0; options_.may_take_time && is_first && again < 3; ++again)
    if (renewed_->renew_whole(controls(), nodes_, jacobian_))
      iterate(points, weights, iterations, moves_scale);
  refine_head(points, weights, 1);
  report(points, weights);
  if (!options_.may_take_time) renewed_->renew(controls(), nodes_, jacobian_);
  return result_;
}

/// Steps of a frame, until they gain nothing or are too many.
void Tracker::iterate(std::span<const Vec3> points, std::span<const double> weights, int most,
                      bool moves_scale) {
  // Channels that hardly show may go to and fro for ever: what counts is that nothing is gained by it.
  constexpr double still = 1e-3, no_gain = 1e-3, nothing = 1e-6;
  farthest_ = farthest_step;
  result_.is_settled = false;
  double before = objective(points, weights);
  for (int i = 0; i < most && !result_.is_settled; ++i) {
    const double largest = step(points, weights, moves_scale);
    ++result_.steps;
    pose(false);
    correct_jacobian();
    result_.is_settled = largest < still;
    if (!options_.may_take_time) continue;
    const double now = objective(points, weights);
    result_.is_settled = result_.is_settled || std::abs(before - now) < no_gain * now + nothing;
    if (now > before) farthest_ *= 0.5;
    before = now;
  }
}

void Tracker::report(std::span<const Vec3> points, std::span<const double> weights) {
  result_.activations = values_;
  result_.head = head_;
  result_.rms_mm = std::sqrt(mean_square(points, weights));
  for (size_t l = 0; l < landmarks_.size(); ++l) {
    result_.landmarks[l] = head_ * (places_[l] + offsets_[l]);
    result_.at_rest[l] = head_ * (landmarks_[l].rest + offsets_[l]);
  }
}

}  // namespace fascia::fit
