// SPDX-License-Identifier: Apache-2.0
/// A GL context without a window. Internal to the headless output.
#pragma once

#include <memory>
#include <string>

#include "common/base/result.h"
#include "drivers/output/gl.h"

namespace cyclorama::output {

/// Current on the thread that made it, until it dies there. Thread-bound.
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

/// EGL on no surface at all (EGL_MESA_platform_surfaceless): a graphics card's render node, or the software rasteriser.
/// kUnavailable  the machine's EGL cannot; the message says which step failed.
Result<std::unique_ptr<GlContext>> make_egl_context();
/// Mesa's off-screen renderer, which needs nothing of the machine. Errors as make_egl_context().
Result<std::unique_ptr<GlContext>> make_osmesa_context();

}  // namespace cyclorama::output
