#pragma once

#include <filesystem>
#include <optional>

#include "builder/rigging/build_rig.h"
#include "cli/common.h"

namespace fascia::cli {

struct BuildRequest {
  std::filesystem::path head, output, landmarks, edits;
  std::vector<std::filesystem::path> muscles;                ///< files of more muscles on the generic head
  std::vector<std::string> variants;                         ///< MUSCLE=VARIANT
  std::optional<double> fibre_spacing_mm, least_prevalence;  ///< none: as the edits say
  std::optional<double> smas_galea, smas_neck_mm;            ///< none: as the anatomy says
  std::filesystem::path anatomy;  ///< folder of corrected anatomy data; empty: all as built in
  std::filesystem::path report;   ///< folder of the page that shows the build; empty: none
  bool allow_outside = false;     ///< files a glTF names may lie outside its folder
  bool is_strict = false;         ///< a check that fails ends the tool with exit_check
  rigging::BuildOptions options;
};

/// The anatomy in `directory`, or the built-in one when that is empty. Throws fascia::Error.
anatomy::GenericAnatomy anatomy_for(const std::filesystem::path& directory);

/// Adds `--anatomy DIR` to a command that builds.
void add_anatomy_option(const Command& command, std::filesystem::path& directory);

/// Reads the head, builds its rig, writes it and checks it shortly; what the check finds is among the
/// report's warnings, and how many rows failed in `failed_checks` when that is not null. Throws
/// fascia::Error.
rigging::BuildReport build_file(const Common& common, const BuildRequest& request,
                                int* failed_checks = nullptr);

}  // namespace fascia::cli
