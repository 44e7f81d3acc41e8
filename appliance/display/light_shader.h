// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "appliance/display/texels.h"

namespace cyclorama::display {

/// Part of the fragment shaders that write light in the format of Texels (PACKED: kPacked). `written(light)` is the
/// output value; `written_root(root)` is the same from the light's square root. `root_at(light, texel)` reads a square
/// root back; `root_between(light, at, per_texel)` interpolates it at the position `at`, in texels. Square roots are
/// filtered instead of light, because they are close to a picture's code values and packed texels hold them.
inline constexpr const char* kLightShader = R"(
precision highp float;
precision highp int;
#ifdef PACKED  // Format of texels.h, red in the low bits.
#define LIGHT highp usampler2D
out uint texel;
uint written_root(vec3 root) {
  uvec3 steps = uvec3(root * vec3(2047.0, 2047.0, 1023.0) + 0.5);
  return steps.r | steps.g << 11 | steps.b << 22;
}
uint written(vec3 light) { return written_root(sqrt(light)); }
// Not yet scaled, so that the middle field of the word need not be shifted.
vec3 steps_of(uint word) { return vec3(ivec3(int(word) & 0x7ff, int(word) & 0x3ff800, int(word >> 22))); }
const vec3 kPerStep = vec3(4.885198e-4, 2.385351e-7, 9.775171e-4);  // 1 / 2047, 1 / (2048 2047), 1 / 1023.
vec3 root_at(LIGHT light, ivec2 at) { return steps_of(texelFetch(light, at, 0).r) * kPerStep; }
vec3 root_between(LIGHT light, vec2 at, vec2 per_texel) {
  vec2 corner = floor(at - 0.5);
  vec2 off = at - 0.5 - corner;
  uvec4 texels = textureGather(light, (corner + 1.0) * per_texel);
  vec3 above = mix(steps_of(texels.w), steps_of(texels.z), off.x);
  vec3 below = mix(steps_of(texels.x), steps_of(texels.y), off.x);
  return mix(above, below, off.y) * kPerStep;
}
#else
#define LIGHT highp sampler2D
out vec4 texel;
vec4 written(vec3 light) { return vec4(light, 1.0); }
vec4 written_root(vec3 root) { return written(root * root); }
vec3 root_at(LIGHT light, ivec2 at) { return sqrt(texelFetch(light, at, 0).rgb); }
vec3 root_between(LIGHT light, vec2 at, vec2 per_texel) { return sqrt(texture(light, at * per_texel).rgb); }
#endif
)";

/// Defines `EVEN`, which marks values that a rasteriser may interpolate without dividing by w, since w is 1 everywhere.
inline constexpr const char* kEvenShader = R"(
#extension GL_NV_shader_noperspective_interpolation : enable
#ifdef GL_NV_shader_noperspective_interpolation
#define EVEN noperspective
#else
#define EVEN
#endif
)";

/// Returns the first lines of every shader of a program with kLightShader; textureGather() requires version 3.1.
[[nodiscard]] inline std::string light_shader_version(Texels texels) {
  return texels == Texels::kPacked ? "#version 310 es\n#define PACKED\n" : "#version 300 es\n";
}
/// Returns the beginning of a fragment shader with kLightShader. `extensions` are preprocessor lines.
[[nodiscard]] inline std::string light_shader_header(Texels texels, const char* extensions = "") {
  return light_shader_version(texels) + extensions + kLightShader;
}

}  // namespace cyclorama::display
