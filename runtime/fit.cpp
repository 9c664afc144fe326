#include "runtime/fit.h"

#include <algorithm>
#include <cmath>

#include "fit/live/landmark_sets.h"

namespace fascia::runtime {
namespace {

constexpr std::size_t fewest = 4;  // landmarks

fit::TrackerOptions tracker_options(const fascia_fit_options& options) {
  require(options.iterations >= 1 && options.iterations <= 32, "iterations must lie between 1 and 32");
  for (const float cost : {options.ridge, options.sparsity, options.smoothness})
    require(std::isfinite(cost) && cost >= 0.0F, "ridge, sparsity and smoothness must be 0 or more");
  for (const float number : {options.focal[0], options.focal[1], options.centre[0], options.centre[1]})
    require(std::isfinite(number), "a number of the camera is not finite");
  fit::TrackerOptions chosen;
  chosen.ridge = static_cast<double>(options.ridge);
  chosen.sparsity = static_cast<double>(options.sparsity);
  chosen.smoothness = static_cast<double>(options.smoothness);
  chosen.iterations = options.iterations;
  chosen.finds_scale = options.finds_scale != 0;
  if (options.focal[0] == 0.0F && options.focal[1] == 0.0F) return chosen;
  require(options.focal[0] > 0.0F && options.focal[1] > 0.0F, "a camera's focal lengths must be above 0");
  chosen.camera = fit::Camera{static_cast<double>(options.focal[0]), static_cast<double>(options.focal[1]),
                              static_cast<double>(options.centre[0]), static_cast<double>(options.centre[1])};
  return chosen;
}

fit::SkinPlace checked_place(const fascia_fit_place& place) {
  double sum = 0.0;
  fit::SkinPlace chosen;
  chosen.primitive = place.mesh;
  for (std::size_t k = 0; k < 3; ++k) {
    require(std::isfinite(place.shares[k]) && place.shares[k] >= 0.0F, "a place's shares must be 0 or more");
    chosen.vertices[k] = place.vertices[k];
    chosen.shares[k] = static_cast<double>(place.shares[k]);
    sum += chosen.shares[k];
  }
  require(std::abs(sum - 1.0) < 1e-3, "a place's shares must add up to 1");
  for (double& share : chosen.shares)
    share /= sum;
  return chosen;
}

}  // namespace

Fit::Fit(std::shared_ptr<const Asset> asset, const fascia_fit_landmarks& landmarks,
         const fascia_fit_options& options)
    : asset_(std::move(asset)), point_count_(landmarks.count) {
  const fit::TrackerOptions chosen = tracker_options(options);
  const std::size_t levels = asset_->rig().tissue.levels.size();
  require(options.level >= -1 && options.level < static_cast<int32_t>(levels),
          "the rig has no such level of detail");
  level_ = options.level < 0 ? levels - 1 : static_cast<std::size_t>(options.level);
  const int ways = (landmarks.set != nullptr ? 1 : 0) + (landmarks.names != nullptr ? 1 : 0) +
                   (landmarks.places != nullptr ? 1 : 0);
  require(ways == 1, "give one of set, names and places");
  std::vector<fit::Landmark> found;
  if (landmarks.set != nullptr) {
    const std::optional<fit::LandmarkSet> set = fit::find_landmark_set(landmarks.set);
    if (!set) {
      std::string known;
      for (const fit::LandmarkSet& other : fit::landmark_sets())
        known += (known.empty() ? "" : ", ") + other.name;
      throw Failure(FASCIA_ERROR_NAME, "there is no set of landmarks \"" + std::string(landmarks.set) +
                                           "\"; known are " + known);
    }
    require(landmarks.count == 0 || landmarks.count == set->points,
            "count is not the number of points of the set");
    point_count_ = static_cast<uint32_t>(set->points);
    for (const fit::LandmarkSet::Entry& entry : set->entries)
      add(found, entry.landmark.c_str(), entry.points);
  }
  for (uint32_t i = 0; i < landmarks.count && landmarks.names != nullptr; ++i) {
    if (landmarks.names[i] == nullptr) continue;
    const std::size_t before = found.size();
    add(found, landmarks.names[i], {i});
    if (found.size() == before)
      throw Failure(FASCIA_ERROR_NAME, "the rig has no landmark \"" + std::string(landmarks.names[i]) +
                                           "\" on its skin; 'fascia export --part landmarks' lists them");
  }
  for (uint32_t i = 0; i < landmarks.count && landmarks.places != nullptr; ++i) {
    try {
      found.push_back(fit::landmark_at(asset_->file(), level_, checked_place(landmarks.places[i])));
    } catch (const Error& fault) {
      throw Failure(FASCIA_ERROR_ARGUMENT, "place " + std::to_string(i) + ": " + fault.what());
    }
    sources_.push_back({{i}, ""});
  }
  if (found.size() < fewest)
    throw Failure(FASCIA_ERROR_ARGUMENT, "only " + std::to_string(found.size()) +
                                             " landmarks lie on the rig's skin: four at least are needed");
  for (const Source& source : sources_)
    name_list_.push_back(source.name.c_str());
  places_.resize(found.size());
  weights_.resize(found.size());
  shown_.resize(3 * found.size());
  tracker_ = std::make_unique<fit::Tracker>(asset_->model(level_), asset_->realtime_model(level_),
                                            asset_->rig().actuation, std::move(found), chosen);
}

void Fit::add(std::vector<fit::Landmark>& landmarks, const char* name, std::vector<uint32_t> points) {
  const auto place = fit::place_of_landmark(asset_->file(), level_, name);
  if (!place) return;
  landmarks.push_back(fit::landmark_at(asset_->file(), level_, *place));
  sources_.push_back({std::move(points), name});
}

/// The middle of each landmark's points; not seen where one of them is not.
void Fit::take(const float* points, const float* weights) {
  require(points != nullptr, "the points are null");
  const uint32_t numbers = dimensions();
  for (uint32_t p = 0; p < point_count_ && weights != nullptr; ++p)
    require(std::isfinite(weights[p]) && weights[p] >= 0.0F, "a weight must be 0 or more");
  for (std::size_t l = 0; l < sources_.size(); ++l) {
    Vec3 sum = Vec3::Zero();
    double weight = 1e30;
    for (const uint32_t p : sources_[l].points) {
      weight = std::min(weight, weights == nullptr ? 1.0 : static_cast<double>(weights[p]));
      for (uint32_t k = 0; k < numbers; ++k)
        sum[k] += static_cast<double>(points[std::size_t{numbers} * p + k]);
    }
    const bool is_number = sum.allFinite();
    places_[l] = is_number ? Vec3(sum / static_cast<double>(sources_[l].points.size())) : Vec3(Vec3::Zero());
    weights_[l] = is_number ? weight : 0.0;
  }
}

void Fit::set_neutral(const float* points, const float* weights) {
  take(points, weights);
  require(tracker_->take_neutral(places_, weights_), "too few points are seen to tell where the head is");
}

fascia_fit_result Fit::push(const float* points, const float* weights) {
  take(points, weights);
  const fit::Tracked& tracked = tracker_->follow(places_, weights_);
  fascia_fit_result result{};
  result.seen = tracked.seen;
  result.residual = static_cast<float>(1e-3 * tracked.rms_mm);
  result.scale = static_cast<float>(tracked.head.scale);
  Eigen::Map<Eigen::Matrix4f> head(result.head);
  head.setIdentity();
  head.topLeftCorner<3, 3>() = (tracked.head.scale * tracked.head.rotation).cast<float>();
  head.topRightCorner<3, 1>() = tracked.head.translation.cast<float>();
  for (std::size_t l = 0; l < tracked.landmarks.size(); ++l)
    Eigen::Map<Vec3f>(shown_.data() + 3 * l) = tracked.landmarks[l].cast<float>();
  result.values = tracked.activations.data();
  result.landmarks = shown_.data();
  return result;
}

}  // namespace fascia::runtime
