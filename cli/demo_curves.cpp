#include "cli/demo_curves.h"

#include <cmath>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "anatomy/anatomy.h"
#include "formats/scene.h"
#include "formats/write.h"
#include "geometry/error.h"
#include "geometry/smoothstep.h"

namespace fascia::cli {

namespace {

/// 0 before `begin`, 1 from `begin + rise` to `end - fall`, 0 after `end`; smooth in between.
double plateau(double time, double begin, double rise, double end, double fall) {
  return smoothstep((time - begin) / rise) * (1.0 - smoothstep((time - (end - fall)) / fall));
}

double blink(double time, double at) {
  return plateau(time, at, 0.07, at + 0.22, 0.12);
}

/// Syllables: jaw and lips at about five a second, never the same twice.
double speech(double time, double phase) {
  const double envelope = plateau(time, 7.0, 0.3, 9.6, 0.3);
  return envelope *
         std::max(0.0, 0.55 + 0.45 * std::sin(2 * M_PI * 4.3 * time + phase) +
                           0.2 * std::sin(2 * M_PI * 2.7 * time + 1.7 * phase)) *
         0.7;
}

}  // namespace

void write_demo_curves(const std::filesystem::path& path) {
  struct Column {
    std::string name;
    double (*value)(double);
  };
  const auto smile = [](double t) { return plateau(t, 0.5, 0.5, 2.6, 0.6); };
  const auto cheeks = [](double t) { return 0.7 * plateau(t, 0.6, 0.5, 2.5, 0.6); };
  const auto frown = [](double t) { return plateau(t, 2.8, 0.5, 4.6, 0.5); };
  const auto surprise = [](double t) { return plateau(t, 4.8, 0.25, 6.7, 0.6); };
  const auto lids = [](double t) {
    return std::max({blink(t, 0.15), blink(t, 2.65), blink(t, 4.55), blink(t, 6.85), blink(t, 8.4)});
  };
  const std::vector<Column> columns = {
      {"arkit:mouthSmileLeft", smile},
      {"arkit:mouthSmileRight", smile},
      {"arkit:cheekSquintLeft", cheeks},
      {"arkit:cheekSquintRight", cheeks},
      {"arkit:browDownLeft", frown},
      {"arkit:browDownRight", frown},
      {"arkit:mouthFrownLeft", frown},
      {"arkit:mouthFrownRight", frown},
      {"arkit:browInnerUp", surprise},
      {"arkit:browOuterUpLeft", surprise},
      {"arkit:browOuterUpRight", surprise},
      {"arkit:eyeWideLeft", surprise},
      {"arkit:eyeWideRight", surprise},
      {"arkit:eyeBlinkLeft", lids},
      {"arkit:eyeBlinkRight", lids},
      {"jaw_open", [](double t) { return 0.55 * plateau(t, 4.85, 0.3, 6.6, 0.6) + 0.35 * speech(t, 0.0); }},
      {"arkit:mouthFunnel", [](double t) { return 0.6 * speech(t, 2.0); }},
      {"arkit:mouthPucker", [](double t) { return 0.4 * speech(t, 4.0); }},
      {"arkit:mouthUpperUpLeft", [](double t) { return 0.4 * speech(t, 1.0); }},
      {"arkit:mouthUpperUpRight", [](double t) { return 0.4 * speech(t, 1.0); }},
  };
  std::string text = "time";
  for (const Column& column : columns)
    text += "," + column.name;
  text += "\n";
  for (int f = 0; f <= 600; ++f) {
    const double time = f / 60.0;
    char number[32];
    std::snprintf(number, sizeof number, "%.5f", time);
    text += number;
    for (const Column& column : columns) {
      std::snprintf(number, sizeof number, ",%.4f", column.value(time));
      text += number;
    }
    text += "\n";
  }
  formats::write_text(path, text);
}

}  // namespace fascia::cli
