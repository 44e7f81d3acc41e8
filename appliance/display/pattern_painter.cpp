// SPDX-License-Identifier: Apache-2.0
#include "appliance/display/pattern_painter.h"

namespace cyclorama::display {
namespace {

constexpr const char* kVertexShader = R"(#version 300 es
void main() {
  gl_Position = vec4((gl_VertexID & 1) == 0 ? -1.0 : 1.0, (gl_VertexID & 2) == 0 ? -1.0 : 1.0, 0.0, 1.0);
}
)";
// GL counts rows from the bottom, pictures from the top.
constexpr const char* kFragmentShader = R"(#version 300 es
precision highp float;
precision highp int;
uniform highp sampler2D pattern;
uniform int last_row;
out vec4 code;
void main() {
  ivec2 at = ivec2(gl_FragCoord.xy);
  code = vec4(texelFetch(pattern, ivec2(at.x, last_row - at.y), 0).rgb, 1.0);
}
)";

}  // namespace

Result<PatternPainter> PatternPainter::make(const output::Gl& gl, const std::vector<output::HeadMode>& heads) {
  TRY_ASSIGN(output::GlProgram program, output::GlProgram::link(gl, kVertexShader, kFragmentShader));
  PatternPainter painter(gl, std::move(program));
  painter.last_row_ = painter.program_.uniform("last_row");
  gl.UseProgram(painter.program_.id());
  gl.Uniform1i(painter.program_.uniform("pattern"), 0);
  for (const output::HeadMode& mode : heads)
    painter.heads_.push_back({output::GlTexture(gl), mode.width_px, mode.height_px, false});
  TRY(gl.check("preparing the patterns' shader"));
  return painter;
}

void PatternPainter::upload(std::size_t head, const RgbaImage& picture) {
  Head& to = heads_.at(head);
  CHECK(picture.width() == to.width_px && picture.height() == to.height_px);
  gl_->ActiveTexture(GL_TEXTURE0);
  gl_->BindTexture(GL_TEXTURE_2D, to.texture.id());
  gl_->PixelStorei(GL_UNPACK_ALIGNMENT, 1);
  if (to.has_storage) {
    gl_->TexSubImage2D(GL_TEXTURE_2D, 0, 0, 0, to.width_px, to.height_px, GL_RGBA, GL_UNSIGNED_BYTE,
                       picture.data().data());
    return;
  }
  to.has_storage = true;
  // The default filter would need mipmaps, which this texture lacks.
  gl_->TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
  gl_->TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
  gl_->TexImage2D(GL_TEXTURE_2D, 0, GL_RGBA8, to.width_px, to.height_px, 0, GL_RGBA, GL_UNSIGNED_BYTE,
                  picture.data().data());
}

void PatternPainter::draw(std::size_t head) const {
  const Head& from = heads_.at(head);
  CHECK(from.has_storage);
  gl_->UseProgram(program_.id());
  gl_->Uniform1i(last_row_, from.height_px - 1);
  gl_->ActiveTexture(GL_TEXTURE0);
  gl_->BindTexture(GL_TEXTURE_2D, from.texture.id());
  gl_->BindVertexArray(nothing_.id());
  gl_->DrawArrays(GL_TRIANGLE_STRIP, 0, 4);
}

}  // namespace cyclorama::display
