// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>

#include "renderfarm/render/mip_texture.h"
#include "renderfarm/render/vectors.h"

namespace cyclorama {

/// Code values 0..255 to linear light.
[[nodiscard]] const std::array<float, 256>& srgb_table();
/// Code values 0..255 to 0..1.
[[nodiscard]] const std::array<float, 256>& linear_table();

/// How a texture's RGB is coded; alpha is always linear.
enum class Coding { kSrgb, kLinear };

/// The texture at uv in linear light: (r, g, b, a). (0, 0) is the upper left corner of the first texel, (1, 1) the
/// lower right one of the last. `lod` is the base-2 logarithm of the side, in texels of level 0, of the area to be
/// averaged: at 0 and below, and where it is NaN, level 0 is filtered bilinearly; above, the two levels around it, and
/// between them linearly. Textures that ask for the nearest texel get it, of the nearest level. Coordinates that are
/// not finite read as 0; a texture without pixels is 1. Reentrant.
[[nodiscard]] Eigen::Vector4f lookup(const MipTexture& texture, const Vec2& uv, Coding coding, float lod);

/// Only the alpha of the same, at level 0.
[[nodiscard]] float lookup_alpha(const MipTexture& texture, const Vec2& uv);

/// Whether any texel is not opaque.
[[nodiscard]] bool has_transparency(const Texture& texture);

}  // namespace cyclorama
