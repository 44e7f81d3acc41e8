// SPDX-License-Identifier: Apache-2.0
#include "appliance/display/reprojection_painter.h"

#include <cstddef>
#include <string>
#include <utility>

namespace cyclorama::display {
namespace {

constexpr GLuint kTarget = 0;
constexpr GLuint kSource = 1;

// Positions and coordinates need no perspective division: w is 1 everywhere.
constexpr const char* kEven = R"(
#extension GL_NV_shader_noperspective_interpolation : enable
#ifdef GL_NV_shader_noperspective_interpolation
#define EVEN noperspective
#else
#define EVEN
#endif
)";
constexpr const char* kVertexShader = R"(
precision highp float;
layout(location = 0) in vec3 target;  // Across and down in pixels of the picture, inverse distance.
layout(location = 1) in vec2 source;  // Across and down in pixels of the picture.
uniform vec4 to_clip;    // Clip space = pixels * xy + zw.
uniform vec4 per_px;     // Texture coordinates per pixel, of luma and of chroma.
uniform float moved_across;
EVEN out vec4 at;
void main() {
  // The nearest surface is at -1, the one at infinity just inside 1.
  gl_Position = vec4((target.xy + vec2(moved_across, 0.0)) * to_clip.xy + to_clip.zw, 0.999 - 0.1998 * target.z, 1.0);
  at = source.xyxy * per_px;
}
)";
// Filters luma, too, since a moved pixel lies between pixels of the source. The mesh stays a pixel inside its picture,
// so that no filter reaches beyond.
constexpr const char* kFragmentShader = R"(
EVEN in vec4 at;
void main() {
  texel = written(light_of(texture(luma_plane, at.xy).r, texture(blue_plane, at.zw).r, texture(red_plane, at.zw).r));
}
)";

void set_filter(const output::Gl& gl, const output::GlTexture& texture, GLint filter) {
  gl.ActiveTexture(GL_TEXTURE0 + static_cast<GLenum>(PanoramaTexture::kLumaUnit));
  gl.BindTexture(GL_TEXTURE_2D, texture.id());
  gl.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, filter);
  gl.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, filter);
}

GLsizeiptr byte_count(const auto& values) { return static_cast<GLsizeiptr>(values.size() * sizeof(values[0])); }

}  // namespace

Result<ReprojectionPainter> ReprojectionPainter::make(const output::Gl& gl, Texels texels) {
  const std::string header = light_shader_header(texels, kEven);
  const std::string vertex_shader = std::string("#version 300 es\n") + kEven + kVertexShader;
  TRY_ASSIGN(output::GlProgram linked,
             output::GlProgram::link(gl, vertex_shader.c_str(), (header + kFragmentShader).c_str()));
  ReprojectionPainter painter(gl, std::move(linked));
  TRY(gl.check("preparing the reprojection"));
  return painter;
}

ReprojectionPainter::ReprojectionPainter(const output::Gl& gl, output::GlProgram program)
    : gl_(&gl), program_(std::move(program)), array_(gl), vertices_(gl), indices_(gl) {
  to_clip_ = program_.uniform("to_clip");
  per_px_ = program_.uniform("per_px");
  moved_across_ = program_.uniform("moved_across");
  select_planes(gl, program_);
  gl.BindVertexArray(array_.id());
  gl.BindBuffer(GL_ARRAY_BUFFER, vertices_.id());
  gl.BindBuffer(GL_ELEMENT_ARRAY_BUFFER, indices_.id());
  const auto attribute = [&](GLuint index, GLint floats, std::size_t offset) {
    gl.EnableVertexAttribArray(index);
    // GL's convention: an offset into the bound buffer, passed as a pointer.
    gl.VertexAttribPointer(index, floats, GL_FLOAT, GL_FALSE, sizeof(ReprojectedVertex),
                           reinterpret_cast<const void*>(offset));  // NOLINT(performance-no-int-to-ptr)
  };
  attribute(kTarget, 3, offsetof(ReprojectedVertex, across_px));
  attribute(kSource, 2, offsetof(ReprojectedVertex, source_across_px));
}

void ReprojectionPainter::draw_triangles(std::span<const std::uint32_t> indices) {
  if (indices.empty()) return;
  gl_->BufferData(GL_ELEMENT_ARRAY_BUFFER, static_cast<GLsizeiptr>(indices.size_bytes()), indices.data(),
                  GL_STREAM_DRAW);
  gl_->DrawElements(GL_TRIANGLES, static_cast<GLsizei>(indices.size()), GL_UNSIGNED_INT, nullptr);
}

Status ReprojectionPainter::draw(const ReprojectionMesh& mesh, const Eigen::Vector3d& eye_m,
                                 PanoramaTexture* panorama) {
  mesh.move(eye_m, &moved_);
  TRY(panorama->bind_with_depth());
  panorama->bind_planes();
  set_filter(*gl_, panorama->luma().texture, GL_LINEAR);
  gl_->UseProgram(program_.id());
  gl_->BindVertexArray(array_.id());
  gl_->BindBuffer(GL_ARRAY_BUFFER, vertices_.id());
  gl_->BufferData(GL_ARRAY_BUFFER, byte_count(moved_.vertices), moved_.vertices.data(), GL_STREAM_DRAW);
  const auto per = [](int px) { return 1.0f / static_cast<float>(px); };
  const float across = 2.0f * per(panorama->texture_width());
  gl_->Uniform4f(to_clip_, across, 2.0f * per(panorama->texture_height()),
                 across * static_cast<float>(PanoramaTexture::kFirstColumn) - 1.0f, -1.0f);
  const int step = panorama->chroma_step();
  gl_->Uniform4f(per_px_, per(panorama->luma().width), per(panorama->luma().height),
                 per(step * panorama->chroma().width), per(step * panorama->chroma().height));
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
      draw_triangles(mesh.smooth(static_cast<std::size_t>(eye)));
      draw_triangles(moved_.jumping[static_cast<std::size_t>(eye)]);
    }
  }
  gl_->Disable(GL_SCISSOR_TEST);
  gl_->Disable(GL_DEPTH_TEST);
  set_filter(*gl_, panorama->luma().texture, GL_NEAREST);
  return gl_->check("moving a frame's eye");
}

}  // namespace cyclorama::display
