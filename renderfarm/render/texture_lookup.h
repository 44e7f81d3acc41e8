// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>

#include "renderfarm/render/vectors.h"
#include "renderfarm/scene/model.h"

namespace cyclorama {

/// Code values 0..255 to linear light.
[[nodiscard]] const std::array<float, 256>& srgb_table();
/// Code values 0..255 to 0..1.
[[nodiscard]] const std::array<float, 256>& linear_table();

/// How a texture's RGB is coded; alpha is always linear.
enum class Coding { kSrgb, kLinear };

/// The texture at uv, filtered bilinearly in linear light: (r, g, b, a). (0, 0) is the upper left corner of the first
/// texel, (1, 1) the lower right one of the last. Coordinates that are not finite read as 0. Reentrant.
[[nodiscard]] Eigen::Vector4f lookup(const Texture& texture, const Vec2& uv, Coding coding);

/// Only the alpha of the same.
[[nodiscard]] float lookup_alpha(const Texture& texture, const Vec2& uv);

/// Whether any texel is not opaque.
[[nodiscard]] bool has_transparency(const Texture& texture);

}  // namespace cyclorama
