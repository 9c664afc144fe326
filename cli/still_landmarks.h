#pragma once

#include <array>
#include <string_view>

namespace fascia::cli {

/// Landmarks that expressions leave about where they are: they tell where the head is.
inline constexpr std::array<std::string_view, 12> still_landmarks = {
    "nasion",           "sellion",           "glabella",          "rhinion",
    "exocanthion_left", "exocanthion_right", "endocanthion_left", "endocanthion_right",
    "tragion_left",     "tragion_right",     "pronasale",         "subnasale"};

}  // namespace fascia::cli
