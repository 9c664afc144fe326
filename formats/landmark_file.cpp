#include "formats/landmark_file.h"

#include <nlohmann/json.hpp>

#include "formats/scene.h"
#include "geometry/error.h"
#include "geometry/json.h"

namespace fascia::formats {

namespace {

using nlohmann::json;

class Reader {
 public:
  Reader(const std::filesystem::path& path, LandmarkSurface surface)
      : path_(path),
        key_(surface == LandmarkSurface::skin ? "skin" : "bone"),
        other_(key_ == "skin" ? "bone" : "skin") {}

  LandmarkFile read() try {
    const std::vector<uint8_t> bytes = read_bytes(path_);
    if (bytes.empty()) throw Error("'" + path_.string() + "' is empty");
    const json content = parse_json<json>(bytes, "'" + path_.string() + "'");
    if (!content.is_object()) fail("it is not a JSON object");
    if (content.contains("markups"))
      read_markups(content["markups"]);
    else if (content.contains("landmarks"))
      read_plain(content);
    else
      fail("it has neither 'landmarks' nor 3D Slicer's 'markups'");
    if (file_.points.empty()) fail("it names no landmark");
    return file_;
  } catch (const json::exception& error) {
    fail(std::string("it is not as landmark files are: ") + error.what());
  }

 private:
  [[noreturn]] void fail(const std::string& what) const { throw Error("'" + path_.string() + "': " + what); }

  Vec3 point(const std::string& name, const json& value) const {
    if (!value.is_array() || value.size() != 3) fail("landmark '" + name + "' is not three numbers");
    Vec3 p;
    for (size_t k = 0; k < 3; ++k) {
      if (!value[k].is_number()) fail("landmark '" + name + "' is not three numbers");
      p[static_cast<int>(k)] = value[k].get<double>();
    }
    if (!p.allFinite()) fail("landmark '" + name + "' is not three finite numbers");
    return p;
  }

  void read_plain(const json& content) {
    if (content.contains("units") && content["units"].is_number()) {
      file_.units = content["units"].dump();
    } else if (content.contains("units")) {
      if (!content["units"].is_string())
        fail("'units' must be \"m\", \"cm\", \"mm\" or the metres of one unit");
      file_.units = content["units"].get<std::string>();
      if (file_.units != "m" && file_.units != "cm" && file_.units != "mm")
        fail("the units '" + file_.units + "' are unknown: use \"m\", \"cm\" or \"mm\"");
    }
    if (!content["landmarks"].is_object()) fail("'landmarks' must be an object of NAME: [x, y, z]");
    for (const auto& [name, value] : content["landmarks"].items()) {
      const bool has_both = value.is_object();
      if (has_both && !value.contains(key_) && value.contains(other_)) continue;
      file_.points[name] = point(name, has_both && value.contains(key_) ? value[key_] : value);
    }
  }

  void read_markups(const json& markups) {
    if (!markups.is_array()) fail("its 'markups' is not a list");
    for (const json& markup : markups) {
      if (!markup.is_object() || !markup.contains("controlPoints") || !markup["controlPoints"].is_array())
        continue;
      const json system = markup.value("coordinateSystem", json("LPS"));
      const bool is_ras = system == "RAS" || system == 0 || system == "0";
      for (const json& control : markup["controlPoints"]) {
        if (!control.is_object() || control.value("positionStatus", json("defined")) != "defined") continue;
        if (!control.contains("label") || !control["label"].is_string()) fail("a control point has no label");
        const std::string name = control["label"].get<std::string>();
        Vec3 p = point(name, control.value("position", json()));
        if (is_ras) p = Vec3(-p[0], -p[1], p[2]);
        file_.points[name] = p;
      }
    }
  }

  std::filesystem::path path_;
  std::string key_, other_;  ///< of the surface asked for, and of the other one
  LandmarkFile file_;
};

}  // namespace

LandmarkFile read_landmarks(const std::filesystem::path& path, LandmarkSurface surface) {
  return Reader(path, surface).read();
}

}  // namespace fascia::formats
