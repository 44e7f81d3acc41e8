// SPDX-License-Identifier: Apache-2.0
/// OpenEXR with its own library: the usual format of photographed panoramas of light.
#pragma once

#include <cstddef>
#include <span>

#include "common/base/result.h"
#include "common/image/image.h"

namespace cyclorama {

/// Decodes the channels R, G and B, or Y alone (grey), of a file with one part whose data window equals its display
/// window, with any compression, in rows or tiles; of several resolutions, the highest is used. The result is linear
/// light; texels pass sane_radiance(). Errors: kBadData if the file is damaged or truncated, has another layout (named,
/// with the remedy), or has more than `limit_px` pixels, which are refused before allocation. Reentrant.
Result<RadianceImage> decode_openexr(std::span<const std::byte> bytes, std::size_t limit_px);

}  // namespace cyclorama
