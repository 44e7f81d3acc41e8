// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace cyclorama::display {

/// Part of pass 1's fragment shaders: `light_of(y, blue, red)` converts a pixel's luma and chroma, as sampled from their
/// planes, to linear light; `written(light)` is the output in the format of Texels (PACKED if it is kPacked).
///
/// The polynomial approximates ((c + 0.055) / 1.055)^2.4 within 0.013 code values of 8 bits, by Remez exchange; it takes
/// a third of pow()'s time on a software rasteriser.
inline constexpr const char* kLightShader = R"(
precision highp float;
precision highp int;
uniform highp sampler2D luma_plane;
uniform highp sampler2D blue_plane;
uniform highp sampler2D red_plane;
vec3 light_of(float y, float blue_sample, float red_sample) {
  float blue = blue_sample - 128.0 / 255.0;
  float red = red_sample - 128.0 / 255.0;
  vec3 c = clamp(vec3(y + 1.402 * red, y - 0.344136286 * blue - 0.714136286 * red, y + 1.772 * blue), 0.0, 1.0);
  vec3 p = ((((0.0872824213 * c - 0.307377663) * c + 0.66716066) * c + 0.519381961) * c + 0.0327460791) * c
           + 0.000916890727;
  return mix(p, c / 12.92, lessThanEqual(c, vec3(0.04045)));
}
#ifdef PACKED  // Format of texels.h, red in the low bits.
#define WRITTEN uint
uint written(vec3 light) {
  uvec3 root = uvec3(sqrt(light) * vec3(2047.0, 2047.0, 1023.0) + 0.5);
  return root.r | root.g << 11 | root.b << 22;
}
#else
#define WRITTEN vec4
vec4 written(vec3 light) { return vec4(light, 1.0); }
#endif
out WRITTEN texel;
)";

}  // namespace cyclorama::display
