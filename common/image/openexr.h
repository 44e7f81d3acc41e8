// SPDX-License-Identifier: Apache-2.0
/// OpenEXR by its own library: what panoramas of light are photographed and traded as.
#pragma once

#include <cstddef>
#include <span>

#include "common/base/result.h"
#include "common/image/image.h"

namespace cyclorama {

/// The channels R, G and B, or Y alone (grey), of a file with one part, whole (its data window fills its display
/// window), of any compression, in rows or tiles; of tiles in several sizes the largest. Linear light; texels pass
/// sane_radiance().
/// kBadData  damaged or cut short, another layout than this (named, with the remedy), or more than `limit_px` pixels,
///           which are refused before memory is taken for them. Reentrant.
Result<RadianceImage> decode_openexr(std::span<const std::byte> bytes, std::size_t limit_px);

}  // namespace cyclorama
