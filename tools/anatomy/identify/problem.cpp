#include "tools/anatomy/identify/problem.h"

#include <algorithm>
#include <fstream>
#include <nlohmann/json.hpp>

#include "geometry/error.h"

namespace fascia::identify {
namespace {

std::string swapped(const std::string& name) {
  if (name.ends_with("_left")) return name.substr(0, name.size() - 5) + "_right";
  if (name.ends_with("_right")) return name.substr(0, name.size() - 6) + "_left";
  return name;
}

const rig::Channel* channel_of(const std::vector<rig::Channel>& channels, const std::string& name) {
  for (const rig::Channel& channel : channels)
    if (channel.name == name) return &channel;
  return nullptr;
}

}  // namespace

Weights mirrored(const Weights& weights) {
  Weights result;
  for (const auto& [name, value] : weights)
    result[swapped(name)] = name == "jaw_lateral" || name.rfind("eye_yaw", 0) == 0 ? -value : value;
  return result;
}

std::string ShapeEntry::mirror() const {
  const std::string row = name();
  return row.ends_with("Left") ? row.substr(0, row.size() - 4) + "Right" : "";
}

std::vector<ShapeEntry> read_entries(const std::string& path) {
  std::ifstream file(path);
  std::vector<ShapeEntry> entries;
  const nlohmann::json figures = nlohmann::json::parse(file);
  for (const auto& item : figures["shapes"]) {
    ShapeEntry entry;
    entry.shape = item["shape"];
    entry.is_paired = item.value("paired", false);
    entry.corrects = item.value("corrects", "");
    entry.actuators = item["actuators"].get<std::vector<std::string>>();
    entry.given = item.value("given", Weights());
    entry.bones = item.value("bones", Weights());
    entries.push_back(std::move(entry));
  }
  return entries;
}

std::vector<Parameter> parameters(const ShapeEntry& entry, const std::vector<rig::Channel>& channels,
                                  double reach) {
  const bool is_one_sided = !entry.mirror().empty();
  std::vector<Parameter> list;
  for (const std::string& word : entry.actuators) {
    std::string name = word;
    std::vector<std::string> sides = {"left", "right"};
    if (is_one_sided) sides = {"left"};
    if (name.rfind("other:", 0) == 0) {
      name = name.substr(6);
      sides = {"right"};
    } else if (name.rfind("both:", 0) == 0) {
      name = name.substr(5);
      sides = {"left", "right"};
    }
    const bool is_negative = name[0] == '-';
    if (is_negative) name = name.substr(1);
    Parameter parameter{word, {}};
    std::vector<std::string> names = {name};
    if (channel_of(channels, name) == nullptr) {
      names.clear();
      for (const std::string& side : sides)
        names.push_back(name + "_" + side);
    }
    for (const std::string& n : names) {
      const rig::Channel* channel = channel_of(channels, n);
      if (channel == nullptr) throw Error(entry.shape + ": the rigs have no actuator '" + n + "'");
      // A muscle below 0 lets go of what the shape that it corrects asks of it.
      const double least = channel->minimum < 0.0F ? static_cast<double>(channel->minimum) : -1.0;
      const bool is_muscle = channel->minimum == 0.0F && channel->group != "jaw";
      parameter.limits[n] =
          (is_negative ? least : static_cast<double>(channel->maximum)) * (is_muscle ? reach : 1.0);
    }
    list.push_back(std::move(parameter));
  }
  return list;
}

FittedHead::FittedHead(const bench::SculptedHead& head, const std::string& detail)
    : face(std::make_unique<bench::KnownFace>(head, detail)),
      sensitivity(std::make_unique<sim::Sensitivity>(face->subject().model())) {}

std::vector<float> FittedHead::values(const Weights& weights) const {
  const auto& channels = face->subject().channels();
  std::vector<float> result;
  for (const rig::Channel& channel : channels)
    result.push_back(channel.rest);
  for (const auto& [name, value] : weights)
    if (const int32_t at = face->subject().channel(name); at >= 0)
      result[static_cast<size_t>(at)] += static_cast<float>(value);
  for (size_t c = 0; c < channels.size(); ++c) {
    const bool is_muscle = channels[c].minimum == 0.0F && channels[c].group != "jaw";
    result[c] = is_muscle ? std::max(result[c], 0.0F)
                          : std::clamp(result[c], channels[c].minimum, channels[c].maximum);
  }
  return result;
}

Eigen::MatrixXd FittedHead::slopes(const Weights& weights, const std::vector<Parameter>& list) {
  fit::Subject& subject = face->subject();
  const std::vector<float> now = values(weights);
  if (!sensitivity->linearise(subject.controls(now), subject.nodes()))
    throw Error(face->head().name + ": the pose has no stiffness to linearise");
  std::vector<uint32_t> channels;
  for (const Parameter& parameter : list)
    for (const auto& [name, limit] : parameter.limits) {
      const int32_t at = subject.channel(name);
      if (at >= 0 && subject.channels()[static_cast<size_t>(at)].group != "jaw")
        channels.push_back(static_cast<uint32_t>(at));
    }
  std::sort(channels.begin(), channels.end());
  channels.erase(std::unique(channels.begin(), channels.end()), channels.end());
  const Eigen::MatrixXd own = sensitivity->columns(channels), jaw = sensitivity->jaw_columns();
  const Eigen::MatrixXd hung = subject.jaw_slopes(now);  // of vertices on the jaw itself
  Eigen::MatrixXd by_node = Eigen::MatrixXd::Zero(own.rows(), static_cast<Eigen::Index>(list.size()));
  Eigen::MatrixXd result =
      Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(3 * face->face().size()), by_node.cols());
  for (size_t p = 0; p < list.size(); ++p)
    for (const auto& [name, limit] : list[p].limits) {
      const auto column = static_cast<Eigen::Index>(p);
      const int motion = name == "jaw_open" ? 0 : name == "jaw_forward" ? 1 : name == "jaw_lateral" ? 2 : -1;
      if (motion >= 0) {
        by_node.col(column) += limit * jaw.col(motion);
        result.col(column) += limit * face->face_rows(hung.col(motion));
        continue;
      }
      const auto at = static_cast<uint32_t>(subject.channel(name));
      const auto place = std::lower_bound(channels.begin(), channels.end(), at) - channels.begin();
      by_node.col(column) += limit * own.col(place);
    }
  const auto& follow = subject.weights();
  for (size_t v = 0; v < face->face().size(); ++v) {
    const auto row = static_cast<Eigen::Index>(face->face()[v]);
    for (Eigen::SparseMatrix<double, Eigen::RowMajor>::InnerIterator it(follow, row); it; ++it)
      result.middleRows<3>(static_cast<Eigen::Index>(3 * v)) +=
          it.value() * by_node.middleRows<3>(3 * it.col());
  }
  return result;
}

}  // namespace fascia::identify
