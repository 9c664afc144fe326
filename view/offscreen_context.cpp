#include "view/offscreen_context.h"

#include <epoxy/egl.h>

#include "geometry/error.h"

namespace fascia::view {

struct OffscreenContext::State {
  EGLDisplay display = EGL_NO_DISPLAY;
  EGLContext context = EGL_NO_CONTEXT;
};

OffscreenContext::OffscreenContext() : state_(std::make_unique<State>()) {
  EGLDisplay display = EGL_NO_DISPLAY;
  const auto get_display =
      reinterpret_cast<PFNEGLGETPLATFORMDISPLAYEXTPROC>(eglGetProcAddress("eglGetPlatformDisplayEXT"));
  if (get_display) display = get_display(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, nullptr);
  if (display == EGL_NO_DISPLAY) display = eglGetDisplay(EGL_DEFAULT_DISPLAY);
  if (display == EGL_NO_DISPLAY || !eglInitialize(display, nullptr, nullptr) || !eglBindAPI(EGL_OPENGL_API))
    throw Error("no OpenGL without a display: install Mesa's EGL (Debian: libegl1 libgl1-mesa-dri)");
  const EGLint wanted[] = {EGL_SURFACE_TYPE, EGL_PBUFFER_BIT, EGL_RENDERABLE_TYPE, EGL_OPENGL_BIT, EGL_NONE};
  EGLConfig config = nullptr;
  EGLint count = 0;
  eglChooseConfig(display, wanted, &config, 1, &count);
  const EGLint version[] = {EGL_CONTEXT_MAJOR_VERSION, 3, EGL_CONTEXT_MINOR_VERSION, 3, EGL_NONE};
  state_->display = display;
  state_->context = eglCreateContext(display, count ? config : nullptr, EGL_NO_CONTEXT, version);
  if (state_->context == EGL_NO_CONTEXT) throw Error("OpenGL 3.3 is not to be had on this machine");
  make_current();
}

OffscreenContext::~OffscreenContext() {
  eglMakeCurrent(state_->display, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
  eglDestroyContext(state_->display, state_->context);
  // The display stays initialised: other contexts of this process share it.
}

void OffscreenContext::make_current() const {
  if (!eglMakeCurrent(state_->display, EGL_NO_SURFACE, EGL_NO_SURFACE, state_->context))
    throw Error("OpenGL 3.3 is not to be had on this machine");
}

}  // namespace fascia::view
