#include "app/script_runner.h"

#define GLFW_INCLUDE_NONE  // epoxy has OpenGL
#include <GLFW/glfw3.h>

#include <algorithm>
#include <cctype>
#include <chrono>
#include <cmath>
#include <thread>
#include <utility>

#include "app/window/widgets.h"
#include "formats/files.h"
#include "geometry/error.h"

namespace fascia::app {

namespace {

constexpr int longest_wait = 60 * 600;  ///< frames: a step that takes longer hangs

int key_of(const std::string& name) {
  if (name.size() == 1 && std::isalnum(static_cast<unsigned char>(name[0])))
    return std::toupper(static_cast<unsigned char>(name[0]));
  for (const auto& [known, key] : {std::pair("space", GLFW_KEY_SPACE),
                                   {"escape", GLFW_KEY_ESCAPE},
                                   {"enter", GLFW_KEY_ENTER},
                                   {"tab", GLFW_KEY_TAB},
                                   {"home", GLFW_KEY_HOME},
                                   {"end", GLFW_KEY_END},
                                   {"left", GLFW_KEY_LEFT},
                                   {"right", GLFW_KEY_RIGHT},
                                   {"up", GLFW_KEY_UP},
                                   {"down", GLFW_KEY_DOWN},
                                   {"f1", GLFW_KEY_F1},
                                   {"backspace", GLFW_KEY_BACKSPACE}})
    if (name == known) return key;
  return -1;
}

}  // namespace

ScriptRunner::ScriptRunner(const std::filesystem::path& file) : file_(file) {
  const std::vector<uint8_t> bytes = formats::read_bytes(file);
  steps_ = parse_script({bytes.begin(), bytes.end()}, file.string());
}

void ScriptRunner::fail(const ScriptStep& step, const std::string& what) const {
  throw Error(file_.string() + ":" + std::to_string(step.line) + ": " + what);
}

std::filesystem::path ScriptRunner::input_file(const std::string& name) const {
  const std::filesystem::path path = name;
  if (path.is_absolute() || std::filesystem::exists(path)) return path;
  return file_.parent_path() / path;
}

void ScriptRunner::press_at(float x, float y) {
  SyntheticInput input;
  input.mouse_x = x;
  input.mouse_y = y;
  motions_.push_back({input, 3});
  input.buttons[0] = true;
  motions_.push_back({input, 2});
  input.buttons[0] = false;
  motions_.push_back({input, 2});
}

void ScriptRunner::drag(float x, float y, float right, float down, bool holds) {
  SyntheticInput input;
  input.mouse_x = x;
  input.mouse_y = y;
  motions_.push_back({input, 3});
  input.buttons[0] = true;
  motions_.push_back({input, 2});
  const int steps = 12;
  for (int i = 1; i <= steps; ++i) {
    input.mouse_x = x + right * static_cast<float>(i) / steps;
    input.mouse_y = y + down * static_cast<float>(i) / steps;
    motions_.push_back({input, 1});
  }
  if (holds) return;
  input.buttons[0] = false;
  motions_.push_back({input, 2});
}

void ScriptRunner::draw(const std::vector<ImVec2>& places) {
  SyntheticInput input;
  const int steps = 8;
  for (size_t i = 0; i < places.size(); ++i) {
    const ImVec2 from = places[i == 0 ? 0 : i - 1], to = places[i];
    for (int s = 1; s <= (i == 0 ? 1 : steps); ++s) {
      const float share = static_cast<float>(s) / static_cast<float>(i == 0 ? 1 : steps);
      input.mouse_x = from.x + share * (to.x - from.x);
      input.mouse_y = from.y + share * (to.y - from.y);
      motions_.push_back({input, i == 0 ? 3 : 1});
    }
    input.buttons[0] = true;
    if (i == 0) motions_.push_back({input, 2});
  }
  input.buttons[0] = false;
  motions_.push_back({input, 2});
}

ImVec2 ScriptRunner::pixel_of(const ScriptStep& step, const Workspace& work, const Screen& screen) const {
  const std::string& name = step.words[0];
  const auto place = work.landmark_now(name);
  if (!place) fail(step, "there is no landmark '" + name + "'");
  const Area area = face_area(work, screen.viewport);
  const auto pixel =
      work.orbit.pixel(*place, static_cast<double>(area.width), static_cast<double>(area.height));
  if (!pixel) fail(step, "the landmark '" + name + "' is not in the picture");
  return {area.x + static_cast<float>((*pixel)[0]), area.y + static_cast<float>((*pixel)[1])};
}

bool ScriptRunner::begin_hand(const ScriptStep& step, Workspace& work, Screen& screen) {
  const auto& words = step.words;
  if (step.verb == "click") {
    const auto found = ui::items().find(words[0]);
    if (found == ui::items().end()) fail(step, "there is no '" + words[0] + "' in the window now");
    const ImVec4 box = found->second;
    press_at(0.5F * (box.x + box.z), 0.5F * (box.y + box.w));
  } else if (step.verb == "drag" || step.verb == "poke") {
    const ImVec2 from = pixel_of(step, work, screen);
    if (step.verb == "poke") screen.tool = Tool::pull;
    drag(from.x, from.y, std::stof(words[1]), std::stof(words[2]), step.verb == "poke");
  } else if (step.verb == "stroke") {
    const ImVec2 from = pixel_of(step, work, screen);
    std::vector<ImVec2> places;
    for (size_t i = 1; i + 1 < words.size(); i += 2)
      places.emplace_back(from.x + std::stof(words[i]), from.y + std::stof(words[i + 1]));
    draw(places);
  } else if (step.verb == "release") {
    SyntheticInput input = input_;
    input.buttons[0] = false;
    motions_.push_back({input, 2});
  } else if (step.verb == "key") {
    SyntheticInput input;
    std::string rest = words[0];
    for (size_t plus = rest.find('+'); plus != std::string::npos && plus + 1 < rest.size();
         plus = rest.find('+')) {
      const std::string held = rest.substr(0, plus);
      if (held == "ctrl") input.has_ctrl = true;
      if (held == "shift") input.has_shift = true;
      if (held == "alt") input.has_alt = true;
      rest.erase(0, plus + 1);
    }
    const int key = key_of(rest);
    if (key < 0) fail(step, "the key '" + rest + "' is not known");
    input.keys[key] = true;
    motions_.push_back({input, 2});
    input.keys[key] = false;
    input.has_ctrl = input.has_shift = input.has_alt = false;
    motions_.push_back({input, 2});
  } else if (step.verb == "type") {
    SyntheticInput input = input_;
    input.text = words[0];
    motions_.push_back({input, 1});
    input.text.clear();
    motions_.push_back({input, 2});
  } else {
    return false;
  }
  return true;
}

void ScriptRunner::begin_export(const ScriptStep& step, Workspace& work, const Screen& screen) {
  const std::string& what = step.words[0];
  const std::filesystem::path file = step.words[1];
  if (!work.rig) fail(step, "there is nothing to export yet");
  if (what == "rig") {
    if (!work.save_rig(file)) fail(step, "the rig cannot be saved as '" + file.string() + "'");
  } else if (what == "edits") {
    if (!work.save_edits(file)) fail(step, "the edits cannot be saved as '" + file.string() + "'");
  } else if (what == "pose") {
    work.export_pose(file);
  } else if (what == "arkit") {
    work.run(bake_command(work.rig->file, "arkit", file), "Export " + file.filename().string());
  } else if (what == "play") {
    if (!work.take) fail(step, "load a recording first");
    work.export_take(file, 30.0);
  } else if (what == "picture") {
    const Area area = face_area(work, screen.viewport);
    work.draw_picture(file, static_cast<double>(area.width / std::max(area.height, 1.0F)));
  } else {
    fail(step, "export rig, pose, play, arkit, picture or edits");
  }
  written_.push_back(file.string());
  waits_idle_ = true;
}

bool ScriptRunner::begin_file(const ScriptStep& step, Workspace& work, Screen& screen) {
  const auto& words = step.words;
  if (step.verb == "open") {
    work.open(input_file(words[0]));
    waits_idle_ = true;
  } else if (step.verb == "take") {
    work.load_take(input_file(words[0]));
    work.wait_for_files();
    if (!work.take) fail(step, "'" + words[0] + "' is not a recording");
    work.playback.is_playing = false;
  } else if (step.verb == "layer") {
    const size_t before = work.state().take.layers.size();
    work.load_layer(input_file(words[0]));
    work.wait_for_files();
    if (work.state().take.layers.size() == before)
      fail(step, "'" + words[0] + "' cannot be added as a layer");
  } else if (step.verb == "export") {
    begin_export(step, work, screen);
  } else if (step.verb == "screenshot" || step.verb == "picture") {
    (step.verb == "screenshot" ? screenshot_ : picture_) = words[0];
    screen.wants_full = true;
    pictures_wait_ = 2;
    waits_ = 3;
    work.notices.clear();
  } else {
    return false;
  }
  return true;
}

void ScriptRunner::expect(const ScriptStep& step, const Workspace& work) const {
  const std::string& what = step.words[0];
  std::string value;
  if (what == "rig")
    value = work.rig ? "yes" : "no";
  else if (what == "landmarks")
    value = std::to_string(edited_landmarks(work.state()).size());
  else if (what == "sketches")
    value = std::to_string(count_sketches(work.state()));
  else if (what == "layers")
    value = std::to_string(work.state().take.layers.size());
  else if (what == "told")
    value = !work.notices.empty() && work.notices.back().text.find(step.words[1]) != std::string::npos
                ? step.words[1]
            : work.notices.empty() ? ""
                                   : work.notices.back().text;
  else if (what == "undo")
    value = work.history().undo_label();
  else if (what == "redo")
    value = work.history().redo_label();
  else if (what == "warnings")
    value = work.warnings.empty() ? "no" : "yes";
  else if (what == "pose")
    value = std::to_string(work.state().pose.size());
  else if (what == "panel")
    value = work.settings.panel;
  else
    fail(step, "expect rig, landmarks, sketches, layers, told, undo, redo, warnings, pose or panel");
  if (value != step.words[1]) fail(step, what + " is '" + value + "', not '" + step.words[1] + "'");
}

void ScriptRunner::begin(const ScriptStep& step, Workspace& work, Screen& screen, Window& window) {
  const auto& words = step.words;
  if (begin_hand(step, work, screen) || begin_file(step, work, screen)) return;
  if (step.verb == "wait") {
    if (words[0] == "idle")
      waits_idle_ = true;
    else
      waits_ = std::atoi(words[0].c_str());
  } else if (step.verb == "view") {
    work.orbit.go_to(words[0]);
    work.orbit.advance(0.0, true);
  } else if (step.verb == "layers") {
    work.settings.layers = layers_of(words[0]);
  } else if (step.verb == "panel") {
    work.settings.panel = words[0];
  } else if (step.verb == "set") {
    work.set_value(words[0], std::strtod(words[1].c_str(), nullptr), false);
  } else if (step.verb == "play") {
    work.playback.is_playing = true;
    waits_ = std::max(1, static_cast<int>(60.0 * std::strtod(words[0].c_str(), nullptr)));
  } else if (step.verb == "seek") {
    work.playback.is_playing = false;
    work.playback.time = std::strtod(words[0].c_str(), nullptr);
  } else if (step.verb == "undo") {
    work.undo();
  } else if (step.verb == "redo") {
    work.redo();
  } else if (step.verb == "rebuild") {
    work.rebuild();
    waits_idle_ = true;
  } else if (step.verb == "compare") {
    const std::string names[] = {"none", "rest", "before", "bullet", "converged", "file", "other"};
    const auto found =
        std::find(std::begin(names), std::end(names), words[0] == "reference" ? "converged" : words[0]);
    if (found == std::end(names))
      fail(step, "compare with none, rest, before, bullet, converged, file or other");
    work.compare_with(static_cast<Reference>(found - std::begin(names)),
                      words.size() > 1 ? input_file(words[1]).string() : "");
  } else if (step.verb == "theme") {
    work.settings.is_light = words[0] == "light";
    screen.wants_theme = true;
  } else if (step.verb == "size") {
    window.resize(std::atoi(words[0].c_str()), std::atoi(words[1].c_str()));
    waits_ = 10;
  } else if (step.verb == "expect") {
    expect(step, work);
  } else if (step.verb == "quit") {
    has_ended_ = true;
  }
}

void ScriptRunner::advance(Workspace& work, Screen& screen, Window& window) {
  input_.wheel = 0.0F;
  if (!motions_.empty()) {
    input_ = motions_.front().input;
    if (--motions_.front().frames <= 0) motions_.erase(motions_.begin());
    return;
  }
  if (waits_ > 0) {
    --waits_;
    return;
  }
  if (waits_idle_) {
    const int settled = 3, longest_settling = 240;  // frames
    idle_frames_ = work.is_idle() ? idle_frames_ + 1 : 0;
    calm_frames_ = work.is_busy() ? 0 : calm_frames_ + 1;
    if (work.is_busy() && (work.is_building() || !work.jobs().empty()))
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    if (++waited_frames_ > longest_wait)
      throw Error(file_.string() + ": the window has been busy for too long");
    if (idle_frames_ < settled && calm_frames_ < longest_settling) return;
    waits_idle_ = false;
    idle_frames_ = calm_frames_ = waited_frames_ = 0;
  }
  if (next_ >= steps_.size()) {
    has_ended_ = true;
    return;
  }
  begin(steps_[next_++], work, screen, window);
}

void ScriptRunner::take_pictures(const Screen& screen, const Window& window) {
  if (screenshot_.empty() && picture_.empty()) return;
  if (--pictures_wait_ > 0) return;
  if (!screenshot_.empty()) {
    view::write_png(screenshot_, read_pixels(0, 0, window.width(), window.height()));
    written_.push_back(std::exchange(screenshot_, {}));
  }
  if (!picture_.empty()) {
    const Area& area = screen.viewport;
    view::write_png(picture_, read_pixels(static_cast<int>(area.x),
                                          window.height() - static_cast<int>(area.y + area.height),
                                          static_cast<int>(area.width), static_cast<int>(area.height)));
    written_.push_back(std::exchange(picture_, {}));
  }
}

}  // namespace fascia::app
