// SPDX-License-Identifier: Apache-2.0
#include "drivers/output/drm/canvas.h"

#include <fmt/format.h>

#include <array>

namespace cyclorama::output {
namespace {

// One triangle that covers everything; `place` is (0, 0) at the panel's first pixel.
constexpr char kVertexShader[] = R"(#version 300 es
out vec2 place;
void main() {
  place = vec2(gl_VertexID == 1 ? 2.0 : 0.0, gl_VertexID == 2 ? 2.0 : 0.0);
  gl_Position = vec4(2.0 * place - 1.0, 0.0, 1.0);
}
)";
constexpr char kFragmentShader[] = R"(#version 300 es
precision highp float;
uniform highp sampler2D canvas;
uniform vec4 s;  // Texture coordinate: s.x * place.x + s.y * place.y + s.z.
uniform vec4 t;
in vec2 place;
out vec4 colour;
void main() {
  vec3 p = vec3(place, 1.0);
  colour = vec4(texture(canvas, vec2(dot(s.xyz, p), dot(t.xyz, p))).rgb, 1.0);
}
)";

struct Affine {
  std::array<float, 3> s;
  std::array<float, 3> t;
};

/// Maps a position on the panel (from its top left) to the canvas's texture (from its bottom left).
Affine to_texture(Rotation rotation) {
  switch (rotation) {
    case Rotation::kNone:
      return {{1, 0, 0}, {0, -1, 1}};
    case Rotation::kQuarter:
      return {{0, 1, 0}, {1, 0, 0}};
    case Rotation::kHalf:
      return {{-1, 0, 1}, {0, 1, 0}};
    case Rotation::kThreeQuarters:
      break;
  }
  return {{0, -1, 1}, {-1, 0, 1}};
}

bool is_turned_aside(Rotation rotation) {
  return rotation == Rotation::kQuarter || rotation == Rotation::kThreeQuarters;
}

}  // namespace

Result<Canvas> Canvas::make(const Gl& gl, int width_px, int height_px) {
  GLint largest = 0;
  gl.GetIntegerv(GL_MAX_TEXTURE_SIZE, &largest);
  if (width_px < 1 || height_px < 1 || width_px > largest || height_px > largest) {
    return Error(ErrorCode::kInvalidArgument,
                 fmt::format("{}x{} pixels cannot be drawn; a side is 1 to {}", width_px, height_px, largest));
  }
  Canvas canvas;
  canvas.width_px_ = width_px;
  canvas.height_px_ = height_px;
  canvas.texture_ = GlTexture(gl);
  canvas.framebuffer_ = GlFramebuffer(gl);
  gl.ActiveTexture(GL_TEXTURE0);
  gl.BindTexture(GL_TEXTURE_2D, canvas.texture_.id());
  gl.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
  gl.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
  gl.TexImage2D(GL_TEXTURE_2D, 0, GL_RGB10_A2, width_px, height_px, 0, GL_RGBA, GL_UNSIGNED_INT_2_10_10_10_REV,
                nullptr);
  gl.BindFramebuffer(GL_FRAMEBUFFER, canvas.framebuffer_.id());
  gl.FramebufferTexture2D(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, canvas.texture_.id(), 0);
  if (gl.CheckFramebufferStatus(GL_FRAMEBUFFER) != GL_FRAMEBUFFER_COMPLETE)
    return Error(ErrorCode::kUnavailable, "the graphics driver cannot draw 10 bits per colour");
  gl.ClearColor(0.0f, 0.0f, 0.0f, 1.0f);
  gl.Clear(GL_COLOR_BUFFER_BIT);
  TRY(gl.check("making a head's canvas"));
  return canvas;
}

Result<CanvasCopier> CanvasCopier::make(const Gl& gl) {
  TRY_ASSIGN(GlProgram program, GlProgram::link(gl, kVertexShader, kFragmentShader));
  CanvasCopier copier(gl, std::move(program));
  copier.s_ = copier.program_.uniform("s");
  copier.t_ = copier.program_.uniform("t");
  gl.UseProgram(copier.program_.id());
  gl.Uniform1i(copier.program_.uniform("canvas"), 0);
  TRY(gl.check("preparing the copy to the heads"));
  return copier;
}

void CanvasCopier::copy(const Canvas& from, Rotation rotation, const Target& to) const {
  const bool is_aside = is_turned_aside(rotation);
  const bool is_scaled = (is_aside ? from.height_px() : from.width_px()) != to.width_px ||
                         (is_aside ? from.width_px() : from.height_px()) != to.height_px;
  const Affine affine = to_texture(rotation);
  gl_->BindFramebuffer(GL_FRAMEBUFFER, to.framebuffer);
  gl_->Viewport(0, 0, to.width_px, to.height_px);
  gl_->UseProgram(program_.id());
  gl_->Uniform4f(s_, affine.s[0], affine.s[1], affine.s[2], 0.0f);
  gl_->Uniform4f(t_, affine.t[0], affine.t[1], affine.t[2], 0.0f);
  gl_->ActiveTexture(GL_TEXTURE0);
  gl_->BindTexture(GL_TEXTURE_2D, from.texture());
  const GLint filter = is_scaled ? GL_LINEAR : GL_NEAREST;
  gl_->TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, filter);
  gl_->TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, filter);
  gl_->BindVertexArray(no_attributes_.id());
  gl_->DrawArrays(GL_TRIANGLES, 0, 3);
}

}  // namespace cyclorama::output
