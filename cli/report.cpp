#include "cli/report.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "cli/page.h"
#include "formats/scene.h"
#include "geometry/error.h"
#include "geometry/text.h"

namespace fascia::cli {

namespace {

using Figures = rigging::BuildReport::LandmarkFigures;

using page::number;
using page::row;

std::string warnings_part(const rigging::BuildReport& report) {
  if (report.warnings.empty()) return "<p>No warnings.</p>\n";
  std::string out = "<div class=warn><ul>\n";
  for (const std::string& warning : report.warnings)
    out += "<li>" + escaped_markup(warning) + "</li>\n";
  return out + "</ul></div>\n";
}

std::string times_part(const rigging::BuildReport& report) {
  double total = 0.0, longest = 1e-9;
  for (const auto& stage : report.stages) {
    total += stage.seconds;
    longest = std::max(longest, stage.seconds);
  }
  std::string out = "<table>\n";
  for (const auto& stage : report.stages)
    out += row({escaped_markup(stage.name), number(stage.seconds, 2) + " s",
                "<span class=bar style=\"width:" + number(240 * stage.seconds / longest, 0) + "px\"></span>"},
               "td", 1);
  return out + row({"<b>all</b>", "<b>" + number(total, 2) + " s</b>", ""}) + "</table>\n";
}

std::string figures_part(const rigging::BuildReport& report) {
  size_t fibres = 0;
  for (const auto& muscle : report.muscles)
    fibres += static_cast<size_t>(muscle.fibres);
  std::string out = "<table>\n";
  out += row({"units of the file", escaped_markup(report.units)});
  out += row({"landmarks given, found",
              std::to_string(report.landmarks_given) + ", " + std::to_string(report.landmarks_found)});
  out += row({"bone off its targets, rms and largest",
              number(report.landmark_rms_mm) + " and " + number(report.landmark_max_mm) + " mm"});
  out += row({"points of bone curves used",
              std::to_string(report.curve_points_used) + " of " + std::to_string(report.curve_points)});
  out += row({"bone vertices outside the skin", std::to_string(report.bone_outside_skin)});
  out +=
      row({"bone vertices moved inward at the end", std::to_string(report.bone_corrected) + ", by at most " +
                                                        number(report.bone_corrected_max_mm) + " mm"});
  if (report.skull_uncovered_share > 0)
    out +=
        row({"of the skull left out, no skin over it", number(100 * report.skull_uncovered_share, 0) + " %"});
  out += row({"SMAS triangles, least angle",
              std::to_string(report.smas_triangles) + ", " + number(report.smas_min_angle_deg) + "&deg;"});
  out += row({"SMAS vertices outside skin and bone", std::to_string(report.smas_outside_layers)});
  out += row({"muscles, fibres", std::to_string(report.muscles.size()) + ", " + std::to_string(fibres)});
  for (const auto& level : report.tissue)
    out += row({"tissue, " + escaped_markup(level.name),
                std::to_string(level.nodes) + " nodes, " + std::to_string(level.springs) + " springs"});
  return out + "</table>\n";
}

/// Fitted depth less the table's, in standard deviations between people, as columns.
std::string histogram_part(const std::vector<Figures>& landmarks) {
  constexpr int columns = 17, width = 34, height = 150;  // half a deviation each, from -4.25 to 4.25
  std::vector<int> counts(columns, 0);
  int all = 0, within = 0;
  for (const Figures& landmark : landmarks) {
    if (!landmark.has_bone || !(landmark.deviation_mm > 0)) continue;
    const double off = (landmark.depth_mm - landmark.table_mm) / landmark.deviation_mm;
    ++counts[static_cast<size_t>(
        std::clamp(static_cast<int>(std::lround(2 * off)) + columns / 2, 0, columns - 1))];
    ++all;
    within += std::abs(off) <= 1;
  }
  const int most = std::max(1, *std::max_element(counts.begin(), counts.end()));
  std::string out = "<svg role=img width=" + std::to_string(columns * width + 2) +
                    " height=" + std::to_string(height + 44) +
                    " font-family=sans-serif font-size=12 text-anchor=middle>\n";
  for (int i = 0; i < columns; ++i) {
    const int tall = counts[static_cast<size_t>(i)] * height / most, x = i * width, half = i - columns / 2;
    out += "<rect x=" + std::to_string(x + 1) + " y=" + std::to_string(20 + height - tall) +
           " width=" + std::to_string(width - 2) + " height=" + std::to_string(tall) + " fill=\"" +
           (std::abs(half) <= 2 ? "#4a78a8" : "#c8744a") + "\"/>\n";
    if (counts[static_cast<size_t>(i)] > 0)
      out += "<text x=" + std::to_string(x + width / 2) + " y=" + std::to_string(15 + height - tall) + ">" +
             std::to_string(counts[static_cast<size_t>(i)]) + "</text>\n";
    if (half % 2 == 0)
      out +=
          "<text x=" + std::to_string(x + width / 2) + " y=" + std::to_string(height + 38) + ">" +
          (half == 0 ? "table" : (half > 0 ? "+" : "&minus;") + std::to_string(std::abs(half) / 2) + " SD") +
          "</text>\n";
  }
  return out +
         "</svg>\n<p class=cap>Tissue depth at the landmarks less the table's mean, in the table's standard "
         "deviations between people. " +
         std::to_string(within) + " of " + std::to_string(all) + " lie within one.</p>\n";
}

std::string landmarks_part(const std::vector<Figures>& landmarks) {
  std::string out =
      "<table>\n" +
      row({"landmark", "origin", "confidence", "depth mm", "table mm", "SD mm", "residual mm"}, "th", 2);
  for (const Figures& landmark : landmarks) {
    const std::string origin = landmark.given ? "given" : "found";
    const std::string name = escaped_markup(landmark.name) + (landmark.required ? " *" : "");
    if (!landmark.has_bone) {
      out += row({name, origin, number(landmark.confidence, 2), "", "", "", ""}, "td", 2);
      continue;
    }
    const bool far = landmark.deviation_mm > 0 &&
                     std::abs(landmark.depth_mm - landmark.table_mm) > 2 * landmark.deviation_mm;
    const std::string depth = number(landmark.depth_mm);
    out += row(
        {name, origin, number(landmark.confidence, 2), far ? "<span class=far>" + depth + "</span>" : depth,
         number(landmark.table_mm), number(landmark.deviation_mm), number(landmark.residual_mm)},
        "td", 2);
  }
  return out +
         "</table>\n<p class=cap>* one of those a person would have to place. Red: more than two deviations "
         "off the table.</p>\n";
}

std::string pictures_part(const std::filesystem::path& rig, const rigging::BuildReport& report) {
  std::vector<StagePictures> stages;
  try {
    stages = stage_pictures(rig, report);
  } catch (const Error& error) {
    return "<p class=warn>No pictures: " + escaped_markup(error.what()) + "</p>\n";
  }
  std::string out;
  for (const StagePictures& stage : stages) {
    out += "<h2>" + stage.title + "</h2>\n<p class=cap>" + stage.caption + "</p>\n<div class=views>";
    for (const view::Image& image : stage.views)
      out += page::picture(image, stage.title);
    out += "</div>\n";
  }
  return out;
}

}  // namespace

void write_report(const std::filesystem::path& folder, const std::filesystem::path& head,
                  const std::filesystem::path& rig, const rigging::BuildReport& report) {
  std::string body;
  body += "<h2>Warnings</h2>\n" + warnings_part(report);
  body += pictures_part(rig, report);
  body += "<h2>Figures</h2>\n" + figures_part(report);
  body += "<h2>Tissue depth against the table</h2>\n" + histogram_part(report.landmarks);
  body += "<h2>Landmarks</h2>\n" + landmarks_part(report.landmarks);
  body += "<h2>Time</h2>\n" + times_part(report);
  formats::write_text(folder / report_name, page::whole("Face rig of " + head.filename().string(), body));
}

}  // namespace fascia::cli
