#include "tools/anatomy/identify/responses.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstdio>
#include <optional>
#include <thread>

#include "fascia/fascia.hpp"
#include "formats/scene.h"
#include "geometry/error.h"
#include "tools/anatomy/identify/problem.h"
#include "tools/anatomy/identify/table_file.h"

namespace fascia::identify {
namespace {

/// A row with the row that it is added to.
struct Row {
  Weights own, base;
};

/// A head as the runtime plays it. Not for two threads at once.
class PlayedHead {
 public:
  PlayedHead(const bench::SculptedHead& head, const std::string& level)
      : name_(head.name),
        asset_(api::Asset::load(formats::read_bytes(bench::rig_of(head, level)))),
        face_(asset_) {
    const fascia_channels channels = asset_.channels();
    rest_.assign(channels.rest, channels.rest + channels.count);
    for (uint32_t c = 0; c < channels.count; ++c)
      is_eye_.push_back(std::string(channels.groups[c]) == "eye");
    at_rest_ = positions();
  }

  /// 3 x #vertices: displacements with `row` at `share` and its base at `base`, eyes at `weight`.
  Eigen::VectorXf pose(const Row& row, double share, double base, double weight) {
    std::copy(rest_.begin(), rest_.end(), face_.values().begin());
    add(row.base, base, weight);
    add(row.own, share, weight);
    face_.pose();
    return positions() - at_rest_;
  }

  const std::string& name() const { return name_; }

 private:
  void add(const Weights& weights, double share, double weight) {
    for (const auto& [channel, most] : weights) {
      const int32_t at = asset_.find_channel(channel);
      if (at < 0) throw Error(name_ + ": the rig has no actuator '" + channel + "'");
      const auto c = static_cast<size_t>(at);
      face_.values()[c] += static_cast<float>(most * (is_eye_[c] ? weight : share));
    }
  }

  /// Of all meshes that follow the skin.
  Eigen::VectorXf positions() {
    std::vector<float> all;
    for (uint32_t mesh = 0; mesh < asset_.info().mesh_count; ++mesh) {
      if (std::string(asset_.mesh(mesh).part) != "skin") continue;
      for (const api::Vector3& position : face_.positions(mesh))
        all.insert(all.end(), position.begin(), position.end());
    }
    return Eigen::Map<const Eigen::VectorXf>(all.data(), static_cast<Eigen::Index>(all.size()));
  }

  std::string name_;
  api::Asset asset_;
  api::Face face_;
  std::vector<float> rest_;
  std::vector<bool> is_eye_;
  Eigen::VectorXf at_rest_;
};

/// Runs `work(h)` for each head on `threads` threads.
template <class Work>
void for_each_head(size_t heads, int threads, const Work& work) {
  std::atomic<size_t> next = 0;
  const auto run = [&] {
    for (size_t h = next++; h < heads; h = next++)
      work(h);
  };
  std::vector<std::jthread> others;
  for (int i = 1; i < threads; ++i)
    others.emplace_back(run);
  run();
}

class Search {
 public:
  Search(std::vector<PlayedHead>& heads, const ResponseOptions& options) : heads_(heads), options_(options) {}

  /// Shares of `row` at each of the options' weights; nothing when no head moves. `base` has the response of
  /// the row that it corrects, by weight. `left` gets the largest distance from its weight.
  std::optional<std::vector<double>> find(const Row& row, const std::vector<double>& base, double& left) {
    wholes_.assign(heads_.size(), {});
    std::vector<float> most(heads_.size(), 0.0F);
    for_each_head(heads_.size(), options_.threads, [&](size_t h) {
      wholes_[h] = added(h, row, 1.0, 1.0, 1.0);
      if (wholes_[h].size() > 0) most[h] = wholes_[h].cwiseAbs().maxCoeff();
    });
    if (*std::max_element(most.begin(), most.end()) < 1e-3 * options_.least_mm) return std::nullopt;
    std::vector<double> shares;
    left = 0.0;
    for (size_t k = 0; k < options_.weights.size(); ++k) {
      const double below = shares.empty() ? 0.0 : shares.back();
      const double off = find_share(row, base[k], options_.weights[k], below, shares);
      left = std::max(left, off);
    }
    return shares;
  }

 private:
  /// What `row` adds to its base.
  Eigen::VectorXf added(size_t h, const Row& row, double share, double base, double weight) {
    Eigen::VectorXf moved = heads_[h].pose(row, share, base, weight);
    if (!row.base.empty()) moved -= heads_[h].pose({{}, row.base}, 0.0, base, weight);
    return moved;
  }

  /// Regula falsi (Illinois) between `below` and 1; appends what it found and returns the largest distance.
  double find_share(const Row& row, double base, double weight, double below, std::vector<double>& shares) {
    double low = below, low_off = std::min(-1e-3, (shares.empty() ? 0.0 : last_) - weight), high = 1.0,
           high_off = 1.0 - weight, share = std::max(below, weight), spread = 0.0;
    for (int round = 0; round < options_.most_rounds; ++round) {
      const double off = median(row, share, base, weight, spread) - weight;
      last_ = weight + off;
      if (std::abs(off) < options_.tolerance) break;
      if (off < 0.0) {
        low = share, low_off = off;
        high_off *= round > 0 ? 0.5 : 1.0;
      } else {
        high = share, high_off = off;
        low_off *= round > 0 ? 0.5 : 1.0;
      }
      if (high - low < 0.002) break;
      share = std::clamp(low - low_off * (high - low) / (high_off - low_off), low + 0.05 * (high - low),
                         high - 0.05 * (high - low));
    }
    shares.push_back(std::max(below, share));
    return spread;
  }

  /// Median over the heads of the share of the way; `spread` the largest distance from `weight`.
  double median(const Row& row, double share, double base, double weight, double& spread) {
    std::vector<double> ways(heads_.size());
    for_each_head(heads_.size(), options_.threads, [&](size_t h) {
      const double square = static_cast<double>(wholes_[h].squaredNorm());
      ways[h] = square > 0.0
                    ? static_cast<double>(added(h, row, share, base, weight).dot(wholes_[h])) / square
                    : weight;
    });
    std::sort(ways.begin(), ways.end());
    spread = std::max(weight - ways.front(), ways.back() - weight);
    const size_t half = ways.size() / 2;
    return ways.size() % 2 == 1 ? ways[half] : 0.5 * (ways[half - 1] + ways[half]);
  }

  std::vector<PlayedHead>& heads_;
  const ResponseOptions& options_;
  std::vector<Eigen::VectorXf> wholes_;
  double last_ = 0.0;
};

Json rounded(const std::vector<double>& numbers) {
  Json list = Json::array();
  for (const double number : numbers)
    list.push_back(std::round(1000.0 * number) / 1000.0);
  return list;
}

/// The response of a row equal to `row`, or to its mirror image.
const std::optional<std::vector<double>>* known(
    const std::vector<std::pair<Row, std::optional<std::vector<double>>>>& rows, const Row& row) {
  for (const auto& [other, response] : rows)
    if ((other.own == row.own && other.base == row.base) ||
        (other.own == mirrored(row.own) && other.base == mirrored(row.base)))
      return &response;
  return nullptr;
}

bool turns_an_eye(const Weights& weights) {
  return std::any_of(weights.begin(), weights.end(),
                     [](const auto& item) { return item.first.rfind("eye_", 0) == 0; });
}

Json& row_named(Json& table, const std::string& name) {
  for (Json& row : table["expressions"])
    if (row["name"] == name) return row;
  throw Error("the table has no row '" + name + "'");
}

}  // namespace

void identify_responses(const std::filesystem::path& folder, const std::vector<bench::SculptedHead>& heads,
                        const std::string& level, const ResponseOptions& options) {
  std::vector<PlayedHead> played;
  for (const bench::SculptedHead& head : heads)
    played.emplace_back(head, level);
  Search search(played, options);
  std::vector<std::pair<Row, std::optional<std::vector<double>>>> rows;
  for (const char* file : {"arkit.json", "facs.json", "visemes.json", "vrm.json", "smiles.json"}) {
    Json table = read_table(folder / file);
    Json written = Json::object();  // with the weights before the rows
    for (const auto& [key, value] : table.items()) {
      if (key == "expressions") written["response_weights"] = options.weights;
      if (key != "response_weights") written[key] = value;
    }
    for (Json& entry : written["expressions"]) {
      Row row{entry["weights"].get<Weights>(), {}};
      std::vector<double> base = options.weights;
      if (entry.contains("corrects")) {
        const Json& corrected = row_named(written, entry["corrects"]);
        row.base = corrected["weights"].get<Weights>();
        if (corrected.contains("response")) base = corrected["response"].get<std::vector<double>>();
      }
      entry.erase("response");
      if (row.own.empty() || turns_an_eye(row.own)) continue;  // lids go with the angle
      const auto* response = known(rows, row);
      double left = 0.0;
      if (response == nullptr) {
        rows.emplace_back(row, search.find(row, base, left));
        response = &rows.back().second;
        if (*response)
          std::printf("%-10s %-18s %s left %.3f\n", file, entry["name"].get<std::string>().c_str(),
                      rounded(**response).dump().c_str(), left);
        std::fflush(stdout);
      }
      if (*response) entry["response"] = rounded(**response);
    }
    write_table(folder / file, written);
  }
}

}  // namespace fascia::identify
