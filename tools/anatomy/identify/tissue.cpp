#include "tools/anatomy/identify/tissue.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <nlohmann/json.hpp>

#include "geometry/error.h"

namespace fascia::identify {
namespace {

using Json = nlohmann::ordered_json;
namespace fs = std::filesystem;

/// What is identified: how stiff, how firmly held and how free to glide. What is measured stays.
const std::vector<std::pair<std::string, std::string>> constants = {
    {"tissue", "bending_factor"},     {"skin", "young_modulus"},     {"smas", "young_modulus"},
    {"fat", "across_modulus"},        {"fat", "shear_modulus"},      {"glide", "shear_modulus"},
    {"glide", "normal_modulus"},      {"attachment", "free_factor"}, {"attachment", "lip_share"},
    {"attachment", "air_shear_loss"}, {"lids", "softness_share"},    {"lids", "upper_follows_up"},
    {"lids", "upper_follows_down"},   {"lips", "softness_share"},    {"lips", "gum_hold"}};
/// And of the attachment regions their hold on bone.
const std::vector<std::string> regions = {
    "forehead", "forehead_lateral", "prezygomatic_space", "modiolus", "brow", "buccal_space", "chin"};

Json read_json(const fs::path& path) {
  std::ifstream file(path);
  if (!file) throw Error("cannot read '" + path.string() + "'");
  return Json::parse(file);
}

std::vector<TissueParameter> parameters_of(const Json& mechanics) {
  std::vector<TissueParameter> list;
  for (const auto& [section, name] : constants) {
    const Json& entry = mechanics["sections"][section][name];
    list.push_back({section, name, entry["value"], entry["range"][0], entry["range"][1]});
  }
  for (const Json& region : mechanics["attachment_regions"])
    if (const std::string name = region["name"];
        std::find(regions.begin(), regions.end(), name) != regions.end())
      list.push_back({"attachment_regions", name + ".bone", region["bone"], 0.1, 6.0});
  for (const Json& hold : mechanics["holds"])
    list.push_back({"holds", hold["name"].get<std::string>() + ".factor", hold["factor"], 1.0, 8.0});
  return list;
}

/// mechanics.json with only the numbers of `changes` exchanged, so that its lines stay as they are written.
void write_changed(const fs::path& from, const fs::path& to,
                   const std::vector<std::pair<TissueParameter, double>>& changes) {
  std::ifstream in(from);
  std::string text(std::istreambuf_iterator<char>(in), {});
  for (const auto& [p, value] : changes) {
    char number[32];
    std::snprintf(number, sizeof number, "%.4g", value);
    const bool is_region = p.section == "attachment_regions" || p.section == "holds";
    const size_t dot = p.name.find('.');
    size_t at = text.find("\"" + p.section + "\":");
    if (is_region) {
      at = text.find("\"name\": \"" + p.name.substr(0, dot) + "\"", at);
      at = text.find("\"" + p.name.substr(dot + 1) + "\": ", at) + p.name.size() - dot - 1 + 4;
    } else {
      at = text.find("\"" + p.name + "\":", at);
      at = text.find("\"value\": ", at) + 9;
    }
    const size_t end = text.find_first_of(",}", at);
    text.replace(at, end - at, number);
  }
  std::ofstream(to) << text;
}

/// Half the cost's derivatives with the table's weights gone from them.
struct Reduced {
  double value = 0.0;
  Eigen::MatrixXd curvature;
  Eigen::VectorXd slope;
};

struct Posed {
  double weight = 0.0;
  Eigen::VectorXf gap;
  Eigen::MatrixXf by_row, by_tissue;
};

class Identification {
 public:
  Identification(const std::vector<ShapeEntry>& entries, const std::map<std::string, Weights>& rows,
                 const TissueOptions& options, std::vector<TissueParameter> list)
      : entries_(entries), rows_(rows), options_(options), list_(std::move(list)) {
    const auto n = static_cast<Eigen::Index>(list_.size());
    for (const ShapeEntry& entry : entries_) {
      const auto m = static_cast<Eigen::Index>(entry.actuators.size());
      own_.push_back(Eigen::MatrixXd::Zero(m, m));
      across_.push_back(Eigen::MatrixXd::Zero(m, n));
      pull_.push_back(Eigen::VectorXd::Zero(m));
    }
    tissue_.curvature = Eigen::MatrixXd::Zero(n, n);
    tissue_.slope = Eigen::VectorXd::Zero(n);
  }

  /// Adds what one head tells.
  void add(const bench::SculptedHead& sculpted, double weight) {
    std::vector<Posed> posed(entries_.size());
    {
      FittedHead head(sculpted, options_.level);
      for (size_t s = 0; s < entries_.size(); ++s)
        pose(head, s, weight, posed[s]);
    }
    for (size_t p = 0; p < list_.size(); ++p) {
      const double factor = std::exp(options_.difference);
      const bool goes_down = list_[p].value * factor > list_[p].most;
      const double changed = goes_down ? list_[p].value / factor : list_[p].value * factor;
      const fs::path folder = fs::temp_directory_path() / "fascia_identify_tissue";
      fs::create_directories(folder);
      write_changed(fs::path(options_.data) / "mechanics.json", folder / "mechanics.json",
                    {{list_[p], changed}});
      bench::SculptedHead other = sculpted;
      other.anatomy = folder;
      try {
        bench::KnownFace face(other, options_.level);
        for (size_t s = 0; s < entries_.size(); ++s)
          if (posed[s].gap.size() > 0)
            differ(face, s, p, (goes_down ? -1.0 : 1.0) * options_.difference, posed[s]);
      } catch (const Error& error) {
        std::fprintf(stderr, "%s, %s: %s\n", sculpted.name.c_str(), list_[p].name.c_str(), error.what());
      }
    }
    for (size_t s = 0; s < entries_.size(); ++s)
      if (posed[s].gap.size() > 0) gather(s, posed[s]);
  }

  /// The step, logarithms of factors; prints it.
  Eigen::VectorXd step(double weights) {
    Reduced all = tissue_;
    for (size_t s = 0; s < entries_.size(); ++s) {  // the rows follow
      Eigen::MatrixXd own = own_[s];
      own.diagonal().array() += 0.004 * weights / static_cast<double>(entries_.size()) + 1e-9;
      const Eigen::LDLT<Eigen::MatrixXd> factor(own);
      all.curvature -= across_[s].transpose() * factor.solve(across_[s]);
      all.slope -= across_[s].transpose() * factor.solve(pull_[s]);
    }
    const double scale = 1.0 / weights;
    all.curvature *= scale;
    all.slope *= scale;
    const auto n = all.slope.size();
    Eigen::MatrixXd curvature = all.curvature;
    curvature.diagonal().array() += options_.prior / static_cast<double>(n);
    Eigen::VectorXd theta = Eigen::VectorXd::Zero(n), pull = all.slope;
    for (int sweep = 0; sweep < 500; ++sweep)
      for (Eigen::Index i = 0; i < n; ++i) {
        const TissueParameter& p = list_[static_cast<size_t>(i)];
        const double least = std::max(-options_.longest, std::log(p.least / p.value)),
                     most = std::min(options_.longest, std::log(p.most / p.value));
        const double change =
            std::clamp(theta[i] - pull[i] / curvature(i, i), std::min(least, 0.0), std::max(most, 0.0)) -
            theta[i];
        pull += change * curvature.col(i);
        theta[i] += change;
      }
    const double gain = -(theta.dot(all.curvature * theta) + 2.0 * theta.dot(all.slope));
    std::printf("share as it is %.4f; the linear model hopes for %.4f more\n", 1.0 - tissue_.value * scale,
                gain);
    for (Eigen::Index i = 0; i < n; ++i) {
      const TissueParameter& p = list_[static_cast<size_t>(i)];
      std::printf("  %-20s %-32s %9.4g -> %9.4g  (%+.2f; the data tell %.4f)\n", p.section.c_str(),
                  p.name.c_str(), p.value, p.value * std::exp(theta[i]), theta[i], all.curvature(i, i));
    }
    return theta;
  }

 private:
  Weights played(size_t s) const {
    const ShapeEntry& entry = entries_[s];
    Weights weights = rows_.at(entry.name());
    if (!entry.corrects.empty())
      for (const auto& [name, value] : rows_.at(entry.corrects))
        weights[name] += value;
    return weights;
  }

  void pose(FittedHead& head, size_t s, double weight, Posed& out) {
    const auto found = head.face->shapes().find(entries_[s].name());
    if (found == head.face->shapes().end()) return;
    const Weights weights = played(s);
    const Eigen::VectorXd& truth = found->second.truth;
    out.weight = weight / truth.squaredNorm();
    out.gap = (head.pose(weights) - truth).cast<float>();
    const std::vector<Parameter> list = parameters(entries_[s], head.face->subject().channels(), 1.0);
    Eigen::MatrixXd slopes = head.slopes(weights, list);
    for (size_t p = 0; p < list.size(); ++p) {  // what does not act stays out
      const auto& [name, limit] = *list[p].limits.begin();
      const auto at = weights.find(name);
      if (at == weights.end() || std::abs(at->second) < 0.02)
        slopes.col(static_cast<Eigen::Index>(p)).setZero();
    }
    out.by_row = slopes.cast<float>();
    out.by_tissue = Eigen::MatrixXf::Zero(out.gap.size(), static_cast<Eigen::Index>(list_.size()));
  }

  void differ(bench::KnownFace& face, size_t s, size_t p, double by, Posed& out) {
    std::vector<float> values;
    for (const rig::Channel& channel : face.subject().channels())
      values.push_back(channel.rest);
    for (const auto& [name, value] : played(s))
      if (const int32_t at = face.subject().channel(name); at >= 0)
        values[static_cast<size_t>(at)] += static_cast<float>(value);
    for (size_t c = 0; c < values.size(); ++c)
      values[c] = std::max(values[c], face.subject().channels()[c].minimum);
    const Eigen::VectorXd& truth = face.shapes().at(entries_[s].name()).truth;
    const Eigen::VectorXf there = (face.pose(values) - truth).cast<float>();
    if (there.size() == out.gap.size())
      out.by_tissue.col(static_cast<Eigen::Index>(p)) = (there - out.gap) / static_cast<float>(by);
  }

  void gather(size_t s, const Posed& posed) {
    const double w = posed.weight;
    own_[s] += w * (posed.by_row.transpose() * posed.by_row).cast<double>();
    across_[s] += w * (posed.by_row.transpose() * posed.by_tissue).cast<double>();
    pull_[s] += w * (posed.by_row.transpose() * posed.gap).cast<double>();
    tissue_.curvature += w * (posed.by_tissue.transpose() * posed.by_tissue).cast<double>();
    tissue_.slope += w * (posed.by_tissue.transpose() * posed.gap).cast<double>();
    tissue_.value += w * static_cast<double>(posed.gap.squaredNorm());
  }

  const std::vector<ShapeEntry>& entries_;
  const std::map<std::string, Weights>& rows_;
  TissueOptions options_;
  std::vector<TissueParameter> list_;
  std::vector<Eigen::MatrixXd> own_, across_;  // by shape: rows' weights, and with the tissue
  std::vector<Eigen::VectorXd> pull_;
  Reduced tissue_;
};

}  // namespace

void identify_tissue(const std::vector<ShapeEntry>& entries, const std::map<std::string, Weights>& rows,
                     const std::vector<bench::SculptedHead>& heads, const std::vector<double>& head_weights,
                     const TissueOptions& options, const std::string& output) {
  const Json mechanics = read_json(fs::path(options.data) / "mechanics.json");
  const std::vector<TissueParameter> list = parameters_of(mechanics);
  Identification identification(entries, rows, options, list);
  double sum = 0.0;
  for (size_t h = 0; h < heads.size(); ++h) {
    std::printf("%s\n", heads[h].name.c_str());
    std::fflush(stdout);
    identification.add(heads[h], head_weights[h]);
    sum += head_weights[h];
  }
  const Eigen::VectorXd theta = identification.step(sum * static_cast<double>(entries.size()));
  std::vector<std::pair<TissueParameter, double>> changes;
  for (size_t p = 0; p < list.size(); ++p)
    if (const double by = theta[static_cast<Eigen::Index>(p)]; std::abs(by) > 0.02)
      changes.emplace_back(list[p], list[p].value * std::exp(by));
  write_changed(fs::path(options.data) / "mechanics.json", output, changes);
}

}  // namespace fascia::identify
