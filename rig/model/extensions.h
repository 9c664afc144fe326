#pragma once

#include <array>
#include <string>

namespace fascia::rig {

/// The glTF extensions a rig file carries (pages and schemas under rig/spec), and their version.
inline const std::string skull_extension = "FASCIA_skull";
inline const std::string smas_extension = "FASCIA_smas";
inline const std::string muscles_extension = "FASCIA_muscles";
inline const std::string tissue_extension = "FASCIA_tissue";
inline const std::string actuation_extension = "FASCIA_actuation";
inline const std::string spec_version = "1.0";

/// All of them, in the order in which they are written.
inline const std::array<std::string, 5> extensions = {skull_extension, smas_extension, muscles_extension,
                                                      tissue_extension, actuation_extension};

}  // namespace fascia::rig
