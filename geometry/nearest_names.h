#pragma once

#include <string>
#include <vector>

namespace fascia {

/// Those of `known` that look most like `name`, nearest first, `most` at the most; none when nothing is near.
/// Case, separators (`-`, `_`, `.`, `:`, spaces) and the order of neighbouring letters count for little; a
/// name that contains the other counts as near. Distance: optimal string alignment (Damerau 1964, "A
/// technique for computer detection and correction of spelling errors").
std::vector<std::string> nearest_names(const std::string& name, const std::vector<std::string>& known,
                                       size_t most = 3);

/// What to put behind an unknown name in a message: " (did you mean 'a', 'b' or 'c'?)", or nothing when none
/// is near.
std::string did_you_mean(const std::string& name, const std::vector<std::string>& known, size_t most = 3);

}  // namespace fascia
