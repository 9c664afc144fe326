#pragma once

#include <string>
#include <vector>

namespace fascia {

/// The names of `known` most similar to `name`, closest first, at most `most`; empty if none is similar.
/// Case, separators (`-`, `_`, `.`, `:`, spaces) and transposed neighbouring letters cost little; a name that
/// contains the other counts as similar. Distance: optimal string alignment (Damerau 1964, "A technique for
/// computer detection and correction of spelling errors").
std::vector<std::string> nearest_names(const std::string& name, const std::vector<std::string>& known,
                                       size_t most = 3);

/// A suffix for messages about unknown names: " (did you mean 'a', 'b' or 'c'?)", or empty if none is
/// similar.
std::string did_you_mean(const std::string& name, const std::vector<std::string>& known, size_t most = 3);

}  // namespace fascia
