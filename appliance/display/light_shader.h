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

/// Part of the fragment shaders after kLightShader: `root_sharply(light, at)` does what root_between() does, with the
/// filter of Catmull and Rom, which softens little but may overshoot. The four corners are omitted, which have less
/// than a hundredth of the weight.
inline constexpr const char* kSharpFilterShader = R"(
vec4 sharp_weights(float t) {
  return vec4(t * (t * (1.0 - 0.5 * t) - 0.5), 1.0 + t * t * (1.5 * t - 2.5), t * (0.5 + t * (2.0 - 1.5 * t)),
              t * t * (0.5 * t - 0.5));
}
vec3 root_sharply(LIGHT light, vec2 at) {
  vec2 corner = floor(at - 0.5);
  ivec2 base = ivec2(corner);
  vec4 x = sharp_weights(at.x - 0.5 - corner.x);
  vec4 y = sharp_weights(at.y - 0.5 - corner.y);
  vec3 above = x.y * root_at(light, base + ivec2(0, -1)) + x.z * root_at(light, base + ivec2(1, -1));
  vec3 first = x.x * root_at(light, base + ivec2(-1, 0)) + x.y * root_at(light, base) +
               x.z * root_at(light, base + ivec2(1, 0)) + x.w * root_at(light, base + ivec2(2, 0));
  vec3 second = x.x * root_at(light, base + ivec2(-1, 1)) + x.y * root_at(light, base + ivec2(0, 1)) +
                x.z * root_at(light, base + ivec2(1, 1)) + x.w * root_at(light, base + ivec2(2, 1));
  vec3 below = x.y * root_at(light, base + ivec2(0, 2)) + x.z * root_at(light, base + ivec2(1, 2));
  float sum = 1.0 - (x.x + x.w) * (y.x + y.w);
  return (y.x * above + y.y * first + y.z * second + y.w * below) / sum;
}
)";

/// Vertex shader of a rectangle, whose corners it computes from their numbers: uniform `place`, in clip space.
inline constexpr const char* kRectangleShader = R"(
precision highp float;
uniform vec4 place;  // Left, top, right, bottom.
void main() {
  gl_Position = vec4((gl_VertexID & 1) == 0 ? place.x : place.z, (gl_VertexID & 2) == 0 ? place.y : place.w, 0.0, 1.0);
}
)";
[[nodiscard]] inline float in_clip_space(int px, int size) {
  return 2.0f * static_cast<float>(px) / static_cast<float>(size) - 1.0f;
}

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
