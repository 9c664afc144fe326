#include "builder/prepare/part_names.h"

#include <algorithm>
#include <cctype>
#include <string_view>
#include <vector>

namespace fascia::prepare {

namespace {

/// Small words of `text`; "EyeLashes_L" gives eye, lashes, l.
std::vector<std::string> words_of(const std::string& text) {
  std::vector<std::string> words;
  bool was_small = false, in_word = false;
  for (const char c : text) {
    const auto letter = static_cast<unsigned char>(c);
    if (!std::isalpha(letter)) {
      in_word = false;
      continue;
    }
    const bool is_capital = std::isupper(letter) != 0;
    if (!in_word || (is_capital && was_small)) words.emplace_back();
    words.back() += static_cast<char>(std::tolower(letter));
    was_small = !is_capital;
    in_word = true;
  }
  return words;
}

using Words = std::vector<std::string>;

bool has_word(const Words& words, std::initializer_list<std::string_view> wanted) {
  return std::any_of(words.begin(), words.end(), [&](const std::string& word) {
    return std::find(wanted.begin(), wanted.end(), word) != wanted.end();
  });
}

/// "eye" and "occlusion" one after the other, or written as one.
bool has_pair(const Words& words, std::string_view first, std::initializer_list<std::string_view> second) {
  for (size_t i = 0; i < words.size(); ++i)
    for (std::string_view end : second)
      if (words[i] == std::string(first) + std::string(end) ||
          (words[i] == first && i + 1 < words.size() && words[i + 1] == end))
        return true;
  return false;
}

/// For words so much their own that they may stand within others: "upperteeth".
bool holds(const Words& words, std::string_view stem) {
  return std::any_of(words.begin(), words.end(),
                     [&](const std::string& word) { return word.find(stem) != std::string::npos; });
}

std::optional<Part> part_of(const Words& words) {
  if (has_word(words, {"lash", "lashes"}) || holds(words, "eyelash")) return Part::lashes;
  if (has_word(words, {"brow", "brows"}) || holds(words, "eyebrow")) return Part::brows;
  if (has_word(words, {"lacrimal", "caruncle", "tear", "tears", "cartilage"}) ||
      has_pair(words, "tear", {"line", "duct"}) ||
      has_pair(words, "eye", {"occlusion", "blend", "shadow", "wet", "socket", "ao"}))
    return Part::eye_surround;
  if (has_word(words, {"gum", "gums", "gingiva"}))
    return holds(words, "tongue") ? Part::mouth_interior : Part::gums_upper;
  if (holds(words, "tongue")) return Part::tongue;
  if (has_word(words, {"palate", "mouthbag"}) ||
      has_pair(words, "mouth", {"inner", "bag", "lining", "interior", "cavity", "sock"}))
    return Part::mouth_interior;
  if (holds(words, "teeth") || has_word(words, {"tooth", "denture", "dentures", "dental", "dents", "incisor",
                                                "incisors", "molar", "molars"}))
    return Part::teeth_upper;
  if (has_word(words, {"glasses", "eyeglasses", "sunglasses", "spectacles", "goggles", "eyewear"}))
    return Part::glasses;
  if (has_word(words, {"hair", "hairs", "scalp", "beard", "mustache", "moustache", "stubble", "fringe",
                       "ponytail", "hairstyle"}))
    return Part::hair;
  if (has_word(words, {"cloth",   "clothes",  "clothing", "shirt", "tshirt", "jacket", "coat", "suit",
                       "dress",   "collar",   "scarf",    "hat",   "cap",    "helmet", "hood", "garment",
                       "sweater", "trousers", "pants",    "shoes", "tie",    "robe"}))
    return Part::clothes;
  return std::nullopt;
}

}  // namespace

NamedPart part_by_name(const std::string& names) {
  const Words words = words_of(names);
  NamedPart named;
  named.part = part_of(words);
  named.says_eye = !named.part && (holds(words, "eyeball") ||
                                   has_word(words, {"eye", "eyes", "iris", "sclera", "cornea", "pupil"}));
  if (has_word(words, {"lower", "bottom", "mandible", "mandibular", "low"}))
    named.jaw = NamedPart::Jaw::lower;
  if (has_word(words, {"upper", "top", "maxilla", "maxillary", "up"})) named.jaw = NamedPart::Jaw::upper;
  return named;
}

}  // namespace fascia::prepare
