// SPDX-License-Identifier: Apache-2.0
/// A GL context without a window. Internal to the headless output.
#pragma once

#include <memory>
#include <string>

#include "common/base/result.h"
#include "drivers/output/gl.h"

namespace cyclorama::output {

/// A GL context that is current on the thread that made it, and must be destroyed on that thread. Thread-bound.
class GlContext {
 public:
  virtual ~GlContext() = default;
  GlContext(const GlContext&) = delete;
  GlContext& operator=(const GlContext&) = delete;
  [[nodiscard]] const Gl& gl() const { return gl_; }
  [[nodiscard]] virtual std::string kind() const = 0;

 protected:
  GlContext() = default;
  Gl gl_;
};

/// EGL without a surface (EGL_MESA_platform_surfaceless), on a graphics card's render node or the software rasteriser.
/// Errors: kUnavailable if the machine's EGL does not support it; the message names the step that failed.
Result<std::unique_ptr<GlContext>> make_egl_context();
/// Mesa's off-screen renderer, which needs no device. Errors: those of make_egl_context().
Result<std::unique_ptr<GlContext>> make_osmesa_context();

}  // namespace cyclorama::output
