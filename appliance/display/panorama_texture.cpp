// SPDX-License-Identifier: Apache-2.0
#include "appliance/display/panorama_texture.h"

#include <algorithm>
#include <span>
#include <string>

#include "appliance/display/light_shader.h"

namespace cyclorama::display {
namespace {

// Computes the corners of a rectangle from their numbers.
constexpr const char* kVertexShader = R"(#version 300 es
precision highp float;
uniform vec4 place;  // In clip space: left, top, right, bottom.
void main() {
  gl_Position = vec4((gl_VertexID & 1) == 0 ? place.x : place.z, (gl_VertexID & 2) == 0 ? place.y : place.w, 0.0, 1.0);
}
)";
constexpr const char* kFragmentShader = R"(
uniform vec4 luma;        // Texture coordinate = gl_FragCoord.xy * xy + zw.
uniform vec4 chroma;      // Likewise; chroma of half the size lies between its pixels' centres.
uniform vec4 chroma_end;  // The first and the last centre; texels beyond them belong to another picture.
void main() {
  float y = texture(luma_plane, gl_FragCoord.xy * luma.xy + luma.zw).r;
  vec2 at = clamp(gl_FragCoord.xy * chroma.xy + chroma.zw, chroma_end.xy, chroma_end.zw);
  texel = written(light_of(y, texture(blue_plane, at).r, texture(red_plane, at).r));
}
)";

void filter(const output::Gl& gl, GLint filter, GLint wrap) {
  gl.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, filter);
  gl.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, filter);
  gl.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_S, wrap);
  gl.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_T, wrap);
}

}  // namespace

std::string light_shader_header(Texels texels, const char* extensions) {
  return std::string("#version 300 es\n") + extensions + (texels == Texels::kPacked ? "#define PACKED\n" : "") +
         kLightShader;
}

void select_planes(const output::Gl& gl, const output::GlProgram& program) {
  gl.UseProgram(program.id());
  gl.Uniform1i(program.uniform("luma_plane"), PanoramaTexture::kLumaUnit);
  gl.Uniform1i(program.uniform("blue_plane"), PanoramaTexture::kBlueUnit);
  gl.Uniform1i(program.uniform("red_plane"), PanoramaTexture::kRedUnit);
}

Result<PictureProgram> PictureProgram::make(const output::Gl& gl, Texels texels) {
  const std::string fragment_shader = light_shader_header(texels) + kFragmentShader;
  TRY_ASSIGN(output::GlProgram linked, output::GlProgram::link(gl, kVertexShader, fragment_shader.c_str()));
  PictureProgram program(std::move(linked), texels);
  program.nothing_ = output::GlVertexArray(gl);
  const output::GlProgram& of = program.program_;
  program.place_ = of.uniform("place");
  program.luma_ = of.uniform("luma");
  program.chroma_ = of.uniform("chroma");
  program.chroma_end_ = of.uniform("chroma_end");
  select_planes(gl, of);
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
      target_(gl),
      depth_(gl) {
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
  // A smaller depth buffer would cut off what is drawn.
  gl_->FramebufferRenderbuffer(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_RENDERBUFFER, 0);
  if (gl_->CheckFramebufferStatus(GL_FRAMEBUFFER) != GL_FRAMEBUFFER_COMPLETE) {
    return Error(ErrorCode::kSystem, "the graphics driver cannot draw the light of a panorama");
  }
  depth_width_ = depth_height_ = 0;
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
  shape_ = frame.shape;
  stacked_ = frame.stacked;
  chroma_step_ = step;
  show_unmoved(frame);
  return gl_->check("uploading a frame");
}

void PanoramaTexture::bind_planes() const {
  const auto bind = [&](GLint unit, const Plane& plane) {
    gl_->ActiveTexture(GL_TEXTURE0 + static_cast<GLenum>(unit));
    gl_->BindTexture(GL_TEXTURE_2D, plane.texture.id());
  };
  bind(kRedUnit, red_);
  bind(kBlueUnit, blue_);
  bind(kLumaUnit, luma_);
}

Status PanoramaTexture::bind_with_depth() {
  gl_->BindFramebuffer(GL_FRAMEBUFFER, target_.id());
  if (depth_width_ != width_ || depth_height_ != height_) {
    gl_->BindRenderbuffer(GL_RENDERBUFFER, depth_.id());
    gl_->RenderbufferStorage(GL_RENDERBUFFER, GL_DEPTH_COMPONENT16, width_, height_);
    gl_->FramebufferRenderbuffer(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_RENDERBUFFER, depth_.id());
    if (gl_->CheckFramebufferStatus(GL_FRAMEBUFFER) != GL_FRAMEBUFFER_COMPLETE) {
      return Error(ErrorCode::kSystem, "the graphics driver cannot draw a panorama with depth");
    }
    depth_width_ = width_;
    depth_height_ = height_;
  }
  gl_->Viewport(0, 0, width_, height_);
  return Done{};
}

void PanoramaTexture::show_unmoved(const DisplayFrame& frame) const {
  const PlanarPicture& picture = *frame.picture;
  const int height_of_one = height_px(frame.shape);
  const PixelRect whole{0, 0, picture.width(), picture.height()};
  const std::span<const PixelRect> parts = frame.parts ? std::span(*frame.parts) : std::span(&whole, 1);
  bind_planes();
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
      draw(part, 0, chroma_step_);
      if (part.x == 0) draw({0, part.y, 1, part.height}, past_the_side, chroma_step_);
      if (part.x + part.width == picture.width()) {
        draw({picture.width() - 1, part.y, 1, part.height}, -past_the_side, chroma_step_);
      }
    }
  }
}

}  // namespace cyclorama::display
