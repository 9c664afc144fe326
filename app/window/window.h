#pragma once

#include <functional>
#include <map>
#include <string>
#include <vector>

struct GLFWwindow;

namespace fascia::app {

/// What a hand would do, put in place of the mouse and the keyboard: scripts and the monkey use it.
struct SyntheticInput {
  float mouse_x = -1.0F, mouse_y = -1.0F;
  bool buttons[3] = {false, false, false};
  float wheel = 0.0F;
  std::map<int, bool> keys;  ///< GLFW's numbers
  bool has_ctrl = false, has_shift = false, has_alt = false;
  std::string text;  ///< typed in this frame
};

/// A window with an OpenGL 3.3 context and Dear ImGui in it.
class Window {
 public:
  /// Throws fascia::Error when there is no display or no OpenGL 3.3.
  Window(int width, int height, const std::string& title);
  ~Window();
  Window(const Window&) = delete;
  Window& operator=(const Window&) = delete;

  /// Takes events in, waiting for one up to `seconds`, and begins a frame. `synthetic` stands in for the hand
  /// when it is not null; the frame then lasts a sixtieth of a second.
  void begin_frame(double seconds, const SyntheticInput* synthetic);
  /// Draws what Dear ImGui has and shows it; `before_swap` sees the whole picture in the window's
  /// framebuffer.
  void end_frame(const std::function<void()>& before_swap);
  /// Ends a frame that nobody sees.
  void drop_frame();

  bool wants_to_close() const;
  void resize(int width, int height);
  int width() const;   ///< pixels
  int height() const;  ///< pixels
  /// How large the display wants text.
  float display_scale() const;
  /// After the fonts have changed.
  void renew_fonts();

  /// Called with files dropped on the window.
  std::function<void(const std::vector<std::string>&)> on_drop;

 private:
  GLFWwindow* window_ = nullptr;
};

}  // namespace fascia::app
