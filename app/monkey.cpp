#include "app/monkey.h"

#define GLFW_INCLUDE_NONE  // epoxy has OpenGL
#include <GLFW/glfw3.h>

#include "app/window/widgets.h"

namespace fascia::app {

/// An item of the window as a rule, else anywhere.
void Monkey::choose_place(const Window& window) {
  const auto& items = ui::items();
  if (!items.empty() && upto(4) != 0) {
    auto item = items.begin();
    std::advance(item, upto(static_cast<int>(items.size())));
    const ImVec4 box = item->second;
    input_.mouse_x = box.x + share() * (box.z - box.x);
    input_.mouse_y = box.y + share() * (box.w - box.y);
    return;
  }
  input_.mouse_x = share() * static_cast<float>(window.width());
  input_.mouse_y = share() * static_cast<float>(window.height());
}

void Monkey::advance(Workspace& work, Screen& screen, Window& window) {
  input_.wheel = 0.0F;
  input_.text.clear();
  if (rest_-- > 0) {
    if (input_.buttons[0] || input_.buttons[1]) {
      input_.mouse_x += 30.0F * (share() - 0.5F);
      input_.mouse_y += 30.0F * (share() - 0.5F);
    }
    return;
  }
  rest_ = upto(8);
  for (auto& [key, is_down] : input_.keys)
    is_down = false;
  input_.has_ctrl = input_.has_shift = false;
  const int thought = upto(100);
  if (thought < 55) {
    input_.buttons[0] = !input_.buttons[0];
    if (input_.buttons[0]) choose_place(window);
  } else if (thought < 65) {
    input_.buttons[0] = false;
    choose_place(window);
    input_.wheel = 6.0F * (share() - 0.5F);
  } else if (thought < 72) {
    input_.buttons[1] = !input_.buttons[1];
  } else if (thought < 88) {
    const int keys[] = {GLFW_KEY_Z,     GLFW_KEY_Y,         GLFW_KEY_SPACE, GLFW_KEY_ESCAPE, GLFW_KEY_N,
                        GLFW_KEY_X,     GLFW_KEY_M,         GLFW_KEY_S,     GLFW_KEY_K,      GLFW_KEY_L,
                        GLFW_KEY_1,     GLFW_KEY_4,         GLFW_KEY_F,     GLFW_KEY_P,      GLFW_KEY_TAB,
                        GLFW_KEY_ENTER, GLFW_KEY_BACKSPACE, GLFW_KEY_LEFT,  GLFW_KEY_R,      GLFW_KEY_F1};
    input_.keys[keys[upto(static_cast<int>(std::size(keys)))]] = true;
    input_.has_ctrl = upto(3) == 0;
    input_.has_shift = upto(4) == 0;
  } else if (thought < 92) {
    input_.text = upto(2) ? "lip" : "-1e9";
  } else if (thought < 93) {
    window.resize(640 + upto(900), 420 + upto(600));
  } else if (thought < 94) {
    work.open_embedded_head();
  } else if (thought < 95) {
    work.open(upto(2) ? "/nonexistent.glb" : "/proc/self/exe");
  } else if (thought < 97 && screen.browser.is_open()) {
    input_.keys[GLFW_KEY_ESCAPE] = true;
  }
}

}  // namespace fascia::app
