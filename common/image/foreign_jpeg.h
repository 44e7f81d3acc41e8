// SPDX-License-Identifier: Apache-2.0
/// JPEG files of any program, by libjpeg: textures and photographs. The wire's own pictures are read by jpeg.h.
#pragma once

#include <cstddef>
#include <span>

#include "common/base/result.h"
#include "common/image/image.h"

namespace cyclorama {

/// Decodes a JPEG of any sampling of its colours (4:1:0 too): grey, YCbCr, RGB, CMYK or YCCK. Bytes between its
/// segments that belong to none are skipped, as all programs do. CMYK is converted without its profile, as for a screen.
/// Errors: kBadData, which names the fault; a truncated or otherwise damaged picture is refused, never returned in part,
/// and more than `limit_px` pixels are refused before allocation. Reentrant.
Result<RgbaImage> decode_foreign_jpeg(std::span<const std::byte> jpeg, std::size_t limit_px);

}  // namespace cyclorama
