// SPDX-License-Identifier: Apache-2.0
#include "appliance/display/reprojection_painter.h"

#include <string>
#include <utility>

#include "appliance/display/light_shader.h"

namespace cyclorama::display {
namespace {

constexpr const char* kVertexShader = R"(
precision highp float;
layout(location = 0) in vec3 target;  // Across and down in pixels of the picture, inverse distance.
layout(location = 1) in vec2 source;  // Across and down in pixels of the picture.
uniform vec4 to_clip;    // Clip space = pixels * xy + zw.
uniform float moved_across;
EVEN out vec2 at;  // In texels of the source, whose picture begins in column 1.
void main() {
  // The nearest surface is at -1, the one at infinity just inside 1.
  gl_Position = vec4((target.xy + vec2(moved_across, 0.0)) * to_clip.xy + to_clip.zw, 0.999 - 0.1998 * target.z, 1.0);
  at = source + vec2(1.0, 0.0);
}
)";
static_assert(PanoramaTexture::kFirstColumn == 1);
// The mesh's positions in the source stay a pixel inside the picture, so that no filter reaches beyond it.
constexpr const char* kFragmentShader = R"(
uniform LIGHT source_light;
uniform vec2 per_texel;
EVEN in vec2 at;
#ifdef SHARP
void main() { texel = written_root(clamp(root_sharply(source_light, at), 0.0, 1.0)); }
#else
void main() { texel = written_root(root_between(source_light, at, per_texel)); }
#endif
)";

}  // namespace

MeshFilter mesh_filter_for(const output::Gl& gl) {
  return is_software_renderer(gl.renderer()) ? MeshFilter::kSharpened : MeshFilter::kSharp;
}

Result<ReprojectionPainter> ReprojectionPainter::make(const output::Gl& gl, Texels texels, MeshFilter filter) {
  const std::string vertex_shader = light_shader_version(texels) + kEvenShader + kVertexShader;
  const std::string fragment_shader = light_shader_header(texels, kEvenShader) + kSharpFilterShader +
                                      (filter == MeshFilter::kSharp ? "#define SHARP\n" : "") + kFragmentShader;
  TRY_ASSIGN(output::GlProgram linked, output::GlProgram::link(gl, vertex_shader.c_str(), fragment_shader.c_str()));
  std::optional<LightSharpener> sharpener;
  if (filter == MeshFilter::kSharpened) {
    TRY_ASSIGN(sharpener, LightSharpener::make(gl, texels));
  }
  ReprojectionPainter painter(gl, std::move(linked), std::move(sharpener));
  TRY(gl.check("preparing the reprojection"));
  return painter;
}

ReprojectionPainter::ReprojectionPainter(const output::Gl& gl, output::GlProgram program,
                                         std::optional<LightSharpener> sharpener)
    : gl_(&gl), program_(std::move(program)), sharpener_(std::move(sharpener)), buffers_(gl) {
  to_clip_ = program_.uniform("to_clip");
  per_texel_ = program_.uniform("per_texel");
  moved_across_ = program_.uniform("moved_across");
  gl.UseProgram(program_.id());
  gl.Uniform1i(program_.uniform("source_light"), 0);
}

Status ReprojectionPainter::draw(const ReprojectionMesh& mesh, const Eigen::Vector3d& eye_m,
                                 PanoramaTexture* panorama) {
  mesh.move(eye_m, &moved_);
  if (sharpener_ && !panorama->is_sharpened()) TRY(sharpener_->draw(panorama));
  TRY(panorama->bind_moved());
  const PanoramaTexture::Light& light = sharpener_ ? panorama->sharpened() : panorama->light();
  gl_->ActiveTexture(GL_TEXTURE0);
  gl_->BindTexture(GL_TEXTURE_2D, light.texture.id());
  gl_->UseProgram(program_.id());
  buffers_.upload(moved_.vertices);
  const auto per = [](int px) { return 1.0f / static_cast<float>(px); };
  const float across = 2.0f * per(panorama->texture_width());
  gl_->Uniform4f(to_clip_, across, 2.0f * per(panorama->texture_height()),
                 across * static_cast<float>(PanoramaTexture::kFirstColumn) - 1.0f, -1.0f);
  gl_->Uniform2f(per_texel_, per(light.width), per(light.height));
  const int width = width_px(panorama->shape());
  const int height = height_px(panorama->shape());
  const bool wraps = mesh.grid().is_whole_turn;
  gl_->Enable(GL_DEPTH_TEST);
  gl_->Clear(GL_DEPTH_BUFFER_BIT);
  gl_->Enable(GL_SCISSOR_TEST);
  for (int eye = 0; eye < panorama->stacked(); ++eye) {
    gl_->Scissor(0, eye * height, panorama->texture_width(), height);
    // Everything that leaves a whole turn on one side enters on the other.
    for (int turn = wraps ? -1 : 0; turn <= (wraps ? 1 : 0); ++turn) {
      gl_->Uniform1f(moved_across_, static_cast<float>(turn * width));
      buffers_.draw(mesh.smooth(static_cast<std::size_t>(eye)));
      buffers_.draw(moved_.jumping[static_cast<std::size_t>(eye)]);
    }
  }
  gl_->Disable(GL_SCISSOR_TEST);
  gl_->Disable(GL_DEPTH_TEST);
  return gl_->check("moving a frame's eye");
}

}  // namespace cyclorama::display
