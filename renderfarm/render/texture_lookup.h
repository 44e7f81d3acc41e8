// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>

#include "renderfarm/render/mip_texture.h"
#include "renderfarm/render/vectors.h"

namespace cyclorama::render {

/// Table from code values 0..255 to linear light.
[[nodiscard]] const std::array<float, 256>& srgb_table();
/// Table from code values 0..255 to 0..1.
[[nodiscard]] const std::array<float, 256>& linear_table();

/// Coding of a texture's RGB; alpha is always linear.
enum class Coding { kSrgb, kLinear };

/// Returns the texture at uv in linear light: (r, g, b, a). (0, 0) is the upper left corner of the first texel, (1, 1)
/// the lower right corner of the last.
///
/// `lod` is the base-2 logarithm of the side, in texels of level 0, of the area to be averaged. At 0 and below, and for
/// NaN, level 0 is filtered bilinearly; above 0, the two nearest levels are filtered and the results interpolated.
/// Textures with the `nearest` flag return the nearest texel of the nearest level. Non-finite coordinates read as 0; a
/// texture without pixels is 1. Reentrant.
[[nodiscard]] Eigen::Vector4f lookup(const MipTexture& texture, const Vec2& uv, Coding coding, float lod);

/// Returns only the alpha, at level 0.
[[nodiscard]] float lookup_alpha(const MipTexture& texture, const Vec2& uv);

/// Returns true if any texel is not opaque.
[[nodiscard]] bool has_transparency(const scene::Texture& texture);

}  // namespace cyclorama::render
