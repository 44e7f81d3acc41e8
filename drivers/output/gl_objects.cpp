// SPDX-License-Identifier: Apache-2.0
#include "drivers/output/gl_objects.h"

#include <fmt/format.h>

#include <array>
#include <string>

namespace cyclorama::output {
namespace {

std::string log_of(GLuint id, PFNGLGETSHADERINFOLOGPROC read) {
  std::array<char, 1024> text{};
  GLsizei length = 0;
  read(id, static_cast<GLsizei>(text.size()), &length, text.data());
  return std::string(text.data(), static_cast<std::size_t>(length));
}

/// Compiles a shader and attaches it to the program, which keeps the shader alive for as long as necessary.
Status attach(const Gl& gl, GLuint program, GLenum kind, const char* source) {
  const GLuint shader = gl.CreateShader(kind);
  gl.ShaderSource(shader, 1, &source, nullptr);
  gl.CompileShader(shader);
  GLint compiled = GL_FALSE;
  gl.GetShaderiv(shader, GL_COMPILE_STATUS, &compiled);
  const std::string log = compiled == GL_TRUE ? "" : log_of(shader, gl.GetShaderInfoLog);
  if (compiled == GL_TRUE) gl.AttachShader(program, shader);
  gl.DeleteShader(shader);
  if (compiled == GL_TRUE) return Done{};
  return Error(ErrorCode::kSystem, fmt::format("compiling a shader: {}", log));
}

}  // namespace

Result<GlProgram> GlProgram::link(const Gl& gl, const char* vertex_source, const char* fragment_source) {
  GlProgram program(gl, gl.CreateProgram());
  TRY(attach(gl, program.id(), GL_VERTEX_SHADER, vertex_source));
  TRY(attach(gl, program.id(), GL_FRAGMENT_SHADER, fragment_source));
  gl.LinkProgram(program.id());
  GLint linked = GL_FALSE;
  gl.GetProgramiv(program.id(), GL_LINK_STATUS, &linked);
  if (linked == GL_TRUE) return program;
  return Error(ErrorCode::kSystem, fmt::format("linking a shader: {}", log_of(program.id(), gl.GetProgramInfoLog)));
}

void to_picture(const RgbaImage& read_back, RgbImage* ret_picture) {
  CHECK(ret_picture->width() == read_back.width() && ret_picture->height() == read_back.height());
  for (int y = 0; y < read_back.height(); ++y) {
    const std::uint8_t* from =
        read_back.data().data() + read_back.row_values() * static_cast<std::size_t>(read_back.height() - 1 - y);
    std::uint8_t* to = ret_picture->data().data() + ret_picture->row_values() * static_cast<std::size_t>(y);
    for (int x = 0; x < read_back.width(); ++x, from += 4, to += 3) {
      to[0] = from[0];
      to[1] = from[1];
      to[2] = from[2];
    }
  }
}

}  // namespace cyclorama::output
