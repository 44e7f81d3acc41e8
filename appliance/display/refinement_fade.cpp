// SPDX-License-Identifier: Apache-2.0
#include "appliance/display/refinement_fade.h"

#include <string>
#include <utility>

#include "appliance/display/light_shader.h"
#include "common/geometry/picture_place.h"

namespace cyclorama::display {
namespace {

constexpr GLint kNewestUnit = 0;
constexpr GLint kEarlierUnit = 1;

constexpr const char* kFadeShader = R"(
uniform LIGHT newest;
uniform LIGHT earlier;
uniform float share;
uniform int from;             // Columns to the right at which the source is.
uniform vec4 earlier_per_px;  // Texels of the earlier light = pixels * xy + zw.
uniform vec4 inside;          // First and last texel's centre across and down, of the earlier picture of this eye.
uniform vec2 per_texel;       // Texture coordinates of the earlier light.
void main() {
  vec2 pixel = gl_FragCoord.xy + vec2(from, 0.0);
  vec3 fresh = root_at(newest, ivec2(pixel));
  vec2 place = pixel * earlier_per_px.xy + earlier_per_px.zw;
  vec2 at = clamp(place, inside.xy, inside.zw);
  vec3 former = root_between(earlier, at, per_texel);
  float fresh_share = all(lessThanEqual(abs(at - place), vec2(1.0))) ? share : 1.0;
  texel = written_root(sqrt(mix(former * former, fresh * fresh, fresh_share)));
}
)";

}  // namespace

Result<RefinementFade> RefinementFade::make(const output::Gl& gl, Texels texels) {
  const std::string vertex_shader = light_shader_version(texels) + kRectangleShader;
  const std::string fragment_shader = light_shader_header(texels) + kFadeShader;
  TRY_ASSIGN(output::GlProgram linked, output::GlProgram::link(gl, vertex_shader.c_str(), fragment_shader.c_str()));
  RefinementFade fade(gl, std::move(linked));
  TRY(gl.check("preparing the fade between frames"));
  return fade;
}

RefinementFade::RefinementFade(const output::Gl& gl, output::GlProgram program)
    : gl_(&gl), program_(std::move(program)), nothing_(gl) {
  const auto uniform = [&](const char* name) { return program_.uniform(name); };
  place_ = uniform("place");
  share_ = uniform("share");
  from_ = uniform("from");
  earlier_per_px_ = uniform("earlier_per_px");
  inside_ = uniform("inside");
  per_texel_ = uniform("per_texel");
  gl.UseProgram(program_.id());
  gl.Uniform1i(uniform("newest"), kNewestUnit);
  gl.Uniform1i(uniform("earlier"), kEarlierUnit);
}

Status RefinementFade::draw(const PictureShape& former, double share, PanoramaTexture* panorama) const {
  TRY(panorama->bind_drawn());
  const PanoramaTexture::Light& drawn = panorama->drawn();
  const PanoramaTexture::Light& earlier = panorama->earlier();
  gl_->ActiveTexture(GL_TEXTURE0 + kEarlierUnit);
  gl_->BindTexture(GL_TEXTURE_2D, earlier.texture.id());
  gl_->ActiveTexture(GL_TEXTURE0 + kNewestUnit);
  gl_->BindTexture(GL_TEXTURE_2D, panorama->light().texture.id());
  gl_->UseProgram(program_.id());
  gl_->BindVertexArray(nothing_.id());
  const auto f = [](double value) { return static_cast<float>(value); };
  gl_->Uniform1f(share_, f(share));
  gl_->Uniform2f(per_texel_, 1.0f / static_cast<float>(earlier.width), 1.0f / static_cast<float>(earlier.height));
  const int width = width_px(panorama->shape());
  const int height = height_px(panorama->shape());
  const int width_before = width_px(former);
  const int height_before = height_px(former);
  const PixelScale now = pixel_scale(panorama->shape());
  const PixelScale before = pixel_scale(former);
  const double per_x = before.u_per_across / now.u_per_across;
  const double per_y = before.v_per_up / now.v_per_up;
  const int first = PanoramaTexture::kFirstColumn;
  const int end = first + width;
  const auto* const around = std::get_if<Panorama>(&panorama->shape());
  const bool wraps = around != nullptr && is_whole_turn(*around);
  for (int eye = 0; eye < panorama->stacked(); ++eye) {
    const int top = eye * height;
    gl_->Uniform4f(earlier_per_px_, f(per_x), f(per_y), f(before.u_offset - per_x * (now.u_offset + first)) + first,
                   f(before.v_offset - per_y * now.v_offset + eye * (height_before - per_y * height)));
    gl_->Uniform4f(inside_, f(first + 0.5), f(eye * height_before + 0.5), f(first + width_before - 0.5),
                   f((eye + 1) * height_before - 0.5));
    const auto draw = [&](int left, int right, int from) {
      gl_->Uniform4f(place_, in_clip_space(left, drawn.width), in_clip_space(top, drawn.height),
                     in_clip_space(right, drawn.width), in_clip_space(top + height, drawn.height));
      gl_->Uniform1i(from_, from);
      gl_->DrawArrays(GL_TRIANGLE_STRIP, 0, 4);
    };
    draw(first, end, 0);
    // The column beyond each edge is that of the opposite edge in a full turn, and otherwise a copy of the edge.
    draw(first - 1, first, wraps ? width : 1);
    draw(end, end + 1, wraps ? -width : -1);
  }
  panorama->show_drawn();
  return gl_->check("fading between frames");
}

}  // namespace cyclorama::display
