// SPDX-License-Identifier: Apache-2.0
#include "appliance/display/panorama_texture.h"

#include <algorithm>
#include <span>
#include <string>

namespace cyclorama::display {
namespace {

constexpr GLint kLumaUnit = 0;
constexpr GLint kBlueUnit = 1;
constexpr GLint kRedUnit = 2;

// Computes the corners of a rectangle from their numbers.
constexpr const char* kVertexShader = R"(#version 300 es
precision highp float;
uniform vec4 place;  // In clip space: left, top, right, bottom.
void main() {
  gl_Position = vec4((gl_VertexID & 1) == 0 ? place.x : place.z, (gl_VertexID & 2) == 0 ? place.y : place.w, 0.0, 1.0);
}
)";
// The polynomial approximates ((c + 0.055) / 1.055)^2.4 within 0.013 code values of 8 bits, by Remez exchange; it takes
// a third of pow()'s time on a software rasteriser.
constexpr const char* kFragmentShader = R"(
precision highp float;
precision highp int;
uniform highp sampler2D luma_plane;
uniform highp sampler2D blue_plane;
uniform highp sampler2D red_plane;
uniform vec4 luma;        // Texture coordinate = gl_FragCoord.xy * xy + zw.
uniform vec4 chroma;      // Likewise; chroma of half the size lies between its pixels' centres.
uniform vec4 chroma_end;  // The first and the last centre; texels beyond them belong to another picture.
#ifdef PACKED
out uint texel;
#else
out vec4 light;
#endif
void main() {
  float y = texture(luma_plane, gl_FragCoord.xy * luma.xy + luma.zw).r;
  vec2 at = clamp(gl_FragCoord.xy * chroma.xy + chroma.zw, chroma_end.xy, chroma_end.zw);
  float blue = texture(blue_plane, at).r - 128.0 / 255.0;
  float red = texture(red_plane, at).r - 128.0 / 255.0;
  vec3 c = clamp(vec3(y + 1.402 * red, y - 0.344136286 * blue - 0.714136286 * red, y + 1.772 * blue), 0.0, 1.0);
  vec3 p = ((((0.0872824213 * c - 0.307377663) * c + 0.66716066) * c + 0.519381961) * c + 0.0327460791) * c
           + 0.000916890727;
  p = mix(p, c / 12.92, lessThanEqual(c, vec3(0.04045)));
#ifdef PACKED  // Format of texels.h, red in the low bits.
  uvec3 root = uvec3(sqrt(p) * vec3(2047.0, 2047.0, 1023.0) + 0.5);
  texel = root.r | root.g << 11 | root.b << 22;
#else
  light = vec4(p, 1.0);
#endif
}
)";

void filter(const output::Gl& gl, GLint filter, GLint wrap) {
  gl.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, filter);
  gl.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, filter);
  gl.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_S, wrap);
  gl.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_T, wrap);
}

}  // namespace

Result<PictureProgram> PictureProgram::make(const output::Gl& gl, Texels texels) {
  const std::string fragment_shader =
      std::string("#version 300 es\n") + (texels == Texels::kPacked ? "#define PACKED\n" : "") + kFragmentShader;
  TRY_ASSIGN(output::GlProgram linked, output::GlProgram::link(gl, kVertexShader, fragment_shader.c_str()));
  PictureProgram program(std::move(linked), texels);
  program.nothing_ = output::GlVertexArray(gl);
  const output::GlProgram& of = program.program_;
  program.place_ = of.uniform("place");
  program.luma_ = of.uniform("luma");
  program.chroma_ = of.uniform("chroma");
  program.chroma_end_ = of.uniform("chroma_end");
  gl.UseProgram(of.id());
  gl.Uniform1i(of.uniform("luma_plane"), kLumaUnit);
  gl.Uniform1i(of.uniform("blue_plane"), kBlueUnit);
  gl.Uniform1i(of.uniform("red_plane"), kRedUnit);
  TRY(gl.check("preparing the picture shader"));
  return program;
}

PanoramaTexture::PanoramaTexture(const output::Gl& gl, const PictureProgram& program)
    : gl_(&gl),
      program_(&program),
      luma_{output::GlTexture(gl)},
      blue_{output::GlTexture(gl)},
      red_{output::GlTexture(gl)},
      light_(gl),
      target_(gl) {
  gl_->BindTexture(GL_TEXTURE_2D, luma_.texture.id());
  filter(*gl_, GL_NEAREST, GL_CLAMP_TO_EDGE);
  for (const Plane* plane : {&blue_, &red_}) {
    gl_->BindTexture(GL_TEXTURE_2D, plane->texture.id());
    // Mirrors instead of clamping, since llvmpipe filters clamped bytes in 8 bits only. Sampled positions never reach
    // the edge, where the two would differ.
    filter(*gl_, GL_LINEAR, GL_MIRRORED_REPEAT);
  }
  gl_->BindTexture(GL_TEXTURE_2D, light_.id());
  filter(*gl_, program.texels_ == Texels::kPacked ? GL_NEAREST : GL_LINEAR, GL_CLAMP_TO_EDGE);
}

Status PanoramaTexture::grow(int width, int height) {
  if (width <= width_ && height <= height_) return Done{};
  width_ = std::max(width, width_);
  height_ = std::max(height, height_);
  gl_->BindTexture(GL_TEXTURE_2D, light_.id());
  if (texels() == Texels::kPacked) {
    gl_->TexImage2D(GL_TEXTURE_2D, 0, GL_R32UI, width_, height_, 0, GL_RED_INTEGER, GL_UNSIGNED_INT, nullptr);
  } else {
    gl_->TexImage2D(GL_TEXTURE_2D, 0, GL_RGBA16F, width_, height_, 0, GL_RGBA, GL_HALF_FLOAT, nullptr);
  }
  gl_->BindFramebuffer(GL_FRAMEBUFFER, target_.id());
  gl_->FramebufferTexture2D(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, light_.id(), 0);
  if (gl_->CheckFramebufferStatus(GL_FRAMEBUFFER) != GL_FRAMEBUFFER_COMPLETE) {
    return Error(ErrorCode::kSystem, "the graphics driver cannot draw the light of a panorama");
  }
  return gl_->check("making room for a panorama");
}

void PanoramaTexture::upload(const GreyImage& pixels, const PixelRect& part, Plane* ret_plane) {
  gl_->BindTexture(GL_TEXTURE_2D, ret_plane->texture.id());
  if (pixels.width() > ret_plane->width || pixels.height() > ret_plane->height) {
    ret_plane->width = std::max(pixels.width(), ret_plane->width);
    ret_plane->height = std::max(pixels.height(), ret_plane->height);
    gl_->TexImage2D(GL_TEXTURE_2D, 0, GL_R8, ret_plane->width, ret_plane->height, 0, GL_RED, GL_UNSIGNED_BYTE, nullptr);
  }
  gl_->PixelStorei(GL_UNPACK_ALIGNMENT, 1);
  gl_->PixelStorei(GL_UNPACK_ROW_LENGTH, pixels.width());
  gl_->TexSubImage2D(GL_TEXTURE_2D, 0, part.x, part.y, part.width, part.height, GL_RED, GL_UNSIGNED_BYTE,
                     pixels.at(part.x, part.y));
  gl_->PixelStorei(GL_UNPACK_ROW_LENGTH, 0);
}

void PanoramaTexture::draw(const PixelRect& part, int moved_px, int chroma_step) const {
  const auto clip = [](int px, int size) { return 2.0f * static_cast<float>(px) / static_cast<float>(size) - 1.0f; };
  const int left = part.x + kFirstColumn + moved_px;
  gl_->Uniform4f(program_->place_, clip(left, width_), clip(part.y, height_), clip(left + part.width, width_),
                 clip(part.y + part.height, height_));
  const float moved = static_cast<float>(-kFirstColumn - moved_px);
  const auto coordinates = [&](GLint uniform, const Plane& plane, int step) {
    const float per_x = 1.0f / static_cast<float>(step * plane.width);
    gl_->Uniform4f(uniform, per_x, 1.0f / static_cast<float>(step * plane.height), moved * per_x, 0.0f);
  };
  coordinates(program_->luma_, luma_, 1);
  coordinates(program_->chroma_, blue_, chroma_step);
  gl_->DrawArrays(GL_TRIANGLE_STRIP, 0, 4);
}

Status PanoramaTexture::upload(const DisplayFrame& frame) {
  const PlanarPicture& picture = *frame.picture;
  const int height_of_one = height_px(frame.shape);
  CHECK(picture.width() == width_px(frame.shape) && picture.height() == frame.stacked * height_of_one);
  CHECK(frame.stacked == 1 || height_of_one % 2 == 0);
  TRY(grow(picture.width() + 2 * kFirstColumn, picture.height()));
  const int step = picture.has_half_chroma() ? 2 : 1;
  const auto chroma_part = [&](const PixelRect& p) {
    const auto up = [&](int px) { return (px + step - 1) / step; };
    return PixelRect{p.x / step, p.y / step, up(p.x + p.width) - p.x / step, up(p.y + p.height) - p.y / step};
  };
  const PixelRect whole{0, 0, picture.width(), picture.height()};
  const std::span<const PixelRect> parts = frame.parts ? std::span(*frame.parts) : std::span(&whole, 1);
  gl_->ActiveTexture(GL_TEXTURE0);
  for (const PixelRect& part : parts) {
    upload(picture.luma(), part, &luma_);
    upload(picture.blue(), chroma_part(part), &blue_);
    upload(picture.red(), chroma_part(part), &red_);
  }
  const auto bind = [&](GLint unit, const Plane& plane) {
    gl_->ActiveTexture(GL_TEXTURE0 + static_cast<GLenum>(unit));
    gl_->BindTexture(GL_TEXTURE_2D, plane.texture.id());
  };
  bind(kRedUnit, red_);
  bind(kBlueUnit, blue_);
  bind(kLumaUnit, luma_);
  gl_->BindFramebuffer(GL_FRAMEBUFFER, target_.id());
  gl_->Viewport(0, 0, width_, height_);
  gl_->UseProgram(program_->program_.id());
  gl_->BindVertexArray(program_->nothing_.id());
  const auto width = static_cast<float>(blue_.width);
  const auto height = static_cast<float>(blue_.height);
  const auto* const panorama = std::get_if<Panorama>(&frame.shape);
  const int past_the_side = panorama != nullptr && is_whole_turn(*panorama) ? picture.width() : -1;
  const int chroma_rows = picture.blue().height() / frame.stacked;
  for (int eye = 0; eye < frame.stacked; ++eye) {
    gl_->Uniform4f(program_->chroma_end_, 0.5f / width, (static_cast<float>(eye * chroma_rows) + 0.5f) / height,
                   (static_cast<float>(picture.blue().width()) - 0.5f) / width,
                   (static_cast<float>((eye + 1) * chroma_rows) - 0.5f) / height);
    for (const PixelRect& of_any : parts) {
      const int top = std::max(of_any.y, eye * height_of_one);
      const int bottom = std::min(of_any.y + of_any.height, (eye + 1) * height_of_one);
      if (top >= bottom) continue;
      const PixelRect part{of_any.x, top, of_any.width, bottom - top};
      draw(part, 0, step);
      if (part.x == 0) draw({0, part.y, 1, part.height}, past_the_side, step);
      if (part.x + part.width == picture.width()) {
        draw({picture.width() - 1, part.y, 1, part.height}, -past_the_side, step);
      }
    }
  }
  shape_ = frame.shape;
  stacked_ = frame.stacked;
  return gl_->check("uploading a frame");
}

}  // namespace cyclorama::display
