#include "cli/landmark_frames.h"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "fit/live/landmark_sets.h"
#include "formats/landmark_file.h"
#include "formats/scene.h"
#include "geometry/error.h"
#include "geometry/json.h"

namespace fascia::cli {

namespace {

using PlainJson = nlohmann::json;

class Reader {
 public:
  explicit Reader(const std::filesystem::path& path) : path_(path) {}

  LandmarkFrames read() {
    const std::vector<uint8_t> bytes = formats::read_bytes(path_);
    const PlainJson content = parse_json<PlainJson>(bytes, "'" + path_.string() + "'");
    if (!content.is_object()) fail("it is not a JSON object");
    LandmarkFrames out;
    if (content.contains("frames")) {
      out.units = content.value("units", PlainJson()).is_string() ? content["units"].get<std::string>()
                                                                  : std::string();
      out.is_take = true;
      if (!content["frames"].is_array() || content["frames"].empty())
        fail("'frames' is not a list with entries");
      for (const PlainJson& entry : content["frames"])
        out.frames.push_back(frame(entry, "frame " + std::to_string(out.frames.size())));
      for (size_t f = 1; f < out.frames.size(); ++f)
        if (!(out.frames[f].time > out.frames[f - 1].time))
          fail("the times of its frames do not rise at frame " + std::to_string(f));
    } else if (content.contains("points")) {
      out.units = content.value("units", PlainJson()).is_string() ? content["units"].get<std::string>()
                                                                  : std::string();
      out.frames = {{0.0, by_number(content["points"], "'points'")}};
    } else if (has_flat_names(content)) {
      out.frames = {{0.0, by_name(content["landmarks"], "the file")}};
    } else {
      const formats::LandmarkFile file = formats::read_landmarks(path_);
      out.units = file.units;
      out.frames = {{0.0, file.points}};
    }
    out.is_flat = numbers_ == 2;
    return out;
  }

 private:
  [[noreturn]] void fail(const std::string& what) const { throw Error("'" + path_.string() + "': " + what); }

  /// Named points of two numbers each, without frames.
  static bool has_flat_names(const PlainJson& content) {
    const auto named = content.find("landmarks");
    return named != content.end() && named->is_object() &&
           std::any_of(named->begin(), named->end(),
                       [](const PlainJson& point) { return point.is_array() && point.size() == 2; });
  }

  Vec3 point(const PlainJson& value, const std::string& where) {
    Vec3 p = Vec3::Zero();
    if (!value.is_array() || (value.size() != 2 && value.size() != 3))
      fail(where + " is not two or three numbers");
    if (numbers_ != 0 && value.size() != numbers_)
      fail(where + " has another count of numbers than those before");
    numbers_ = value.size();
    for (size_t k = 0; k < value.size(); ++k) {
      if (!value[k].is_number()) fail(where + " is not two or three numbers");
      p[static_cast<Eigen::Index>(k)] = value[k].get<double>();
    }
    if (!p.allFinite()) fail(where + " is not finite");
    return p;
  }

  Landmarks by_name(const PlainJson& list, const std::string& where) {
    Landmarks points;
    for (const auto& [name, value] : list.items())
      points[name] = point(value, "landmark '" + name + "' of " + where);
    return points;
  }

  /// The landmarks that a detector's points show; one whose points it has not all seen (null) is left out.
  Landmarks by_number(const PlainJson& list, const std::string& where) {
    static const auto sets = fit::landmark_sets();
    const auto set = std::find_if(sets.begin(), sets.end(), [&](const fit::LandmarkSet& known) {
      return list.is_array() && known.points == list.size();
    });
    if (set == sets.end())
      fail(where +
           " are not the 68 points of iBUG or the 478 of MediaPipe; give others by our names under "
           "'landmarks'");
    Landmarks points;
    for (const fit::LandmarkSet::Entry& entry : set->entries) {
      if (std::any_of(entry.points.begin(), entry.points.end(),
                      [&](uint32_t p) { return list[p].is_null(); }))
        continue;
      Vec3 sum = Vec3::Zero();
      for (const uint32_t p : entry.points)
        sum += point(list[p], where + " " + std::to_string(p));
      points[entry.landmark] = sum / static_cast<double>(entry.points.size());
    }
    return points;
  }

  LandmarkFrame frame(const PlainJson& entry, const std::string& where) {
    if (!entry.is_object() || !entry.contains("time") || !entry["time"].is_number())
      fail(where + " has no 'time' in seconds");
    LandmarkFrame out{entry["time"].get<double>(), {}};
    if (entry.contains("points"))
      out.points = by_number(entry["points"], "the points of " + where);
    else if (entry.contains("landmarks") && entry["landmarks"].is_object())
      out.points = by_name(entry["landmarks"], where);
    else
      fail(where + " has neither 'points' nor 'landmarks'");
    return out;
  }

  std::filesystem::path path_;
  size_t numbers_ = 0;  ///< a point; 0: not known yet
};

}  // namespace

LandmarkFrames read_landmark_frames(const std::filesystem::path& path) {
  return Reader(path).read();
}

}  // namespace fascia::cli
