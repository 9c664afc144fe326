#include "app/model/names.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <utility>

namespace fascia::app {

namespace {

char lower(char c) {
  return static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
}

bool is_number(std::string_view text) {
  return !text.empty() &&
         std::all_of(text.begin(), text.end(), [](unsigned char c) { return std::isdigit(c) != 0; });
}

/// Before and after the colon of set:member.
std::pair<std::string_view, std::string_view> set_and_member(std::string_view name) {
  const size_t colon = name.find(':');
  if (colon == std::string_view::npos) return {"", name};
  return {name.substr(0, colon), name.substr(colon + 1)};
}

/// mouthSmile → mouth smile, zygomaticus_major → zygomaticus major; runs of capitals stay.
std::string words_of(std::string_view name) {
  std::string words;
  for (size_t i = 0; i < name.size(); ++i) {
    const char c = name[i];
    const bool is_upper = std::isupper(static_cast<unsigned char>(c)) != 0;
    const bool after_lower = i > 0 && std::islower(static_cast<unsigned char>(name[i - 1])) != 0;
    if (c == '_')
      words += ' ';
    else if (is_upper && after_lower)
      (words += ' ') += lower(c);
    else
      words += c;
  }
  if (!words.empty()) words[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(words[0])));
  return words;
}

constexpr std::array<std::pair<std::string_view, std::string_view>, 38> regions = {{
    {"frontalis", "Brow and eye"},
    {"procerus", "Brow and eye"},
    {"corrugator", "Brow and eye"},
    {"depressor_supercilii", "Brow and eye"},
    {"orbicularis_oculi", "Brow and eye"},
    {"levator_palpebrae", "Brow and eye"},
    {"lid", "Brow and eye"},
    {"eye", "Brow and eye"},
    {"nasalis", "Nose and upper lip"},
    {"depressor_septi", "Nose and upper lip"},
    {"levator_labii", "Nose and upper lip"},
    {"zygomaticus_minor", "Nose and upper lip"},
    {"zygomaticus_major", "Mouth and cheek"},
    {"levator_anguli", "Mouth and cheek"},
    {"risorius", "Mouth and cheek"},
    {"buccinator", "Mouth and cheek"},
    {"buccal", "Mouth and cheek"},
    {"orbicularis_oris", "Mouth and cheek"},
    {"incisivus", "Mouth and cheek"},
    {"compressor", "Mouth and cheek"},
    {"lip", "Mouth and cheek"},
    {"oral", "Mouth and cheek"},
    {"pressure", "Mouth and cheek"},
    {"depressor_anguli", "Lower lip and chin"},
    {"depressor_labii", "Lower lip and chin"},
    {"mentalis", "Lower lip and chin"},
    {"platysma", "Lower lip and chin"},
    {"jaw", "Jaw"},
    {"masseter", "Jaw"},
    {"temporalis", "Jaw"},
    {"medial_pterygoid", "Jaw"},
    {"lateral_pterygoid", "Jaw"},
    {"digastric", "Jaw"},
    {"mylohyoid", "Jaw"},
    {"geniohyoid", "Jaw"},
    {"tongue", "Mouth and cheek"},
    {"upper_lip", "Mouth and cheek"},
    {"lower_lip", "Mouth and cheek"},
}};

}  // namespace

SplitName split_side(std::string_view name) {
  const std::string_view member = set_and_member(name).second;
  // Motions to one side are no halves of a pair.
  for (const char* motion : {"jawLeft", "jawRight", "mouthLeft", "mouthRight"})
    if (member == motion) return {std::string(member), Half::none};
  for (const auto& [ending, half] : {std::pair("_left", Half::left),
                                     {"_right", Half::right},
                                     {"Left", Half::left},
                                     {"Right", Half::right}})
    if (member.size() > std::string_view(ending).size() && member.ends_with(ending))
      return {std::string(member.substr(0, member.size() - std::string_view(ending).size())), half};
  if (member.size() > 1 && (member[0] == 'L' || member[0] == 'R') && is_number(member.substr(1)))
    return {std::string(member.substr(1)), member[0] == 'L' ? Half::left : Half::right};
  return {std::string(member), Half::none};
}

std::string mirrored(std::string_view name) {
  const auto [set, member] = set_and_member(name);
  const std::string prefix = set.empty() ? "" : std::string(set) + ":";
  const SplitName split = split_side(member);
  if (split.half == Half::none) return std::string(name);
  const bool to_right = split.half == Half::left;
  if (is_number(split.base)) return prefix + (to_right ? "R" : "L") + split.base;
  if (member.find('_') != std::string_view::npos)
    return prefix + split.base + (to_right ? "_right" : "_left");
  return prefix + split.base + (to_right ? "Right" : "Left");
}

std::string title_of(std::string_view name) {
  const SplitName split = split_side(name);
  if (is_number(split.base)) return "AU " + split.base;
  return words_of(split.base);
}

std::string full_title(std::string_view name) {
  const SplitName split = split_side(name);
  const std::string title = title_of(name);
  if (split.half == Half::none) return title;
  return title + (split.half == Half::left ? ", left" : ", right");
}

std::string_view region_of(std::string_view channel) {
  for (const auto& [start, region] : regions)
    if (channel.starts_with(start)) return region;
  return "Other";
}

bool matches(std::string_view text, std::string_view search) {
  size_t at = 0;
  while (at < search.size()) {
    const size_t space = std::min(search.find(' ', at), search.size());
    const std::string_view word = search.substr(at, space - at);
    const auto found = std::search(text.begin(), text.end(), word.begin(), word.end(),
                                   [](char a, char b) { return lower(a) == lower(b); });
    if (found == text.end() && !word.empty()) return false;
    at = space + 1;
  }
  return true;
}

}  // namespace fascia::app
