// SPDX-License-Identifier: Apache-2.0
// Included before gl.h: osmesa.h includes the desktop's GL header, which agrees with gl.h on all shared types and
// constants.
#include <GL/osmesa.h>

#include <array>

#include "drivers/output/headless/gl_context.h"

namespace cyclorama::output {
namespace {

// OSMesa requires a buffer to draw to, which stays unused, since all drawing goes to framebuffer objects.
constexpr int kUnusedSidePx = 16;

class OsMesaContext final : public GlContext {
 public:
  static Result<std::unique_ptr<GlContext>> make() {
    auto made = std::make_unique<OsMesaContext>();
    TRY(made->open());
    return std::unique_ptr<GlContext>(std::move(made));
  }
  OsMesaContext() = default;
  ~OsMesaContext() override {
    if (context_ == nullptr) return;
    OSMesaMakeCurrent(nullptr, nullptr, 0, 0, 0);
    OSMesaDestroyContext(context_);
  }
  [[nodiscard]] std::string kind() const override { return "OSMesa"; }

 private:
  Status open() {
    constexpr std::array<int, 9> kCore{OSMESA_FORMAT,
                                       OSMESA_RGBA,
                                       OSMESA_PROFILE,
                                       OSMESA_CORE_PROFILE,
                                       OSMESA_CONTEXT_MAJOR_VERSION,
                                       3,
                                       OSMESA_CONTEXT_MINOR_VERSION,
                                       3,
                                       0};
    context_ = OSMesaCreateContextAttribs(kCore.data(), nullptr);
    if (context_ == nullptr) return Error(ErrorCode::kUnavailable, "OSMesa: cannot make an OpenGL 3.3 context");
    if (OSMesaMakeCurrent(context_, unused_.data(), GL_UNSIGNED_BYTE, kUnusedSidePx, kUnusedSidePx) != GL_TRUE) {
      return Error(ErrorCode::kUnavailable, "OSMesa: cannot use its context");
    }
    TRY_ASSIGN(gl_, Gl::load([](const char* name) { return OSMesaGetProcAddress(name); }));
    return Done{};
  }

  std::array<unsigned char, 4 * kUnusedSidePx * kUnusedSidePx> unused_{};
  OSMesaContext context_ = nullptr;
};

}  // namespace

Result<std::unique_ptr<GlContext>> make_osmesa_context() { return OsMesaContext::make(); }

}  // namespace cyclorama::output
