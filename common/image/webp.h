// SPDX-License-Identifier: Apache-2.0
/// WebP with libwebp: textures of scenes.
#pragma once

#include <cstddef>
#include <span>

#include "common/base/result.h"
#include "common/image/image.h"

namespace cyclorama {

/// Decodes a still WebP picture, lossy or lossless. Errors: kBadData for damaged or truncated bytes, animations, and
/// more than `limit_px` pixels, which are refused before allocation. Reentrant.
Result<RgbaImage> decode_webp(std::span<const std::byte> webp, std::size_t limit_px);

}  // namespace cyclorama
