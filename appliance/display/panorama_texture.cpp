// SPDX-License-Identifier: Apache-2.0
#include "appliance/display/panorama_texture.h"

#include <algorithm>
#include <span>
#include <string>
#include <vector>

#include "appliance/display/light_shader.h"

namespace cyclorama::display {
namespace {

// The polynomial approximates ((c + 0.055) / 1.055)^2.4 within 0.013 code values of 8 bits, by Remez exchange; it takes
// a third of pow()'s time on a software rasteriser.
constexpr const char* kFragmentShader = R"(
uniform highp sampler2D luma_plane;
uniform highp sampler2D blue_plane;
uniform highp sampler2D red_plane;
uniform vec4 luma;        // Texture coordinate = gl_FragCoord.xy * xy + zw.
uniform vec4 chroma;      // Likewise; chroma of half the size lies between its pixels' centres.
uniform vec4 chroma_end;  // The first and the last centre; texels beyond them belong to another picture.
vec3 light_of(float y, float blue_sample, float red_sample) {
  float blue = blue_sample - 128.0 / 255.0;
  float red = red_sample - 128.0 / 255.0;
  vec3 c = clamp(vec3(y + 1.402 * red, y - 0.344136286 * blue - 0.714136286 * red, y + 1.772 * blue), 0.0, 1.0);
  vec3 p = ((((0.0872824213 * c - 0.307377663) * c + 0.66716066) * c + 0.519381961) * c + 0.0327460791) * c
           + 0.000916890727;
  return mix(p, c / 12.92, lessThanEqual(c, vec3(0.04045)));
}
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

Result<PictureProgram> PictureProgram::make(const output::Gl& gl, Texels texels) {
  const std::string vertex_shader = light_shader_version(texels) + kRectangleShader;
  const std::string fragment_shader = light_shader_header(texels) + kFragmentShader;
  TRY_ASSIGN(output::GlProgram linked, output::GlProgram::link(gl, vertex_shader.c_str(), fragment_shader.c_str()));
  PictureProgram program(std::move(linked), texels);
  program.nothing_ = output::GlVertexArray(gl);
  const output::GlProgram& of = program.program_;
  program.place_ = of.uniform("place");
  program.luma_ = of.uniform("luma");
  program.chroma_ = of.uniform("chroma");
  program.chroma_end_ = of.uniform("chroma_end");
  gl.UseProgram(of.id());
  gl.Uniform1i(of.uniform("luma_plane"), PanoramaTexture::kLumaUnit);
  gl.Uniform1i(of.uniform("blue_plane"), PanoramaTexture::kBlueUnit);
  gl.Uniform1i(of.uniform("red_plane"), PanoramaTexture::kRedUnit);
  TRY(gl.check("preparing the picture shader"));
  return program;
}

PanoramaTexture::PanoramaTexture(const output::Gl& gl, const PictureProgram& program)
    : gl_(&gl),
      program_(&program),
      luma_{output::GlTexture(gl)},
      blue_{output::GlTexture(gl)},
      red_{output::GlTexture(gl)},
      light_(make_light()),
      earlier_(make_light()),
      moved_(make_light()),
      sharpened_(make_light()),
      depth_(gl) {
  gl_->BindTexture(GL_TEXTURE_2D, luma_.texture.id());
  filter(*gl_, GL_NEAREST, GL_CLAMP_TO_EDGE);
  for (const Plane* plane : {&blue_, &red_}) {
    gl_->BindTexture(GL_TEXTURE_2D, plane->texture.id());
    // Mirrors instead of clamping, since llvmpipe filters clamped bytes in 8 bits only. Sampled positions never reach
    // the edge, where the two would differ.
    filter(*gl_, GL_LINEAR, GL_MIRRORED_REPEAT);
  }
}

PanoramaTexture::Light PanoramaTexture::make_light() const {
  Light light{output::GlTexture(*gl_), output::GlFramebuffer(*gl_)};
  gl_->BindTexture(GL_TEXTURE_2D, light.texture.id());
  filter(*gl_, texels() == Texels::kPacked ? GL_NEAREST : GL_LINEAR, GL_CLAMP_TO_EDGE);
  return light;
}

Status PanoramaTexture::grow(int width, int height, Light* light) {
  if (width <= light->width && height <= light->height) return Done{};
  light->width = std::max(width, light->width);
  light->height = std::max(height, light->height);
  gl_->ActiveTexture(GL_TEXTURE0);
  gl_->BindTexture(GL_TEXTURE_2D, light->texture.id());
  // Zeros, since texels that no frame has drawn may be read beside drawn ones.
  const std::vector<std::uint64_t> zeros(static_cast<std::size_t>(light->width) *
                                         static_cast<std::size_t>(light->height));
  if (texels() == Texels::kPacked) {
    gl_->TexImage2D(GL_TEXTURE_2D, 0, GL_R32UI, light->width, light->height, 0, GL_RED_INTEGER, GL_UNSIGNED_INT,
                    zeros.data());
  } else {
    gl_->TexImage2D(GL_TEXTURE_2D, 0, GL_RGBA16F, light->width, light->height, 0, GL_RGBA, GL_HALF_FLOAT, zeros.data());
  }
  gl_->BindFramebuffer(GL_FRAMEBUFFER, light->target.id());
  gl_->FramebufferTexture2D(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, light->texture.id(), 0);
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
  const int left = part.x + kFirstColumn + moved_px;
  gl_->Uniform4f(program_->place_, in_clip_space(left, light_.width), in_clip_space(part.y, light_.height),
                 in_clip_space(left + part.width, light_.width), in_clip_space(part.y + part.height, light_.height));
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
  TRY(grow(picture.width() + 2 * kFirstColumn, picture.height(), &light_));
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
  is_moved_ = false;
  is_sharpened_ = false;
  convert(frame);
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

Status PanoramaTexture::bind_drawn() {
  TRY(grow(light_.width, light_.height, &moved_));
  gl_->BindFramebuffer(GL_FRAMEBUFFER, moved_.target.id());
  // Drawing from the same eye needs no depth buffer, and a smaller one would cut the picture off.
  gl_->FramebufferRenderbuffer(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_RENDERBUFFER, 0);
  gl_->Viewport(0, 0, moved_.width, moved_.height);
  return Done{};
}

Status PanoramaTexture::bind_sharpened() {
  TRY(grow(light_.width, light_.height, &sharpened_));
  gl_->BindFramebuffer(GL_FRAMEBUFFER, sharpened_.target.id());
  gl_->Viewport(0, 0, sharpened_.width, sharpened_.height);
  is_sharpened_ = true;
  return Done{};
}

Status PanoramaTexture::bind_moved() {
  TRY(bind_drawn());
  gl_->BindRenderbuffer(GL_RENDERBUFFER, depth_.id());
  if (depth_width_ != moved_.width || depth_height_ != moved_.height) {
    gl_->RenderbufferStorage(GL_RENDERBUFFER, GL_DEPTH_COMPONENT16, moved_.width, moved_.height);
    depth_width_ = moved_.width;
    depth_height_ = moved_.height;
  }
  gl_->FramebufferRenderbuffer(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_RENDERBUFFER, depth_.id());
  if (gl_->CheckFramebufferStatus(GL_FRAMEBUFFER) != GL_FRAMEBUFFER_COMPLETE) {
    return Error(ErrorCode::kSystem, "the graphics driver cannot draw a panorama with depth");
  }
  is_moved_ = true;
  return Done{};
}

void PanoramaTexture::convert(const DisplayFrame& frame) const {
  const PlanarPicture& picture = *frame.picture;
  const int height_of_one = height_px(frame.shape);
  const PixelRect whole{0, 0, picture.width(), picture.height()};
  const std::span<const PixelRect> parts = frame.parts ? std::span(*frame.parts) : std::span(&whole, 1);
  bind_planes();
  gl_->BindFramebuffer(GL_FRAMEBUFFER, light_.target.id());
  gl_->Viewport(0, 0, light_.width, light_.height);
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
