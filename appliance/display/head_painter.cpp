// SPDX-License-Identifier: Apache-2.0
#include "appliance/display/head_painter.h"

#include <algorithm>
#include <cstddef>
#include <numbers>
#include <span>

#include "appliance/display/yaw_shift.h"

namespace cyclorama {
namespace {

constexpr GLuint kPlace = 0;
constexpr GLuint kDirection = 1;
constexpr GLint kPictureUnit = 0;
constexpr GLint kMaskUnit = 1;

// Each pixel is (azimuth, tan_elevation) interpolated at its centre. The four texels are mixed here and not by the
// card's sampler, whose weights have only 8 bits.
constexpr const char* kVertexShader = R"(#version 300 es
precision highp float;
layout(location = 0) in vec2 place;      // In GL's clip space.
layout(location = 1) in vec2 direction;  // Azimuth, tangent of elevation.
out highp vec2 seen;
void main() {
  gl_Position = vec4(place, 0.0, 1.0);
  seen = direction;
}
)";
constexpr const char* kFragmentShader = R"(#version 300 es
precision highp float;
precision highp int;
uniform highp sampler2D picture;   // sRGB: fetches are linear light.
uniform highp sampler2D mask;      // Rows as in the framebuffer.
uniform vec4 to_picture;           // pixel = seen * xy + zw
uniform vec4 size;                 // Width, height, 1 if the picture is a whole turn, pixels of a whole turn.
in highp vec2 seen;
out vec4 colour;

vec3 light_at(float x, float y) { return texelFetch(picture, ivec2(int(x), int(y)), 0).rgb; }

vec3 encoded(vec3 light) {         // IEC 61966-2-1.
  return mix(12.92 * light, 1.055 * pow(light, vec3(1.0 / 2.4)) - 0.055, vec3(greaterThan(light, vec3(0.0031308))));
}

void main() {
  vec2 last = size.xy - 1.0;
  vec2 p = seen * to_picture.xy + to_picture.zw - 0.5;  // Whole numbers are the centres of texels.
  if (size.z != 0.0) p.x -= size.w * floor(p.x / size.w);
  vec2 first = floor(p);
  vec2 f = p - first;
  float x0 = clamp(first.x, 0.0, last.x);
  float x1 = size.z != 0.0 && first.x + 1.0 > last.x ? 0.0 : clamp(first.x + 1.0, 0.0, last.x);
  float y0 = clamp(first.y, 0.0, last.y);
  float y1 = clamp(first.y + 1.0, 0.0, last.y);
  vec3 upper = mix(light_at(x0, y0), light_at(x1, y0), f.x);
  vec3 lower = mix(light_at(x0, y1), light_at(x1, y1), f.x);
  float weight = texelFetch(mask, ivec2(gl_FragCoord.xy), 0).r;
  colour = vec4(encoded(mix(upper, lower, f.y) * weight), 1.0);
}
)";

struct Corner {
  float x;
  float y;
  float azimuth_rad;
  float tan_elevation;
};

std::vector<Corner> corners_of(const WarpMesh& mesh) {
  std::vector<Corner> corners;
  corners.reserve(mesh.vertices.size());
  for (const WarpVertex& v : mesh.vertices) {
    corners.push_back({2.0f * v.x_px / static_cast<float>(mesh.width_px) - 1.0f,
                       1.0f - 2.0f * v.y_px / static_cast<float>(mesh.height_px), v.azimuth_rad, v.tan_elevation});
  }
  return corners;
}

/// Whether any pixel in the box around three corners may be lit.
bool is_lit(const WarpMesh& mesh, const MaskImage& mask, std::span<const std::uint32_t> triangle) {
  float left = static_cast<float>(mask.width());
  float top = static_cast<float>(mask.height());
  float right = 0.0f;
  float bottom = 0.0f;
  for (const std::uint32_t corner : triangle) {
    const WarpVertex& v = mesh.vertices[corner];
    left = std::min(left, v.x_px);
    right = std::max(right, v.x_px);
    top = std::min(top, v.y_px);
    bottom = std::max(bottom, v.y_px);
  }
  const int last_x = std::min(mask.width() - 1, static_cast<int>(right));
  const int last_y = std::min(mask.height() - 1, static_cast<int>(bottom));
  for (int y = static_cast<int>(top); y <= last_y; ++y) {
    for (int x = static_cast<int>(left); x <= last_x; ++x) {
      if (*mask.at(x, y) > 0.0f) return true;
    }
  }
  return false;
}

/// The mesh's triangles without those that the mask blackens: a projector that reaches past the wall has many.
std::vector<std::uint32_t> lit_triangles(const WarpMesh& mesh, const MaskImage& mask) {
  const std::vector<std::uint32_t> all = mesh.triangles();
  std::vector<std::uint32_t> lit;
  for (std::size_t i = 0; i + 2 < all.size(); i += 3) {
    const std::span<const std::uint32_t> triangle(all.data() + i, 3);
    if (is_lit(mesh, mask, triangle)) lit.insert(lit.end(), triangle.begin(), triangle.end());
  }
  return lit;
}

/// GL counts rows from the bottom.
std::vector<float> upside_down(const MaskImage& mask) {
  std::vector<float> rows;
  rows.reserve(mask.data().size());
  for (int y = mask.height() - 1; y >= 0; --y) rows.insert(rows.end(), mask.at(0, y), mask.at(0, y) + mask.width());
  return rows;
}

GLsizeiptr byte_count(const auto& values) { return static_cast<GLsizeiptr>(values.size() * sizeof(values[0])); }

}  // namespace

Result<WarpProgram> WarpProgram::make(const Gl& gl) {
  TRY_ASSIGN(GlProgram linked, GlProgram::link(gl, kVertexShader, kFragmentShader));
  WarpProgram program(std::move(linked));
  program.to_picture_ = program.program_.uniform("to_picture");
  program.size_ = program.program_.uniform("size");
  gl.UseProgram(program.program_.id());
  gl.Uniform1i(program.program_.uniform("picture"), kPictureUnit);
  gl.Uniform1i(program.program_.uniform("mask"), kMaskUnit);
  TRY(gl.check("preparing the warp shader"));
  return program;
}

Result<HeadPainter> HeadPainter::make(const Gl& gl, const WarpProgram& program, const WarpMesh& mesh,
                                      const MaskImage& mask) {
  CHECK(mask.width() == mesh.width_px && mask.height() == mesh.height_px);
  HeadPainter painter(gl, program);
  painter.mesh_ = GlVertexArray(gl);
  painter.vertices_ = GlBuffer(gl);
  painter.indices_ = GlBuffer(gl);
  painter.mask_ = GlTexture(gl);

  const std::vector<Corner> corners = corners_of(mesh);
  const std::vector<std::uint32_t> indices = lit_triangles(mesh, mask);
  painter.index_count_ = static_cast<GLsizei>(indices.size());
  gl.BindVertexArray(painter.mesh_.id());
  gl.BindBuffer(GL_ARRAY_BUFFER, painter.vertices_.id());
  gl.BufferData(GL_ARRAY_BUFFER, byte_count(corners), corners.data(), GL_STATIC_DRAW);
  gl.BindBuffer(GL_ELEMENT_ARRAY_BUFFER, painter.indices_.id());
  gl.BufferData(GL_ELEMENT_ARRAY_BUFFER, byte_count(indices), indices.data(), GL_STATIC_DRAW);
  const auto attribute = [&](GLuint index, std::size_t offset) {
    gl.EnableVertexAttribArray(index);
    // GL's own convention: an offset into the bound buffer, passed as a pointer.
    gl.VertexAttribPointer(index, 2, GL_FLOAT, GL_FALSE, sizeof(Corner), reinterpret_cast<const void*>(offset));
  };
  attribute(kPlace, offsetof(Corner, x));
  attribute(kDirection, offsetof(Corner, azimuth_rad));

  const std::vector<float> rows = upside_down(mask);
  gl.BindTexture(GL_TEXTURE_2D, painter.mask_.id());
  gl.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
  gl.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
  gl.TexImage2D(GL_TEXTURE_2D, 0, GL_R32F, mask.width(), mask.height(), 0, GL_RED, GL_FLOAT, rows.data());
  TRY(gl.check("uploading a warp mesh and a blend mask"));
  return painter;
}

void HeadPainter::draw(const PanoramaTexture& picture, double yaw_shift_rad) const {
  const Panorama& panorama = picture.panorama();
  const double px_per_rad = 1.0 / panorama.radians_per_px();
  const double px_per_tan = panorama.height_px / (panorama.tan_elevation_bottom - panorama.tan_elevation_top);
  const double turn_px = 2.0 * std::numbers::pi * px_per_rad;
  const bool wraps = is_whole_turn(panorama);

  gl_->ClearColor(0.0f, 0.0f, 0.0f, 1.0f);
  gl_->Clear(GL_COLOR_BUFFER_BIT);
  gl_->UseProgram(program_->program_.id());
  gl_->Uniform4f(program_->to_picture_, static_cast<float>(px_per_rad), static_cast<float>(px_per_tan),
                 static_cast<float>(0.5 * panorama.width_px + yaw_shift_rad * px_per_rad),
                 static_cast<float>(-panorama.tan_elevation_top * px_per_tan));
  gl_->Uniform4f(program_->size_, static_cast<float>(panorama.width_px), static_cast<float>(panorama.height_px),
                 wraps ? 1.0f : 0.0f, static_cast<float>(turn_px));
  gl_->ActiveTexture(GL_TEXTURE0 + kMaskUnit);
  gl_->BindTexture(GL_TEXTURE_2D, mask_.id());
  gl_->ActiveTexture(GL_TEXTURE0 + kPictureUnit);
  gl_->BindTexture(GL_TEXTURE_2D, picture.id());
  gl_->BindVertexArray(mesh_.id());
  gl_->DrawElements(GL_TRIANGLES, index_count_, GL_UNSIGNED_INT, nullptr);
}

}  // namespace cyclorama
