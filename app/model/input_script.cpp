#include "app/model/input_script.h"

#include <algorithm>
#include <sstream>
#include <utility>

#include "geometry/error.h"

namespace fascia::app {

namespace {

std::vector<std::string> words_of(const std::string& line, const std::string& where) {
  std::vector<std::string> words;
  std::string word;
  bool is_quoted = false, has_word = false;
  for (const char c : line) {
    if (c == '"') {
      is_quoted = !is_quoted;
      has_word = true;
    } else if (!is_quoted && c == '#') {
      break;
    } else if (!is_quoted && (c == ' ' || c == '\t' || c == '\r')) {
      if (has_word) words.push_back(std::exchange(word, {}));
      has_word = false;
    } else {
      word += c;
      has_word = true;
    }
  }
  if (is_quoted) throw Error(where + ": a quotation mark is not closed");
  if (has_word) words.push_back(word);
  return words;
}

}  // namespace

const std::vector<ScriptVerb>& script_verbs() {
  static const std::vector<ScriptVerb> verbs = {
      {"open", 1, 1, "open FILE: a head or a rig, and wait until it is there"},
      {"wait", 1, 1,
       "wait FRAMES|idle: let frames pass, or wait for builds and exports, and for the face to rest"},
      {"view", 1, 1, "view front|left|right|three-quarter|back|below"},
      {"layers", 1, 1, "layers skin,fat,smas,muscles,ligaments,skull,lattice,landmarks,strain"},
      {"panel", 1, 1, "panel pose|landmarks|muscles|warnings|compare|live|export"},
      {"set", 2, 2, "set NAME VALUE: a channel or set:member"},
      {"click", 1, 1, "click ITEM: a button or tab by its name"},
      {"drag", 3, 3, "drag LANDMARK RIGHT DOWN: with the mouse, in pixels"},
      {"poke", 3, 3, "poke LANDMARK RIGHT DOWN: pull the skin at a landmark with the mouse, and hold"},
      {"stroke", 3, 200,
       "stroke LANDMARK RIGHT DOWN [RIGHT DOWN ...]: draw with the mouse through places about a landmark, in "
       "pixels"},
      {"release", 0, 0, "release: let the mouse go"},
      {"key", 1, 1, "key ctrl+z: press a key"},
      {"type", 1, 1, "type TEXT"},
      {"take", 1, 1, "take FILE: load a recording"},
      {"layer", 1, 1, "layer FILE: add a recording to the one there is"},
      {"play", 1, 1, "play SECONDS"},
      {"seek", 1, 1, "seek SECONDS"},
      {"undo", 0, 0, "undo"},
      {"redo", 0, 0, "redo"},
      {"rebuild", 0, 0, "rebuild: build again with the edits, and wait"},
      {"compare", 1, 2, "compare none|rest|before|bullet|converged|file|other [FILE]"},
      {"export", 2, 2, "export rig|pose|play|arkit|picture|edits FILE, and wait"},
      {"theme", 1, 1, "theme dark|light"},
      {"size", 2, 2, "size WIDTH HEIGHT: of the window"},
      {"screenshot", 1, 1, "screenshot FILE.png: of the whole window"},
      {"picture", 1, 1, "picture FILE.png: of the face alone"},
      {"expect", 2, 2,
       "expect WHAT VALUE: end with an error unless "
       "rig|landmarks|sketches|layers|told|undo|redo|warnings|pose|panel "
       "is VALUE; of told, what was told last, a part"},
      {"quit", 0, 0, "quit"},
  };
  return verbs;
}

std::vector<ScriptStep> parse_script(const std::string& text, const std::string& where) {
  std::vector<ScriptStep> steps;
  std::istringstream lines(text);
  int number = 0;
  for (std::string line; std::getline(lines, line);) {
    const std::string place = where + ":" + std::to_string(++number);
    std::vector<std::string> words = words_of(line, place);
    if (words.empty()) continue;
    ScriptStep step{number, words[0], {words.begin() + 1, words.end()}};
    const auto verb = std::find_if(script_verbs().begin(), script_verbs().end(),
                                   [&](const ScriptVerb& known) { return step.verb == known.name; });
    if (verb == script_verbs().end()) {
      std::string names;
      for (const ScriptVerb& known : script_verbs())
        names += (names.empty() ? "" : ", ") + std::string(known.name);
      throw Error(place + ": '" + step.verb + "' is not known; there are " + names);
    }
    if (step.words.size() < verb->least || step.words.size() > verb->most)
      throw Error(place + ": use " + verb->usage);
    steps.push_back(std::move(step));
  }
  return steps;
}

}  // namespace fascia::app
