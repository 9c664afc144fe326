#include "builder/skull/tissue_depth.h"

#include <algorithm>
#include <vector>

#include "geometry/error.h"

namespace fascia::skull {

TissueDepthField::TissueDepthField(const anatomy::GenericAnatomy& anatomy, const std::string& depth_table) {
  const anatomy::TissueDepthTable* table =
      depth_table.empty() ? &anatomy.depth_tables.front() : anatomy.depth_table(depth_table);
  if (!table)
    throw Error("tissue depths: there is no table called " + depth_table + "; see tissue_depths.json");
  splines::Sites sites;
  std::vector<double> means;
  std::vector<double> deviations;
  for (const anatomy::Landmark& landmark : anatomy.landmarks) {
    const anatomy::TissueDepth* depth = landmark.depth.empty() ? nullptr : table->find(landmark.depth);
    if (!depth || !landmark.skin) continue;
    sites.points.push_back(*landmark.skin);
    sites.weights.push_back(1.0);
    means.push_back(depth->mean);
    deviations.push_back(depth->deviation);
  }
  if (means.size() < 4)
    throw Error("tissue depths: the table " + table->name + " names fewer than four landmarks of the face");
  const auto fitted = [&](const std::vector<double>& values) {
    const Eigen::VectorXd data =
        Eigen::Map<const Eigen::VectorXd>(values.data(), static_cast<Eigen::Index>(values.size()));
    return splines::fit(sites, data, splines::SplineOptions{});
  };
  mean_ = fitted(means);
  deviation_ = fitted(deviations);
  least_ = *std::min_element(means.begin(), means.end());
  greatest_ = *std::max_element(means.begin(), means.end());
  least_deviation_ = *std::min_element(deviations.begin(), deviations.end());
  greatest_deviation_ = *std::max_element(deviations.begin(), deviations.end());
}

double TissueDepthField::mean(const Vec3& skin) const {
  return std::clamp(mean_.value(skin)[0], least_, greatest_);
}

double TissueDepthField::deviation(const Vec3& skin) const {
  return std::clamp(deviation_.value(skin)[0], least_deviation_, greatest_deviation_);
}

}  // namespace fascia::skull
