// SPDX-License-Identifier: Apache-2.0
#include "appliance/display/head_program.h"

#include <string>

namespace cyclorama {
namespace {

// What is even in places is found at the corners of triangles, seen_of(); the rest at each pixel, at_of().
//
// A fisheye's place p = (a / sin a) * (x, y) of a direction (x, y, z), a its angle from the axis. With t the square of
// sin(a / 2): the direction is (s sqrt(1 - t) p, 2 t - 1), t = (s a / 2)^2, s = sin(a / 2) / (a / 2) a polynomial in
// (a / 2)^2 up to a half turn (off by 6e-9). Back, t = (1 + z) / 2, and a / 2 = asin(sqrt t), where asin(sqrt t) / sqrt
// t is a polynomial in t up to 1/2 (off by 2e-8); beyond, it is a quarter turn less the same of 1 - t. Both interpolate
// at Chebyshev's nodes. GLSL's own sine and arc tangent may be off by many pixels on some cards.
constexpr const char* kPlaces = R"(
precision highp float;
#ifdef FLAT
#define SEEN vec3
vec3 seen_of(vec2 place, vec4 to_texture, mat3 turned) { return turned * vec3(place, 1.0); }
vec2 at_of(vec3 seen, vec4 to_texture, mat3 turned) { return seen.xy / seen.z; }
#else
#define SEEN vec2
#ifdef FISHEYE
vec2 seen_of(vec2 place, vec4 to_texture, mat3 turned) { return place; }
vec2 at_of(vec2 seen, vec4 to_texture, mat3 turned) {
  float x = 0.25 * dot(seen, seen);
  float s = (((2.60510764e-06 * x - 0.000198090174) * x + 0.00833305017) * x - 0.166666579) * x + 0.999999996;
  float t = min(x * s * s, 1.0);
  vec3 direction = turned * vec3(seen * (s * sqrt(1.0 - t)), 2.0 * t - 1.0);
  float u = clamp(0.5 + 0.5 * direction.z, 0.0, 0.9999999);
  float w = min(u, 1.0 - u);
  float p = ((((((0.109673983 * w - 0.0900862168) * w + 0.0755397539) * w + 0.0167313889) * w + 0.0464808495) * w
              + 0.0748811444) * w + 0.166669547) * w + 0.999999989;
  float root = inversesqrt(1.0 - u);
  float stretch = u <= 0.5 ? p * root : (1.57079633 * root - p) * inversesqrt(u);
  return direction.xy * stretch * to_texture.xy + to_texture.zw;
}
#else
vec2 seen_of(vec2 place, vec4 to_texture, mat3 turned) { return place * to_texture.xy + to_texture.zw; }
vec2 at_of(vec2 seen, vec4 to_texture, mat3 turned) { return seen; }
#endif
#endif
uniform vec4 to_texture;
uniform vec4 other_to_texture;
uniform mat3 turned;
uniform mat3 other_turned;
)";
constexpr const char* kVertexShader = R"(
layout(location = 0) in vec2 place;      // In GL's clip space.
layout(location = 1) in vec2 direction;  // Azimuth, tangent of elevation; or other places.
out SEEN seen;
out SEEN other_seen;
void main() {
  gl_Position = vec4(place, 0.0, 1.0);
#ifndef PIXEL_MAP
  seen = seen_of(direction, to_texture, turned);
#ifdef FADE
  other_seen = seen_of(direction, other_to_texture, other_turned);
#endif
#endif
}
)";
// The polynomial in the light's square root is 1.055 light^(1/2.4) - 0.055 within 0.04 code values of 8 bits, by Remez
// exchange; a third of pow()'s time on a software rasteriser. There, texture() is much quicker than texelFetch(), too.
// Dithering: the multiples of two irrational numbers spread evenly over [0, 1) in every neighbourhood (M. Roberts, "The
// Unreasonable Effectiveness of Quasirandom Sequences", 2018: powers of the plastic number), so their mean is 1/2.
constexpr const char* kFragmentShader = R"(
uniform highp sampler2D picture;
uniform highp sampler2D other_picture;
uniform highp sampler2D mask;       // Rows as in the framebuffer.
uniform highp sampler2D pixel_map;  // The same.
uniform highp sampler2D responses;  // A row for each of red, green, blue.
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
in SEEN seen;
in SEEN other_seen;
out vec4 colour;

vec3 light_at(highp sampler2D light, vec2 at, vec3 whole, vec4 least_and_most) {
  at.x = (at.x - whole.x * floor(at.x)) * whole.y + whole.z;
  return texture(light, clamp(at, least_and_most.xy, least_and_most.zw)).rgb;
}

void main() {
#ifdef PIXEL_MAP
  vec2 direction = texture(pixel_map, gl_FragCoord.xy * per_px).rg;
  vec2 at = at_of(seen_of(direction, to_texture, turned), to_texture, turned);
#else
  vec2 at = at_of(seen, to_texture, turned);
#endif
  vec3 light = light_at(picture, at, turn, edges);
#ifdef FADE
#ifdef PIXEL_MAP
  vec2 other_at = at_of(seen_of(direction, other_to_texture, other_turned), other_to_texture, other_turned);
#else
  vec2 other_at = at_of(other_seen, other_to_texture, other_turned);
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
  define(features.turning == Turning::kFlat, "FLAT");
  define(features.turning == Turning::kFisheye, "FISHEYE");
  define(features.pixel_map, "PIXEL_MAP");
  define(features.mask, "MASK");
  define(features.lift, "LIFT");
  define(features.matrix, "MATRIX");
  define(features.response, "RESPONSE");
  define(features.dither, "DITHER");
  define(features.fade, "FADE");
  return source + kPlaces + shader;
}

}  // namespace

Result<HeadProgram> HeadProgram::make(const Gl& gl, const HeadFeatures& features) {
  CHECK(features.mask || !features.lift);
  TRY_ASSIGN(GlProgram linked, GlProgram::link(gl, with_features(features, kVertexShader).c_str(),
                                               with_features(features, kFragmentShader).c_str()));
  HeadProgram program(std::move(linked), features);
  const auto uniform = [&](const char* name) { return program.program_.uniform(name); };
  program.picture = {uniform("to_texture"), uniform("turned"), uniform("turn"), uniform("edges")};
  program.other = {uniform("other_to_texture"), uniform("other_turned"), uniform("other_turn"), uniform("other_edges")};
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
