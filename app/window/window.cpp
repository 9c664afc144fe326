#include "app/window/window.h"

#define GLFW_INCLUDE_NONE  // epoxy has OpenGL
#include <GLFW/glfw3.h>

#include <epoxy/gl.h>
#include <imgui.h>
#include <imgui_impl_glfw.h>
#include <imgui_impl_opengl3.h>

#include <algorithm>

#include "geometry/error.h"

namespace fascia::app {

namespace {

std::string reason() {
  const char* text = nullptr;
  glfwGetError(&text);
  return text ? text : "unknown reason";
}

void apply(const SyntheticInput& input) {
  ImGuiIO& io = ImGui::GetIO();
  io.DeltaTime = 1.0F / 60.0F;
  io.MousePos = {input.mouse_x, input.mouse_y};
  for (int i = 0; i < 3; ++i)
    io.MouseDown[i] = input.buttons[i];
  io.MouseWheel = input.wheel;
  for (const auto& [key, is_down] : input.keys)
    if (key >= 0 && key < IM_ARRAYSIZE(io.KeysDown)) io.KeysDown[key] = is_down;
  io.KeyCtrl = input.has_ctrl;
  io.KeyShift = input.has_shift;
  io.KeyAlt = input.has_alt;
  if (!input.text.empty()) io.AddInputCharactersUTF8(input.text.c_str());
}

}  // namespace

Window::Window(int width, int height, const std::string& title) {
  if (!glfwInit())
    throw Error("the window needs a display, and there is none (" + reason() +
                "): run it on a desktop, or under xvfb-run");
  glfwWindowHint(GLFW_CONTEXT_VERSION_MAJOR, 3);
  glfwWindowHint(GLFW_CONTEXT_VERSION_MINOR, 3);
  glfwWindowHint(GLFW_OPENGL_PROFILE, GLFW_OPENGL_CORE_PROFILE);
  glfwWindowHint(GLFW_OPENGL_FORWARD_COMPAT, GLFW_TRUE);
  window_ = glfwCreateWindow(width, height, title.c_str(), nullptr, nullptr);
  if (!window_) {
    const std::string why = reason();
    glfwTerminate();
    throw Error("no window with OpenGL 3.3 is to be had: " + why +
                "; install a newer graphics driver or Mesa");
  }
  glfwMakeContextCurrent(window_);
  glfwSwapInterval(1);
  glfwSetWindowSizeLimits(window_, 640, 420, GLFW_DONT_CARE, GLFW_DONT_CARE);
  ImGui::CreateContext();
  ImGui::GetIO().IniFilename = nullptr;
  glfwSetWindowUserPointer(window_, this);
  glfwSetDropCallback(window_, [](GLFWwindow* handle, int count, const char** paths) {
    const auto* self = static_cast<Window*>(glfwGetWindowUserPointer(handle));
    if (self->on_drop) self->on_drop({paths, paths + count});
  });
  ImGui_ImplGlfw_InitForOpenGL(window_, true);
  ImGui_ImplOpenGL3_Init("#version 330 core");
}

Window::~Window() {
  ImGui_ImplOpenGL3_Shutdown();
  ImGui_ImplGlfw_Shutdown();
  ImGui::DestroyContext();
  glfwDestroyWindow(window_);
  glfwTerminate();
}

void Window::begin_frame(double seconds, const SyntheticInput* synthetic) {
  if (seconds > 0.0)
    glfwWaitEventsTimeout(seconds);
  else
    glfwPollEvents();
  ImGui_ImplOpenGL3_NewFrame();
  ImGui_ImplGlfw_NewFrame();
  if (synthetic) apply(*synthetic);
  ImGui::NewFrame();
}

void Window::end_frame(const std::function<void()>& before_swap) {
  ImGui::Render();
  glBindFramebuffer(GL_FRAMEBUFFER, 0);
  glViewport(0, 0, width(), height());
  glDisable(GL_SCISSOR_TEST);
  glClearColor(0, 0, 0, 1);
  glClear(GL_COLOR_BUFFER_BIT);
  ImGui_ImplOpenGL3_RenderDrawData(ImGui::GetDrawData());
  if (before_swap) before_swap();
  glfwSwapBuffers(window_);
}

void Window::drop_frame() {
  ImGui::EndFrame();
}

bool Window::wants_to_close() const {
  return glfwWindowShouldClose(window_) != 0;
}

void Window::resize(int width, int height) {
  glfwSetWindowSize(window_, width, height);
}

int Window::width() const {
  int x = 0, y = 0;
  glfwGetFramebufferSize(window_, &x, &y);
  return x;
}

int Window::height() const {
  int x = 0, y = 0;
  glfwGetFramebufferSize(window_, &x, &y);
  return y;
}

float Window::display_scale() const {
  float x = 1.0F, y = 1.0F;
  glfwGetWindowContentScale(window_, &x, &y);
  return std::clamp(std::max(x, y), 1.0F, 4.0F);
}

void Window::renew_fonts() {
  ImGui_ImplOpenGL3_DestroyFontsTexture();
  ImGui_ImplOpenGL3_CreateFontsTexture();
}

}  // namespace fascia::app
