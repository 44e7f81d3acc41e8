// SPDX-License-Identifier: Apache-2.0
#include "drivers/output/gl.h"

#include <fmt/format.h>

#include <type_traits>

namespace cyclorama::output {
namespace {

/// Casts an address to the type of a call. glFinish already has the type Procedure; a redundant cast would cause a
/// warning.
template <typename Call>
Call as(Gl::Procedure procedure) {
  if constexpr (std::is_same_v<Call, Gl::Procedure>) {
    return procedure;
  } else {
    return reinterpret_cast<Call>(procedure);
  }
}

}  // namespace

Result<Gl> Gl::load(const std::function<Procedure(const char*)>& address_of) {
  Gl gl;
#define CYCLORAMA_GL_LOAD(type, name)         \
  gl.name = as<type>(address_of("gl" #name)); \
  if (gl.name == nullptr) return Error(ErrorCode::kUnavailable, "the graphics driver has no gl" #name);
  CYCLORAMA_GL_CALLS(CYCLORAMA_GL_LOAD)
#undef CYCLORAMA_GL_LOAD
  if (gl.GetString(GL_VERSION) == nullptr) return Error(ErrorCode::kUnavailable, "no GL context is current");
  return gl;
}

std::string Gl::renderer() const {
  const auto text = [this](GLenum name) {
    const GLubyte* const bytes = GetString(name);
    return std::string(bytes == nullptr ? "?" : reinterpret_cast<const char*>(bytes));
  };
  return text(GL_RENDERER) + ", " + text(GL_VERSION);
}

Status Gl::check(std::string_view doing) const {
  const GLenum error = GetError();
  if (error == GL_NO_ERROR) return Done{};
  return Error(ErrorCode::kSystem, fmt::format("{}: GL error 0x{:04x}", doing, error));
}

}  // namespace cyclorama::output
