#pragma once

#include <string>
#include <string_view>

/// Names as people read them: what the rig calls zygomaticus_major_left stands in the window as "Zygomaticus
/// major" under L.
namespace fascia::app {

enum class Half { none, left, right };

/// A name without its side.
struct SplitName {
  std::string base;  ///< zygomaticus_major, mouthSmile, 12
  Half half = Half::none;
};

/// Takes the side off a channel (`_left`), an ARKit name (`Left`) or an action unit (`L12`).
SplitName split_side(std::string_view name);

/// The same thing on the other side; the name itself when it has no side. Takes a set's prefix along.
std::string mirrored(std::string_view name);

/// Words for people: "Zygomaticus major", "Mouth smile", "AU 12". A side is left out.
std::string title_of(std::string_view name);

/// The same with its side in words: "Zygomaticus major, left".
std::string full_title(std::string_view name);

/// Where in the face a channel belongs, for the headings of a list: "Brow and eye", "Mouth", ...
std::string_view region_of(std::string_view channel);

/// True when every word of `search` is somewhere in `text`, in any order, whatever their case.
bool matches(std::string_view text, std::string_view search);

}  // namespace fascia::app
