// SPDX-License-Identifier: Apache-2.0
#include <EGL/egl.h>
#include <EGL/eglext.h>
#include <fmt/format.h>

#include <array>

#include "drivers/output/headless/gl_context.h"

namespace cyclorama::output {
namespace {

Error failed(const char* step) {
  return Error(ErrorCode::kUnavailable, fmt::format("headless EGL: {}: EGL error 0x{:04x}", step, eglGetError()));
}

class EglContext final : public GlContext {
 public:
  static Result<std::unique_ptr<GlContext>> make() {
    auto made = std::make_unique<EglContext>();
    TRY(made->open());
    return std::unique_ptr<GlContext>(std::move(made));
  }
  EglContext() = default;
  ~EglContext() override {
    if (context_ != EGL_NO_CONTEXT) {
      eglMakeCurrent(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
      eglDestroyContext(display_, context_);
    }
    // The display is not terminated: the process has only one surfaceless display, which another context may use.
    eglReleaseThread();
  }
  [[nodiscard]] std::string kind() const override { return "headless EGL"; }

 private:
  Status open() {
    display_ = eglGetPlatformDisplay(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, nullptr);
    if (display_ == EGL_NO_DISPLAY) return failed("no surfaceless display");
    if (eglInitialize(display_, nullptr, nullptr) != EGL_TRUE) return failed("starting the display");
    if (eglBindAPI(EGL_OPENGL_ES_API) != EGL_TRUE) return failed("choosing OpenGL ES");
    constexpr std::array<EGLint, 5> kVersion3{EGL_CONTEXT_MAJOR_VERSION, 3, EGL_CONTEXT_MINOR_VERSION, 0, EGL_NONE};
    context_ = eglCreateContext(display_, EGL_NO_CONFIG_KHR, EGL_NO_CONTEXT, kVersion3.data());
    if (context_ == EGL_NO_CONTEXT) return failed("making an OpenGL ES 3.0 context");
    if (eglMakeCurrent(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, context_) != EGL_TRUE)
      return failed("using the context");
    TRY_ASSIGN(gl_, Gl::load([](const char* name) { return eglGetProcAddress(name); }));
    return Done{};
  }

  EGLDisplay display_ = EGL_NO_DISPLAY;
  EGLContext context_ = EGL_NO_CONTEXT;
};

}  // namespace

Result<std::unique_ptr<GlContext>> make_egl_context() { return EglContext::make(); }

}  // namespace cyclorama::output
