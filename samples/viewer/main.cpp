// A window on a rig: sliders, an orbiting camera, layers, a timeline.
#include <epoxy/gl.h>
// epoxy comes before GLFW, which would bring its own OpenGL header.
#include <GLFW/glfw3.h>
#include <imgui.h>
#include <imgui_impl_glfw.h>
#include <imgui_impl_opengl3.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>

#include "panel.h"

namespace {

struct Arguments {
  std::string rig, curves, screenshot;
  std::vector<std::pair<std::string, float>> values;
  std::string layers = "skin";
  int frames = -1;  // -1: until the window is closed
};

Arguments arguments_of(int argc, char** argv) {
  Arguments arguments;
  for (int i = 1; i < argc; ++i) {
    const std::string word = argv[i];
    const auto next = [&]() -> std::string {
      if (i + 1 == argc) throw std::invalid_argument(word + " needs a value");
      return argv[++i];
    };
    if (word == "--curves") {
      arguments.curves = next();
    } else if (word == "--frames") {
      arguments.frames = std::atoi(next().c_str());
    } else if (word == "--screenshot") {
      arguments.screenshot = next();
    } else if (word == "--layers") {
      arguments.layers = next();
    } else if (word == "--set") {
      const std::string pair = next();
      const std::size_t sign = pair.rfind('=');
      if (sign == std::string::npos) throw std::invalid_argument("--set needs NAME=VALUE");
      arguments.values.emplace_back(pair.substr(0, sign), std::strtof(pair.c_str() + sign + 1, nullptr));
    } else if (arguments.rig.empty() && word.rfind("--", 0) != 0) {
      arguments.rig = word;
    } else {
      throw std::invalid_argument("unknown argument " + word);
    }
  }
  if (arguments.rig.empty()) throw std::invalid_argument("no rig");
  return arguments;
}

Layers layers_of(const std::string& names) {
  const auto has = [&](const char* name) { return names.find(name) != std::string::npos; };
  Layers layers;
  layers.skin = has("skin");
  layers.skull = has("skull");
  layers.smas = has("smas");
  layers.fibres = has("muscles");
  if (layers.skin && (layers.skull || layers.smas || layers.fibres)) layers.skin_opacity = 0.35F;
  return layers;
}

/// A window with a context and Dear ImGui in it.
class Window {
 public:
  Window() {
    if (glfwInit() == 0) throw std::runtime_error("no display: " + reason() + "; run under xvfb-run");
    glfwWindowHint(GLFW_CONTEXT_VERSION_MAJOR, 3);
    glfwWindowHint(GLFW_CONTEXT_VERSION_MINOR, 3);
    glfwWindowHint(GLFW_OPENGL_PROFILE, GLFW_OPENGL_CORE_PROFILE);
    glfwWindowHint(GLFW_SAMPLES, 4);
    window_ = glfwCreateWindow(1100, 700, "Fascia", nullptr, nullptr);
    if (window_ == nullptr) {
      glfwTerminate();
      throw std::runtime_error("no OpenGL 3.3 window: " + reason());
    }
    glfwMakeContextCurrent(window_);
    glfwSwapInterval(1);
    ImGui::CreateContext();
    ImGui::GetIO().IniFilename = nullptr;
    ImGui_ImplGlfw_InitForOpenGL(window_, true);
    ImGui_ImplOpenGL3_Init("#version 330 core");
  }
  ~Window() {
    ImGui_ImplOpenGL3_Shutdown();
    ImGui_ImplGlfw_Shutdown();
    ImGui::DestroyContext();
    glfwDestroyWindow(window_);
    glfwTerminate();
  }
  Window(const Window&) = delete;
  Window& operator=(const Window&) = delete;
  GLFWwindow* get() const { return window_; }

 private:
  static std::string reason() {
    const char* text = nullptr;
    glfwGetError(&text);
    return text == nullptr ? "unknown reason" : text;
  }
  GLFWwindow* window_ = nullptr;
};

/// Left drag turns, right drag shifts, the wheel nears.
void move_camera(Orbit& orbit) {
  const ImGuiIO& io = ImGui::GetIO();
  if (io.WantCaptureMouse) return;
  if (io.MouseDown[0]) {
    orbit.yaw -= 0.008F * io.MouseDelta.x;
    orbit.pitch = std::clamp(orbit.pitch + 0.008F * io.MouseDelta.y, -1.5F, 1.5F);
  }
  if (io.MouseDown[1]) orbit.target[1] += 0.001F * orbit.distance * io.MouseDelta.y;
  orbit.distance *= 1.0F - 0.08F * io.MouseWheel;
}

int run(const Arguments& arguments) {
  Scene scene(arguments.rig, arguments.curves);
  for (const auto& [name, value] : arguments.values)
    check(fascia_face_set(scene.face.get(), name.c_str(), value), "--set");
  const Window window;
  Drawing drawing(scene);
  Orbit orbit = drawing.first_view();
  Layers layers = layers_of(arguments.layers);
  double last = glfwGetTime();
  for (int frame = 0; frame != arguments.frames && glfwWindowShouldClose(window.get()) == 0; ++frame) {
    glfwPollEvents();
    ImGui_ImplOpenGL3_NewFrame();
    ImGui_ImplGlfw_NewFrame();
    ImGui::NewFrame();
    show_panel(scene, layers);
    move_camera(orbit);
    const double now = glfwGetTime();
    // A run of a given number of frames is the same every time.
    scene.advance(arguments.frames >= 0 ? 1.0 / 60.0 : now - last);
    last = now;
    int width = 0, height = 0;
    glfwGetFramebufferSize(window.get(), &width, &height);
    drawing.draw(scene, layers, orbit, width, height);
    ImGui::Render();
    ImGui_ImplOpenGL3_RenderDrawData(ImGui::GetDrawData());
    if (frame + 1 == arguments.frames && !arguments.screenshot.empty())
      write_screenshot(arguments.screenshot, width, height);
    glfwSwapBuffers(window.get());
  }
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  try {
    return run(arguments_of(argc, argv));
  } catch (const std::invalid_argument& error) {
    std::fprintf(stderr,
                 "%s\nusage: sample_viewer RIG.glb [--curves FILE] [--set NAME=VALUE]... [--layers "
                 "skin,skull,smas,muscles]"
                 " [--frames N] [--screenshot FILE.png]\n",
                 error.what());
    return 2;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
}
