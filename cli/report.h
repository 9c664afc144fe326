#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "builder/rigging/build_rig.h"
#include "view/image.h"

namespace fascia::cli {

/// The page's name in the folder that `build --report` names.
inline constexpr const char* report_name = "report.html";

/// One stage in pictures, side by side.
struct StagePictures {
  std::string title, caption;
  std::vector<view::Image> views;
};

/// Draws the stages of the rig file: landmarks on the skin, skull in the skin, skull, SMAS, muscles; each
/// from the front, at three quarters and from the side. Throws fascia::Error when nothing can be drawn on
/// this machine.
std::vector<StagePictures> stage_pictures(const std::filesystem::path& rig,
                                          const rigging::BuildReport& report);

/// Writes `folder`/report.html: one page that needs nothing beside it, with pictures of every stage, the
/// depths against the table, every landmark, warnings and times. It is written beside and renamed into place.
/// Where nothing can be drawn the page says so and why.
void write_report(const std::filesystem::path& folder, const std::filesystem::path& head,
                  const std::filesystem::path& rig, const rigging::BuildReport& report);

}  // namespace fascia::cli
