#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "app/model/input_script.h"
#include "app/panels/screen.h"
#include "app/window/window.h"
#include "app/workspace.h"

namespace fascia::app {

/// Plays a script into the window: commands directly, mouse and keys as a hand would.
class ScriptRunner {
 public:
  /// Throws fascia::Error when the script is unsound. Files it names are looked for beside it.
  explicit ScriptRunner(const std::filesystem::path& file);

  /// Before each frame: the next step, or the next motion of the one under way. Throws fascia::Error naming
  /// the line when a step cannot be done.
  void advance(Workspace& work, Screen& screen, Window& window);
  /// After each frame, with the picture in the framebuffer.
  void take_pictures(const Screen& screen, const Window& window);

  const SyntheticInput& input() const { return input_; }
  bool has_ended() const { return has_ended_; }
  /// Whether the frame under way will be looked at.
  bool wants_picture() const { return !screenshot_.empty() || !picture_.empty(); }
  const std::vector<std::string>& written() const { return written_; }

 private:
  struct Motion {
    SyntheticInput input;
    int frames = 1;
  };
  void begin(const ScriptStep& step, Workspace& work, Screen& screen, Window& window);
  bool begin_hand(const ScriptStep& step, Workspace& work, Screen& screen);
  bool begin_file(const ScriptStep& step, Workspace& work, Screen& screen);
  void begin_export(const ScriptStep& step, Workspace& work, const Screen& screen);
  void expect(const ScriptStep& step, const Workspace& work) const;
  void press_at(float x, float y);
  /// Through places of the window with the mouse held.
  void draw(const std::vector<ImVec2>& places);
  /// Where the landmark that the step names is in the window.
  ImVec2 pixel_of(const ScriptStep& step, const Workspace& work, const Screen& screen) const;
  void drag(float x, float y, float right, float down, bool holds);
  [[noreturn]] void fail(const ScriptStep& step, const std::string& what) const;
  std::filesystem::path input_file(const std::string& name) const;

  std::filesystem::path file_;
  std::vector<ScriptStep> steps_;
  size_t next_ = 0;
  int waits_ = 0;  ///< frames
  bool waits_idle_ = false;
  int idle_frames_ = 0, calm_frames_ = 0, waited_frames_ = 0;
  std::vector<Motion> motions_;
  SyntheticInput input_;
  std::string screenshot_, picture_;
  int pictures_wait_ = 0;  ///< frames until the picture stands in its best
  std::vector<std::string> written_;
  bool has_ended_ = false;
};

}  // namespace fascia::app
