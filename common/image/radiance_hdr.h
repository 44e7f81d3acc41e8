// SPDX-License-Identifier: Apache-2.0
/// Radiance's pictures (.hdr, .pic): three bytes of colour and a common exponent.
/// Source: Ward, "Real Pixels", Graphics Gems II, 1991; Radiance's reference manual, "File Formats".
#pragma once

#include <cstddef>
#include <span>

#include "common/base/result.h"
#include "common/image/image.h"

namespace cyclorama {

/// Decodes linear light; EXPOSURE and COLORCORR are undone, GAMMA and PRIMARIES are ignored (as by other programs).
/// Rows may be flat or in either run-length scheme, in any of the eight orientations. A byte c with exponent e has the
/// value c 2^(e - 136), as in most programs; texels pass sane_radiance(). Bytes after the last row are ignored. Errors:
/// kBadData with the byte of the fault and the remedy; more than `limit_px` pixels, or more than the bytes could hold,
/// are refused before allocation. Reentrant.
Result<RadianceImage> decode_radiance_hdr(std::span<const std::byte> bytes, std::size_t limit_px);

}  // namespace cyclorama
