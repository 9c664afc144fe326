#include "bench/fit/round_trip.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <random>

#include "formats/scene.h"
#include "rig/read/read.h"

namespace fascia::bench {

namespace {

constexpr double near_enough = 0.03;  // of an activation
constexpr double noise = 5e-4;        // metres, root mean square

struct Tally {
  int poses = 0, off = 0, beyond_spread = 0, steps = 0, unconverged = 0;
  double largest = 0.0, worst_rms = 0.0, sum_rms = 0.0, seconds = 0.0;
  std::map<std::string, int> culprits;
};

class RoundTrip {
 public:
  RoundTrip(fit::Subject& subject, const fit::FitOptions& options)
      : subject_(subject), fitter_(subject, options) {
    const sim::Sensitivity sensitivity(subject.model());
    for (uint32_t c = 0; c < subject.channels().size(); ++c)
      if (subject.channels()[c].group == "muscle" && sensitivity.listens(c)) muscles_.push_back(c);
  }

  std::vector<float> random_pose(std::mt19937& random) const {
    std::vector<float> values;
    for (const rig::Channel& channel : subject_.channels())
      values.push_back(channel.rest);
    for (int k = 0; k < 5; ++k)
      values[muscles_[random() % muscles_.size()]] =
          0.3F + 0.6F * static_cast<float>(random() % 1000) / 1000.0F;
    return values;
  }

  void try_one(const std::vector<float>& values, double off_by, std::mt19937& random, Tally& tally) {
    subject_.pose(values, false);
    const Eigen::VectorXd truth = subject_.displacements(values);
    fit::Target target{truth, std::vector<double>(subject_.vertex_count(), 1.0)};
    std::normal_distribution<double> away(0.0, off_by / std::sqrt(3.0));
    if (off_by > 0.0)
      for (Eigen::Index i = 0; i < truth.size(); ++i)
        target.displacements[i] += away(random);
    const std::clock_t start = std::clock();
    const fit::FitResult result = fitter_.fit(target);
    tally.seconds += static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
    const double rms = 1e3 * rms_of_moved(truth, result.displacements);
    tally.sum_rms += rms;
    tally.worst_rms = std::max(tally.worst_rms, rms);
    tally.steps += result.iterations;
    tally.unconverged += !result.converged;
    ++tally.poses;
    bool is_off = false, is_beyond = false;
    for (size_t c = 0; c < values.size(); ++c) {
      const double error = std::abs(static_cast<double>(result.activations[c] - values[c]));
      tally.largest = std::max(tally.largest, error);
      if (error <= near_enough) continue;
      is_off = true;
      is_beyond = is_beyond || error > result.spread[c];
      ++tally.culprits[subject_.channels()[c].name];
    }
    tally.off += is_off;
    tally.beyond_spread += is_beyond;
  }

 private:
  /// Over what the pose moves by half a millimetre or more.
  double rms_of_moved(const Eigen::VectorXd& truth, const Eigen::VectorXd& found) const {
    double sum = 0.0;
    int count = 0;
    for (Eigen::Index v = 0; v < truth.size(); v += 3) {
      if (truth.segment<3>(v).norm() < 5e-4) continue;
      sum += (truth - found).segment<3>(v).squaredNorm();
      ++count;
    }
    return std::sqrt(sum / std::max(1, count));
  }

  fit::Subject& subject_;
  fit::Fitter fitter_;
  std::vector<uint32_t> muscles_;
};

void print(const std::string& head, const char* what, const Tally& tally) {
  const double count = tally.poses;
  std::printf(
      "%-16s %-6s %3d poses: %d with an activation off by more than %.2f (%d by more than its spread), %.3f "
      "at "
      "most; moved skin %.3f mm rms, %.3f at most; %.1f steps, %.2f s of CPU each, %d not converged\n",
      head.c_str(), what, tally.poses, tally.off, near_enough, tally.beyond_spread, tally.largest,
      tally.sum_rms / count, tally.worst_rms, tally.steps / count, tally.seconds / count, tally.unconverged);
  std::vector<std::pair<int, std::string>> list;
  for (const auto& [name, times] : tally.culprits)
    list.emplace_back(-times, name);
  std::sort(list.begin(), list.end());
  std::printf("%-16s %-6s off:", head.c_str(), what);
  for (size_t i = 0; i < std::min<size_t>(8, list.size()); ++i)
    std::printf(" %s %d", list[i].second.c_str(), -list[i].first);
  std::printf("\n");
  std::fflush(stdout);
}

}  // namespace

void find_random_poses(const SculptedHead& head, const std::string& level, int poses,
                       const fit::FitOptions& options) {
  const std::filesystem::path rig = rig_of(head, level);
  fit::Subject subject(rig::read(formats::read_bytes(rig), rig.string()), level);
  RoundTrip trip(subject, options);
  Tally clean, noisy;
  std::mt19937 random(7);
  for (int pose = 0; pose < poses; ++pose) {
    const std::vector<float> values = trip.random_pose(random);
    std::mt19937 own(100 + static_cast<uint32_t>(pose));
    trip.try_one(values, 0.0, own, clean);
    trip.try_one(values, noise, own, noisy);
  }
  print(head.name, "clean", clean);
  print(head.name, "noisy", noisy);
}

}  // namespace fascia::bench
