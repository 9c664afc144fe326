#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace fascia {

/// `text` with A to Z as a to z; every other byte stays, in any locale.
std::string lower_case(std::string_view text);

/// The file name's ending in lower case with its dot, ".glb" of "Head.GLB"; empty where there is none.
std::string extension_of(const std::filesystem::path& path);

/// `text` as HTML and XML show it: markup characters as entities, control characters that XML 1.0 forbids as
/// '?'.
std::string escaped_markup(std::string_view text);

}  // namespace fascia
