#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace fascia {

/// `text` with ASCII letters in lower case, independent of the locale.
std::string lower_case(std::string_view text);

/// The file name's extension in lower case with its dot, ".glb" for "Head.GLB"; empty if there is none.
std::string extension_of(const std::filesystem::path& path);

/// `text` escaped for HTML and XML: markup characters as entities, control characters that XML 1.0 forbids as
/// '?'.
std::string escaped_markup(std::string_view text);

}  // namespace fascia
