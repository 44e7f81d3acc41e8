// SPDX-License-Identifier: Apache-2.0
#include "appliance/display/head_program.h"

#include <string>

namespace cyclorama::display {
namespace {

// seen_of() computes at the corners of triangles everything that is linear in position; at_of() computes the rest at
// each pixel.
//
// A direction (x, y, z) has the fisheye position p = (a / sin a) * (x, y), where a is its angle from the axis. With t
// the square of sin(a / 2), the direction is (s sqrt(1 - t) p, 2 t - 1), where t = (s a / 2)^2 and
// s = sin(a / 2) / (a / 2) is a polynomial in (a / 2)^2 up to a half turn (error 6e-9). In reverse, t = (1 + z) / 2,
// and a / 2 = asin(sqrt t), where asin(sqrt t) / sqrt t is a polynomial in t up to 1/2 (error 2e-8); beyond that, it is
// a quarter turn minus the same expression for 1 - t. Both interpolate at Chebyshev's nodes. GLSL's own sine and arc
// tangent have errors of many pixels on some cards.
constexpr const char* kWarpSource = R"(
#extension GL_NV_shader_noperspective_interpolation : enable
precision highp float;
precision highp int;
#ifdef GL_NV_shader_noperspective_interpolation
#define EVEN noperspective  // No perspective division is needed: w is 1 everywhere.
#else
#define EVEN
#endif
#ifdef FLAT
#define SEEN vec3
vec3 seen_of(vec2 place, vec4 to_texture, mat3 turned) { return turned * vec3(place, 1.0); }
vec2 at_of(vec3 seen, vec4 to_texture, mat3 turned) { return seen.xy / seen.z; }
#else
#define SEEN vec2
#ifdef FISHEYE
vec2 seen_of(vec2 place, vec4 to_texture, mat3 turned) { return place; }
vec3 direction_of(vec2 seen) {
  float x = 0.25 * dot(seen, seen);
  float s = (((2.60510764e-06 * x - 0.000198090174) * x + 0.00833305017) * x - 0.166666579) * x + 0.999999996;
  float t = min(x * s * s, 1.0);
  return vec3(seen * (s * sqrt(1.0 - t)), 2.0 * t - 1.0);
}
vec2 at_of(vec2 seen, vec4 to_texture, mat3 turned) {
  vec3 direction = turned * direction_of(seen);
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
layout(location = 1) in vec2 direction;  // Azimuth, tangent of elevation; or another position. On patches: s, t.
layout(location = 2) in vec4 terms0;     // Coefficients of 1 and s.
layout(location = 3) in vec4 terms1;     // Coefficients of t and s^2.
layout(location = 4) in vec4 terms2;     // Coefficients of s t and t^2.
uniform vec2 per_px;
EVEN out vec3 on_head;  // Across and up in [0, 1], and the phase of the dither's pattern.
#ifdef PATCHES
EVEN out vec2 along;
flat out vec4 seen0, seen1, seen2;
flat out vec4 other_seen0, other_seen1, other_seen2;
#else
EVEN out SEEN seen;
EVEN out SEEN other_seen;
#endif
void main() {
  gl_Position = vec4(place, 0.0, 1.0);
  on_head.xy = 0.5 * place + 0.5;
  on_head.z = dot(on_head.xy / per_px, vec2(0.7548776662, 0.5698402910));
#if defined(PATCHES)
  along = direction;
#ifdef SHIFT  // Linear, so it may be applied to the terms instead of the position.
  seen0 = terms0 * to_texture.xyxy + vec4(to_texture.zw, 0.0, 0.0);
  seen1 = terms1 * to_texture.xyxy;
  seen2 = terms2 * to_texture.xyxy;
  other_seen0 = terms0 * other_to_texture.xyxy + vec4(other_to_texture.zw, 0.0, 0.0);
  other_seen1 = terms1 * other_to_texture.xyxy;
  other_seen2 = terms2 * other_to_texture.xyxy;
#else
  seen0 = other_seen0 = terms0;
  seen1 = other_seen1 = terms1;
  seen2 = other_seen2 = terms2;
#endif
#elif !defined(PIXEL_MAP)
  seen = seen_of(direction, to_texture, turned);
#ifdef FADE
  other_seen = seen_of(direction, other_to_texture, other_turned);
#endif
#endif
}
)";
// The polynomials in the light's fourth root approximate 1.055 light^(1/2.4) - 0.055 within 0.009 code values of 8
// bits, and for packed texels, whose precision is no better, within 0.055, by Lawson's algorithm; they take a quarter
// of pow()'s time on a software rasteriser. There, texture() is also much faster than texelFetch(), and gl_FragCoord
// slower than a value from the vertex shader.
//
// Dithering: the multiples of two irrational numbers are evenly distributed over [0, 1) in every neighbourhood (M.
// Roberts, "The Unreasonable Effectiveness of Quasirandom Sequences", 2018: powers of the plastic number), so their
// mean is 1/2.
constexpr const char* kFragmentShader = R"(
#ifdef PACKED
uniform highp usampler2D picture;
uniform highp usampler2D other_picture;
#else
uniform highp sampler2D picture;
uniform highp sampler2D other_picture;
#endif
uniform highp sampler2D mask;       // Rows as in the framebuffer.
uniform highp sampler2D pixel_map;  // Rows likewise.
uniform highp sampler2D responses;  // A row for each of red, green, blue.
uniform vec3 turn;
uniform vec3 other_turn;
uniform vec4 edges;
uniform vec4 other_edges;
uniform vec2 per_texel;
uniform vec2 other_per_texel;
uniform float fade;
uniform mat3 matrix;
uniform vec3 black;
uniform vec2 response;
uniform float code_step;
#ifdef CAPTION
uniform highp sampler2D caption;
uniform mat3 to_caption;
uniform float caption_turn;
uniform vec4 caption_part;
uniform vec2 caption_edge;
uniform float caption_share;
// Light of the letters, and the part of the picture's light that the plate leaves: see caption.h.
vec3 captioned(vec3 light, vec3 seen) {
  vec2 at = seen.xy / seen.z;
  at.x -= caption_turn * floor((at.x - 0.5) / caption_turn + 0.5);
  vec2 inside = (0.5 - abs(at - 0.5)) * caption_edge;
  float plate = seen.z > 0.0 ? clamp(min(inside.x, inside.y), 0.0, 1.0) * caption_share : 0.0;
  float ink = texture(caption, clamp(at * caption_part.xy, caption_part.zw, caption_part.xy - caption_part.zw)).r;
  return mix(light * (1.0 - 0.94 * plate), vec3(0.85), ink * plate);
}
#endif
EVEN in vec3 on_head;
#ifdef PATCHES
EVEN in vec2 along;
flat in vec4 seen0, seen1, seen2;
flat in vec4 other_seen0, other_seen1, other_seen2;
vec2 on_patch(vec4 t0, vec4 t1, vec4 t2) {
  return t0.xy + along.x * (t0.zw + along.x * t1.zw) + along.y * (t1.xy + along.x * t2.xy + along.y * t2.zw);
}
#else
EVEN in SEEN seen;
EVEN in SEEN other_seen;
#endif
out vec4 colour;

#ifdef PACKED
#define PICTURE highp usampler2D
// Not yet scaled, so that the middle field of the word need not be shifted.
vec3 squared(uint texel) {
  vec3 root = vec3(ivec3(int(texel) & 0x7ff, int(texel) & 0x3ff800, int(texel >> 22)));
  return root * root;
}
vec3 filtered(highp usampler2D light, vec2 at, vec2 per) {
  vec2 corner = floor(at);
  vec2 off = at - corner;
  uvec4 texels = textureGather(light, (corner + 1.0) * per);
  float both = off.x * off.y;
  vec3 sum = both * squared(texels.y) + (off.y - both) * squared(texels.x) + (off.x - both) * squared(texels.z) +
             (1.0 - off.x - off.y + both) * squared(texels.w);
  return sum * vec3(2.386523e-7, 5.689915e-14, 9.555133e-7);  // 1 / 2047^2, 1 / (2048 2047)^2, 1 / 1023^2.
}
#else
#define PICTURE highp sampler2D
vec3 filtered(highp sampler2D light, vec2 at, vec2 per) { return texture(light, at).rgb; }
#endif

vec3 light_at(PICTURE light, vec2 at, vec3 whole, vec4 min_and_max, vec2 per) {
#ifdef EDGES
  at.x = (at.x - whole.x * floor(at.x)) * whole.y + whole.z;
  at = clamp(at, min_and_max.xy, min_and_max.zw);
#endif
  return filtered(light, at, per);
}

void main() {
#if defined(PATCHES) && defined(SHIFT)
  vec2 at = on_patch(seen0, seen1, seen2);
  vec2 other_at = on_patch(other_seen0, other_seen1, other_seen2);
#elif defined(PATCHES) || defined(PIXEL_MAP)
#ifdef PATCHES
  vec2 direction = on_patch(seen0, seen1, seen2);
#else
  vec2 direction = texture(pixel_map, on_head.xy).rg;
#endif
  vec2 at = at_of(seen_of(direction, to_texture, turned), to_texture, turned);
  vec2 other_at = at_of(seen_of(direction, other_to_texture, other_turned), other_to_texture, other_turned);
#else
  vec2 at = at_of(seen, to_texture, turned);
  vec2 other_at = at_of(other_seen, other_to_texture, other_turned);
#endif
  vec3 light = light_at(picture, at, turn, edges, per_texel);
#ifdef FADE
  light = mix(light, light_at(other_picture, other_at, other_turn, other_edges, other_per_texel), fade);
#endif
#if defined(CAPTION) && !defined(FISHEYE)
  light = captioned(light, to_caption * vec3(at, 1.0));
#elif defined(CAPTION) && (defined(PATCHES) || defined(PIXEL_MAP))
  light = captioned(light, to_caption * direction_of(direction));
#elif defined(CAPTION)
  light = captioned(light, to_caption * direction_of(seen));
#endif
#ifdef MASK
  vec2 weight = texture(mask, on_head.xy).rg;
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
  vec3 r = sqrt(s);
#ifdef PACKED
  vec3 p = ((-0.13682529 * r + 0.95257481) * r + 0.25579696) * r - 0.07176128;
#else
  vec3 p = (((0.08133408 * r - 0.33551265) * r + 1.12269229) * r + 0.19613158) * r - 0.06461094;
#endif
  vec3 code = mix(p, 12.92 * light, lessThan(light, vec3(0.0031308)));
#endif
#ifdef DITHER
  code += (fract(on_head.z) - 0.5) * code_step;
#endif
  colour = vec4(code, 1.0);
}
)";

std::string with_features(const HeadFeatures& features, const char* shader) {
  // textureGather() requires version 3.1.
  std::string source = features.texels == Texels::kPacked ? "#version 310 es\n" : "#version 300 es\n";
  const auto define = [&](bool is_wanted, const char* name) {
    if (is_wanted) source += std::string("#define ") + name + "\n";
  };
  define(features.turning == YawCorrection::kShift, "SHIFT");
  define(features.turning == YawCorrection::kFlat, "FLAT");
  define(features.turning == YawCorrection::kFisheye, "FISHEYE");
  define(features.warp_kind == WarpKind::kPatches, "PATCHES");
  define(features.warp_kind == WarpKind::kPixelMap, "PIXEL_MAP");
  define(features.texels == Texels::kPacked, "PACKED");
  define(features.edges, "EDGES");
  define(features.mask, "MASK");
  define(features.black_lift, "LIFT");
  define(features.matrix, "MATRIX");
  define(features.response, "RESPONSE");
  define(features.dither, "DITHER");
  define(features.fade, "FADE");
  define(features.caption, "CAPTION");
  return source + kWarpSource + shader;
}

}  // namespace

Result<HeadProgram> HeadProgram::make(const output::Gl& gl, const HeadFeatures& features) {
  CHECK(features.mask || !features.black_lift);
  TRY_ASSIGN(output::GlProgram linked, output::GlProgram::link(gl, with_features(features, kVertexShader).c_str(),
                                                               with_features(features, kFragmentShader).c_str()));
  HeadProgram program(std::move(linked), features);
  const auto uniform = [&](const char* name) { return program.program_.uniform(name); };
  program.picture = {uniform("to_texture"), uniform("turned"), uniform("turn"), uniform("edges"), uniform("per_texel")};
  program.other = {uniform("other_to_texture"), uniform("other_turned"), uniform("other_turn"), uniform("other_edges"),
                   uniform("other_per_texel")};
  program.fade = uniform("fade");
  program.per_px = uniform("per_px");
  program.matrix = uniform("matrix");
  program.black = uniform("black");
  program.response = uniform("response");
  program.step = uniform("code_step");
  program.to_caption = uniform("to_caption");
  program.caption_turn = uniform("caption_turn");
  program.caption_part = uniform("caption_part");
  program.caption_edge = uniform("caption_edge");
  program.caption_share = uniform("caption_share");
  gl.UseProgram(program.id());
  gl.Uniform1i(uniform("picture"), kPicture);
  gl.Uniform1i(uniform("other_picture"), kOther);
  gl.Uniform1i(uniform("mask"), kMask);
  gl.Uniform1i(uniform("pixel_map"), kMap);
  gl.Uniform1i(uniform("responses"), kResponse);
  gl.Uniform1i(uniform("caption"), kCaption);
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

}  // namespace cyclorama::display
