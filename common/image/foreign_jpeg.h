// SPDX-License-Identifier: Apache-2.0
/// Reads JPEG files of any program, with libjpeg: textures and photographs. jpeg.h reads the pictures of the wire.
#pragma once

#include <cstddef>
#include <span>

#include "common/base/result.h"
#include "common/image/image.h"

namespace cyclorama {

/// Decodes a JPEG in grey, YCbCr, RGB, CMYK or YCCK, with any chroma subsampling (also 4:1:0). Bytes between segments
/// are skipped, as by other programs. CMYK is converted without its profile, as for a screen. Errors: kBadData, which
/// names the fault; a truncated or otherwise damaged picture is refused, never returned in part, and more than
/// `limit_px` pixels are refused before allocation. Reentrant.
Result<RgbaImage> decode_foreign_jpeg(std::span<const std::byte> jpeg, std::size_t limit_px);

}  // namespace cyclorama
