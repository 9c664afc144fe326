#include "cli/check.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <mutex>
#include <nlohmann/json.hpp>

#include "anatomy/checks.h"
#include "check/rig_head.h"
#include "cli/check_sheet.h"
#include "cli/common.h"
#include "cli/progress.h"
#include "formats/scene.h"
#include "geometry/error.h"
#include "geometry/text.h"

namespace fascia::cli {

namespace {

using Json = nlohmann::ordered_json;

struct CheckRequest {
  std::filesystem::path rig, sheet;
  std::string level;
};

Json number_or_null(const std::optional<double>& value) {
  return value && std::isfinite(*value) ? Json(*value) : Json(nullptr);
}

Json rows_json(const std::vector<check::Row>& rows) {
  Json list = Json::array();
  for (const check::Row& row : rows)
    list.push_back({{"name", row.name},
                    {"value", number_or_null(row.value)},
                    {"unit", row.unit},
                    {"least", number_or_null(row.least)},
                    {"most", number_or_null(row.most)},
                    {"ok", row.ok},
                    {"remedy", row.remedy},
                    {"pose", row.pose}});
  return list;
}

std::string table_of(const std::vector<check::Row>& rows) {
  size_t width = 4;
  for (const check::Row& row : rows)
    width = std::max(width, row.name.size());
  std::string text;
  for (const check::Row& row : rows) {
    char line[256];
    std::snprintf(line, sizeof line, "%s %-*s %9.2f %-9s %s\n", row.ok ? "  ok  " : " FAIL ",
                  static_cast<int>(width), row.name.c_str(), row.value, row.unit.c_str(),
                  bounds_text(row).c_str());
    text += line;
    if (!row.ok) text += "       in pose " + row.pose + ": " + row.remedy + "\n";
  }
  return text;
}

void run(const Common& common, const CheckRequest& request) {
  if (!request.sheet.empty()) {
    check_output(request.sheet, {request.rig});
    if (extension_of(request.sheet) != ".png")
      throw Error("'" + request.sheet.string() + "': a sheet is written as .png; give --sheet NAME.png");
  }
  Progress progress(common, "check", {{"poses", 1.0}, {"sheet", request.sheet.empty() ? 0.0 : 1.0}});
  const std::vector<uint8_t> bytes = formats::read_bytes(request.rig);
  const anatomy::Checks checks = anatomy::load_checks();
  std::vector<check::Row> rows;
  {
    progress.begin("poses");
    check::RigHead rig(bytes, "'" + request.rig.string() + "'", request.level);
    check::Options options;
    options.rest_motion = rig.rest_motion();
    Progress poses(common, "pose", checks.poses.size());
    const check::Player player = rig.player();
    std::mutex mutex;
    options.for_each = on_all_threads();
    rows = check::run(
        rig.head(),
        [&](const auto& weights) {
          {
            const std::lock_guard lock(mutex);
            poses.step();
          }
          return player(weights);
        },
        checks, options);
  }
  const int failed = check::failed(rows);
  if (!request.sheet.empty()) {
    progress.begin("sheet");
    view::write_png(request.sheet, check_sheet(request.rig, request.level, checks, rows));
  }
  if (!common.json) common.say(table_of(rows));
  common.say(failed == 0 ? "all " + std::to_string(rows.size()) + " rows hold"
                         : std::to_string(failed) + " of " + std::to_string(rows.size()) + " rows fail");
  if (!request.sheet.empty()) common.say("wrote " + request.sheet.string());
  common.report({{"rows", rows_json(rows)}, {"failed", failed}});
  if (failed > 0) throw Exit{exit_check};
}

}  // namespace

std::string bounds_text(const check::Row& row) {
  const auto number = [](double value) {
    char text[32];
    std::snprintf(text, sizeof text, "%.4g", value);
    return std::string(text);
  };
  if (row.least && row.most) return number(*row.least) + " to " + number(*row.most);
  return row.least ? "at least " + number(*row.least) : row.most ? "at most " + number(*row.most) : "";
}

std::vector<std::string> quick_check(const std::vector<uint8_t>& rig, const std::string& name,
                                     const anatomy::Checks& checks) {
  check::Options options;
  options.is_quick = true;
  options.for_each = on_all_threads();
  std::vector<std::string> warnings;
  std::vector<check::Row> rows;
  try {
    check::RigHead head(rig, "'" + name + "'", "low");
    rows = check::run(head.head(), head.player(), checks, options);
  } catch (const Error& error) {  // the rig is written all the same
    warnings.push_back(std::string("check: ") + error.what());
  }
  for (const check::Row& row : rows) {
    if (row.ok) continue;
    char value[64];
    std::snprintf(value, sizeof value, "%.2f %s", row.value, row.unit.c_str());
    warnings.push_back("check " + row.name + ": " + value + ", " + bounds_text(row) + " allowed; " +
                       row.remedy + " ('fascia check' has every row)");
  }
  return warnings;
}

void add_check(const Command& tool, Common& common) {
  auto request = std::make_shared<CheckRequest>();
  const Command command =
      tool.command("check", "Validate a rig on a fixed list of poses; exits with 4 if a row fails");
  add_rig_argument(command, request->rig);
  command
      .option("--sheet", &request->sheet,
              "Picture of every pose, from the front and at three quarters, with failures marked (.png)")
      .default_text("none");
  add_level_option(command, request->level);
  command.run([request, &common] { run(common, *request); });
}

}  // namespace fascia::cli
