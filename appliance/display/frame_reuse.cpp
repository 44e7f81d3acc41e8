// SPDX-License-Identifier: Apache-2.0
#include "appliance/display/frame_reuse.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "appliance/display/eye_move.h"
#include "appliance/display/light_shader.h"
#include "common/geometry/picture_place.h"

namespace cyclorama::display {
namespace {

constexpr GLuint kParallax = 2;
constexpr GLint kNewestUnit = 0;
constexpr GLint kEarlierUnit = 1;
constexpr GLint kDepthUnit = 2;

constexpr const char* kVertexShader = R"(
precision highp float;
layout(location = 0) in vec3 before;  // Across and down in pixels, inverse distance from the earlier eye.
layout(location = 1) in vec2 place;   // Across and down in pixels of the picture.
layout(location = 2) in float parallax;  // In pixels.
uniform vec4 to_clip;                 // Clip space = pixels * xy + zw.
uniform float moved_across;
uniform vec4 before_per_px;           // Texels of the earlier light = pixels * xy + zw.
EVEN out vec3 at;
EVEN out float parallax_px;
void main() {
  parallax_px = parallax;
  gl_Position = vec4((place + vec2(moved_across, 0.0)) * to_clip.xy + to_clip.zw, 0.0, 1.0);
  at = vec3(before.xy * before_per_px.xy + before_per_px.zw, before.z);
}
)";
// A bilinear filter would soften the picture anew for each frame.
constexpr const char* kFragmentShader = R"(
uniform LIGHT newest;
uniform LIGHT earlier;
uniform highp usampler2D earlier_depth;
uniform float whole_turn;      // Texels of the earlier light in a whole turn; 0: the picture has edges.
uniform vec4 inside;           // First and last texel's centre across and down, of the picture of this eye.
uniform vec4 cells_per_texel;  // Cells of depth = texels * xy + zw.
EVEN in vec3 at;
EVEN in float parallax_px;
// Share of the new frame without a shift, and from kShifted_px on: docs/design/walking.md has what others reach.
const float kShare = 0.25;
const float kShiftedShare = 0.6;
const float kShifted_px = 4.0;
const float kTolerance = 4.0 / 255.0;
const float kSameSurface = 0.1;
const float kPerMetre = 1.0 / 409.5;

void main() {
  ivec2 pixel = ivec2(gl_FragCoord.xy);
  vec3 fresh = root_at(newest, pixel);
  vec3 lowest = fresh;
  vec3 highest = fresh;
  ivec2 end = textureSize(newest, 0) - 1;
  for (int y = -1; y <= 1; ++y) {
    for (int x = -1; x <= 1; ++x) {
      vec3 beside = root_at(newest, clamp(pixel + ivec2(x, y), ivec2(0), end));
      lowest = min(lowest, beside);
      highest = max(highest, beside);
    }
  }
  vec2 place = at.xy;
  if (whole_turn > 0.0) place.x = 1.0 + mod(place.x - 1.0, whole_turn);
  vec2 inner = clamp(place, inside.xy, inside.zw);
  vec2 cell = inner * cells_per_texel.xy + cells_per_texel.zw;
  float seen = float(texelFetch(earlier_depth, ivec2(cell), 0).r) * kPerMetre;
  bool is_same = all(lessThan(abs(inner - place), vec2(0.5))) && abs(seen - at.z) <= kSameSurface * max(seen, at.z) + kPerMetre;
  vec3 reused = clamp(root_sharply(earlier, inner), max(lowest - kTolerance, 0.0), min(highest + kTolerance, 1.0));
  float share = is_same ? mix(kShare, kShiftedShare, min(parallax_px / kShifted_px, 1.0)) : 1.0;
  vec3 light = mix(reused * reused, fresh * fresh, share);
  texel = written_root(sqrt(light));
}
)";
static_assert(PanoramaTexture::kFirstColumn == 1);

}  // namespace

Result<FrameReuse> FrameReuse::make(const output::Gl& gl, Texels texels) {
  const std::string vertex_shader = light_shader_version(texels) + kEvenShader + kVertexShader;
  const std::string fragment_shader = light_shader_header(texels, kEvenShader) + kSharpFilterShader + kFragmentShader;
  TRY_ASSIGN(output::GlProgram linked, output::GlProgram::link(gl, vertex_shader.c_str(), fragment_shader.c_str()));
  FrameReuse reuse(gl, std::move(linked));
  TRY(gl.check("preparing the reuse of frames"));
  return reuse;
}

FrameReuse::FrameReuse(const output::Gl& gl, output::GlProgram program)
    : gl_(&gl), program_(std::move(program)), buffers_(gl), parallax_(gl), depth_(gl) {
  const auto uniform = [&](const char* name) { return program_.uniform(name); };
  uniforms_ = {uniform("to_clip"),    uniform("moved_across"), uniform("before_per_px"),
               uniform("whole_turn"), uniform("inside"),       uniform("cells_per_texel")};
  gl.UseProgram(program_.id());
  gl.Uniform1i(uniform("newest"), kNewestUnit);
  gl.Uniform1i(uniform("earlier"), kEarlierUnit);
  gl.Uniform1i(uniform("earlier_depth"), kDepthUnit);
  gl.BindTexture(GL_TEXTURE_2D, depth_.id());
  gl.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
  gl.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
  gl.BindBuffer(GL_ARRAY_BUFFER, parallax_.id());
  gl.EnableVertexAttribArray(kParallax);
  gl.VertexAttribPointer(kParallax, 1, GL_FLOAT, GL_FALSE, sizeof(float), nullptr);
}

bool FrameReuse::is_comparable(const DisplayFrame& frame) const {
  return before_ && frame.mesh != nullptr && frame.stacked == before_->stacked &&
         has_same_places(frame.shape, before_->shape);
}

bool FrameReuse::is_at_rest(const DisplayFrame& frame) const {
  return frame.eye_m == before_->eye_m && frame.heading_rad == before_->heading_rad;
}

bool FrameReuse::is_useful_for(const DisplayFrame& frame) const {
  return is_comparable(frame) && !is_at_rest(frame) && (frame.eye_m - before_->eye_m).norm() < kMaxMove_m;
}

bool FrameReuse::is_refined_by(const DisplayFrame& frame) const { return is_comparable(frame) && is_at_rest(frame); }

Status FrameReuse::remember(const DisplayFrame& frame) {
  before_.reset();
  if (frame.mesh == nullptr) return Done{};
  const InverseDepthImage& depth = frame.mesh->depth();
  gl_->ActiveTexture(GL_TEXTURE0 + kDepthUnit);
  gl_->BindTexture(GL_TEXTURE_2D, depth_.id());
  if (depth.width() > depth_width_ || depth.height() > depth_height_) {
    depth_width_ = std::max(depth.width(), depth_width_);
    depth_height_ = std::max(depth.height(), depth_height_);
    gl_->TexImage2D(GL_TEXTURE_2D, 0, GL_R16UI, depth_width_, depth_height_, 0, GL_RED_INTEGER, GL_UNSIGNED_SHORT,
                    nullptr);
  }
  gl_->PixelStorei(GL_UNPACK_ALIGNMENT, 1);
  gl_->TexSubImage2D(GL_TEXTURE_2D, 0, 0, 0, depth.width(), depth.height(), GL_RED_INTEGER, GL_UNSIGNED_SHORT,
                     depth.data().data());
  depth_cells_across_ = depth.width();
  depth_cells_down_ = depth.height();
  before_ = Before{frame.heading_rad, frame.eye_m, frame.shape, frame.stacked};
  return gl_->check("remembering a frame");
}

Status FrameReuse::add_earlier(const DisplayFrame& frame, PanoramaTexture* panorama) {
  CHECK(is_useful_for(frame));
  const Eigen::AngleAxisd R_eye_scene(frame.heading_rad, Eigen::Vector3d::UnitY());
  frame.mesh->find_in(R_eye_scene * (before_->eye_m - frame.eye_m), frame.heading_rad - before_->heading_rad, &found_);
  TRY(panorama->bind_drawn());
  const PanoramaTexture::Light& newest = panorama->light();
  const PanoramaTexture::Light& earlier = panorama->earlier();
  gl_->ActiveTexture(GL_TEXTURE0 + kDepthUnit);
  gl_->BindTexture(GL_TEXTURE_2D, depth_.id());
  gl_->ActiveTexture(GL_TEXTURE0 + kEarlierUnit);
  gl_->BindTexture(GL_TEXTURE_2D, earlier.texture.id());
  gl_->ActiveTexture(GL_TEXTURE0 + kNewestUnit);
  gl_->BindTexture(GL_TEXTURE_2D, newest.texture.id());
  gl_->UseProgram(program_.id());
  buffers_.upload(found_.vertices);
  const std::vector<float>& parallax_px = found_.parallax_px;
  gl_->BindBuffer(GL_ARRAY_BUFFER, parallax_.id());
  gl_->BufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(parallax_px.size() * sizeof(float)), parallax_px.data(),
                  GL_STREAM_DRAW);
  constexpr auto kFirst = static_cast<float>(PanoramaTexture::kFirstColumn);
  const PanoramaTexture::Light& drawn = panorama->drawn();
  const float across = 2.0f / static_cast<float>(drawn.width);
  gl_->Uniform4f(uniforms_.to_clip, across, 2.0f / static_cast<float>(drawn.height), across * kFirst - 1.0f, -1.0f);
  const int width = width_px(frame.shape);
  const int height = height_px(frame.shape);
  const int width_before = width_px(before_->shape);
  const int height_before = height_px(before_->shape);
  const PixelScale now = pixel_scale(frame.shape);
  const PixelScale before = pixel_scale(before_->shape);
  const double per_u = before.u_per_across / now.u_per_across;
  const double per_v = before.v_per_up / now.v_per_up;
  const auto f = [](double value) { return static_cast<float>(value); };
  const double rows_before = frame.stacked * height_before;
  const double cells_across = depth_cells_across_ / static_cast<double>(width_before);
  gl_->Uniform4f(uniforms_.cells_per_texel, f(cells_across), f(depth_cells_down_ / rows_before),
                 f(-cells_across * PanoramaTexture::kFirstColumn), 0.0f);
  const bool wraps = frame.mesh->grid().is_whole_turn;
  gl_->Uniform1f(uniforms_.whole_turn, wraps ? f(width_before) : 0.0f);
  gl_->Enable(GL_SCISSOR_TEST);
  for (int eye = 0; eye < frame.stacked; ++eye) {
    gl_->Scissor(0, eye * height, drawn.width, height);
    gl_->Uniform4f(uniforms_.before_per_px, f(per_u), f(per_v), f(before.u_offset - per_u * now.u_offset) + kFirst,
                   f(before.v_offset - per_v * now.v_offset + eye * (height_before - per_v * height)));
    gl_->Uniform4f(uniforms_.inside, kFirst + 0.5f, f(eye * height_before + 0.5), kFirst + f(width_before - 0.5),
                   f((eye + 1) * height_before - 0.5));
    // The column beside each edge of a whole turn belongs to the other edge.
    for (int turn = wraps ? -1 : 0; turn <= (wraps ? 1 : 0); ++turn) {
      gl_->Uniform1f(uniforms_.moved_across, f(turn * width));
      buffers_.draw(frame.mesh->smooth(static_cast<std::size_t>(eye)));
      buffers_.draw(found_.jumping[static_cast<std::size_t>(eye)]);
    }
  }
  gl_->Disable(GL_SCISSOR_TEST);
  panorama->take_drawn();
  return gl_->check("reusing earlier frames");
}

}  // namespace cyclorama::display
