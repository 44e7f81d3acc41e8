// SPDX-License-Identifier: Apache-2.0
#include "appliance/display/light_sharpener.h"

#include <string>
#include <utility>

#include "appliance/display/light_shader.h"
#include "common/geometry/picture_place.h"

namespace cyclorama::display {
namespace {

// A bilinear filter's mean gain at a frequency w is 1 - w^2 / 12 across, and likewise down, for small w.
constexpr const char* kSharpeningShader = R"(
uniform LIGHT source_light;
uniform vec4 ends;  // First and last texel across and down, of the picture of this eye.
uniform int from;   // Columns to the right at which the source is.
const float kStrength = 1.0 / 12.0;
vec3 root_inside(ivec2 at) { return root_at(source_light, clamp(at, ivec2(ends.xy), ivec2(ends.zw))); }
void main() {
  ivec2 at = ivec2(gl_FragCoord.xy) + ivec2(from, 0);
  vec3 root = root_at(source_light, at);
  vec3 around = root_inside(at + ivec2(-1, 0)) + root_inside(at + ivec2(1, 0)) + root_inside(at + ivec2(0, -1)) +
                root_inside(at + ivec2(0, 1));
  texel = written_root(clamp(root + kStrength * (4.0 * root - around), 0.0, 1.0));
}
)";

}  // namespace

Result<LightSharpener> LightSharpener::make(const output::Gl& gl, Texels texels) {
  const std::string vertex_shader = light_shader_version(texels) + kRectangleShader;
  const std::string fragment_shader = light_shader_header(texels) + kSharpeningShader;
  TRY_ASSIGN(output::GlProgram linked, output::GlProgram::link(gl, vertex_shader.c_str(), fragment_shader.c_str()));
  LightSharpener sharpener(gl, std::move(linked));
  TRY(gl.check("preparing the sharpening of frames"));
  return sharpener;
}

LightSharpener::LightSharpener(const output::Gl& gl, output::GlProgram program)
    : gl_(&gl), program_(std::move(program)), nothing_(gl) {
  place_ = program_.uniform("place");
  ends_ = program_.uniform("ends");
  from_ = program_.uniform("from");
  gl.UseProgram(program_.id());
  gl.Uniform1i(program_.uniform("source_light"), 0);
}

Status LightSharpener::draw(PanoramaTexture* panorama) const {
  TRY(panorama->bind_sharpened());
  const PanoramaTexture::Light& sharpened = panorama->sharpened();
  gl_->ActiveTexture(GL_TEXTURE0);
  gl_->BindTexture(GL_TEXTURE_2D, panorama->light().texture.id());
  gl_->UseProgram(program_.id());
  gl_->BindVertexArray(nothing_.id());
  const int width = width_px(panorama->shape());
  const int height = height_px(panorama->shape());
  const int first = PanoramaTexture::kFirstColumn;
  const int end = first + width;
  const auto* const around = std::get_if<Panorama>(&panorama->shape());
  const bool wraps = around != nullptr && is_whole_turn(*around);
  for (int eye = 0; eye < panorama->stacked(); ++eye) {
    const int top = eye * height;
    gl_->Uniform4f(ends_, 0.0f, static_cast<float>(top), static_cast<float>(end), static_cast<float>(top + height - 1));
    const auto draw = [&](int left, int right, int from) {
      gl_->Uniform4f(place_, in_clip_space(left, sharpened.width), in_clip_space(top, sharpened.height),
                     in_clip_space(right, sharpened.width), in_clip_space(top + height, sharpened.height));
      gl_->Uniform1i(from_, from);
      gl_->DrawArrays(GL_TRIANGLE_STRIP, 0, 4);
    };
    draw(first, end, 0);
    // The column beside each edge: of a whole turn that of the other edge, else a copy.
    draw(first - 1, first, wraps ? width : 1);
    draw(end, end + 1, wraps ? -width : -1);
  }
  return gl_->check("sharpening a frame");
}

}  // namespace cyclorama::display
