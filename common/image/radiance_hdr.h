// SPDX-License-Identifier: Apache-2.0
/// Radiance's pictures (.hdr, .pic): three bytes of colour and a common exponent.
/// Source: Ward, "Real Pixels", Graphics Gems II, 1991; Radiance's reference manual, "File Formats".
#pragma once

#include <cstddef>
#include <span>

#include "common/base/result.h"
#include "common/image/image.h"

namespace cyclorama {

/// Linear light; EXPOSURE and COLORCORR are undone, GAMMA and PRIMARIES are not looked at (as others do). Rows coded in
/// either run-length scheme or flat, in any of the eight orientations. A byte c with exponent e is c 2^(e - 136), as
/// most programs have it; texels pass sane_radiance(). What follows the last row is ignored.
/// kBadData  with the byte where it went wrong and the remedy; more than `limit_px` pixels, or more than the bytes
/// could
///           hold, are refused before memory is taken. Reentrant.
Result<RadianceImage> decode_radiance_hdr(std::span<const std::byte> bytes, std::size_t limit_px);

}  // namespace cyclorama
