// SPDX-License-Identifier: Apache-2.0
#include "appliance/display/head_program.h"

#include <string>

namespace cyclorama {
namespace {

constexpr const char* kVertexShader = R"(
precision highp float;
layout(location = 0) in vec2 place;      // In GL's clip space.
layout(location = 1) in vec2 direction;  // Azimuth, tangent of elevation.
uniform vec4 to_texture;
uniform vec4 other_to_texture;
out highp vec2 seen;
out highp vec2 other_seen;
void main() {
  gl_Position = vec4(place, 0.0, 1.0);
#ifndef PIXEL_MAP
  seen = direction * to_texture.xy + to_texture.zw;
#ifdef FADE
  other_seen = direction * other_to_texture.xy + other_to_texture.zw;
#endif
#endif
}
)";
// The polynomial in the light's square root is 1.055 light^(1/2.4) - 0.055 within 0.04 code values of 8 bits, by Remez
// exchange; a third of pow()'s time on a software rasteriser. There, texture() is much quicker than texelFetch(), too.
// Dithering: the multiples of two irrational numbers spread evenly over [0, 1) in every neighbourhood (M. Roberts, "The
// Unreasonable Effectiveness of Quasirandom Sequences", 2018: powers of the plastic number), so their mean is 1/2.
constexpr const char* kFragmentShader = R"(
precision highp float;
uniform highp sampler2D picture;
uniform highp sampler2D other_picture;
uniform highp sampler2D mask;       // Rows as in the framebuffer.
uniform highp sampler2D pixel_map;  // The same.
uniform highp sampler2D responses;  // A row for each of red, green, blue.
uniform vec4 to_texture;
uniform vec4 other_to_texture;
uniform vec3 turn;
uniform vec3 other_turn;
uniform vec4 edges;
uniform vec4 other_edges;
uniform float fade;
uniform vec2 per_px;
uniform mat3 matrix;
uniform vec3 black;
uniform vec2 response;
uniform float code_step;
in highp vec2 seen;
in highp vec2 other_seen;
out vec4 colour;

vec3 light_at(highp sampler2D light, vec2 at, vec3 whole, vec4 least_and_most) {
  at.x = (at.x - whole.x * floor(at.x)) * whole.y + whole.z;
  return texture(light, clamp(at, least_and_most.xy, least_and_most.zw)).rgb;
}

void main() {
#ifdef PIXEL_MAP
  vec2 direction = texture(pixel_map, gl_FragCoord.xy * per_px).rg;
  vec2 at = direction * to_texture.xy + to_texture.zw;
#else
  vec2 at = seen;
#endif
  vec3 light = light_at(picture, at, turn, edges);
#ifdef FADE
#ifdef PIXEL_MAP
  vec2 other_at = direction * other_to_texture.xy + other_to_texture.zw;
#else
  vec2 other_at = other_seen;
#endif
  light = mix(light, light_at(other_picture, other_at, other_turn, other_edges), fade);
#endif
#ifdef MASK
  vec2 weight = texture(mask, gl_FragCoord.xy * per_px).rg;
  light *= weight.r;
#endif
#ifdef MATRIX
  light = matrix * light;
#endif
#ifdef LIFT
  light += black * weight.g;
#endif
#if defined(MATRIX) || defined(LIFT)
  light = clamp(light, 0.0, 1.0);
#endif
  vec3 s = sqrt(light);
#ifdef RESPONSE
  s = s * response.x + response.y;
  vec3 code = vec3(texture(responses, vec2(s.r, 1.0 / 6.0)).r, texture(responses, vec2(s.g, 0.5)).r,
                   texture(responses, vec2(s.b, 5.0 / 6.0)).r);
#ifdef MASK
  if (weight == vec2(0.0)) code = vec3(0.0);  // Off the wall: darker than any response.
#endif
#else
  vec3 p = (((((-0.947729568 * s + 3.41887796) * s - 5.00341182) * s + 3.89859268) * s - 1.89952359) * s
            + 1.57527761) * s - 0.0422322795;
  vec3 code = mix(p, 12.92 * light, lessThan(light, vec3(0.0031308)));
#endif
#ifdef DITHER
  code += (fract(dot(gl_FragCoord.xy, vec2(0.7548776662, 0.5698402910))) - 0.5) * code_step;
#endif
  colour = vec4(code, 1.0);
}
)";

std::string with_features(const HeadFeatures& features, const char* shader) {
  std::string source = "#version 300 es\n";
  const auto define = [&](bool is_wanted, const char* name) {
    if (is_wanted) source += std::string("#define ") + name + "\n";
  };
  define(features.pixel_map, "PIXEL_MAP");
  define(features.mask, "MASK");
  define(features.lift, "LIFT");
  define(features.matrix, "MATRIX");
  define(features.response, "RESPONSE");
  define(features.dither, "DITHER");
  define(features.fade, "FADE");
  return source + shader;
}

}  // namespace

Result<HeadProgram> HeadProgram::make(const Gl& gl, const HeadFeatures& features) {
  CHECK(features.mask || !features.lift);
  TRY_ASSIGN(GlProgram linked, GlProgram::link(gl, with_features(features, kVertexShader).c_str(),
                                               with_features(features, kFragmentShader).c_str()));
  HeadProgram program(std::move(linked), features);
  const auto uniform = [&](const char* name) { return program.program_.uniform(name); };
  program.picture = {uniform("to_texture"), uniform("turn"), uniform("edges")};
  program.other = {uniform("other_to_texture"), uniform("other_turn"), uniform("other_edges")};
  program.fade = uniform("fade");
  program.per_px = uniform("per_px");
  program.matrix = uniform("matrix");
  program.black = uniform("black");
  program.response = uniform("response");
  program.step = uniform("code_step");
  gl.UseProgram(program.id());
  gl.Uniform1i(uniform("picture"), kPicture);
  gl.Uniform1i(uniform("other_picture"), kOther);
  gl.Uniform1i(uniform("mask"), kMask);
  gl.Uniform1i(uniform("pixel_map"), kMap);
  gl.Uniform1i(uniform("responses"), kResponse);
  TRY(gl.check("preparing a warp shader"));
  return program;
}

Result<const HeadProgram*> HeadPrograms::get(const HeadFeatures& features) {
  for (const auto& program : programs_) {
    if (program->features() == features) return program.get();
  }
  TRY_ASSIGN(HeadProgram made, HeadProgram::make(gl_, features));
  programs_.push_back(std::make_unique<HeadProgram>(std::move(made)));
  return programs_.back().get();
}

}  // namespace cyclorama
