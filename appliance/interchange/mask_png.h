// SPDX-License-Identifier: Apache-2.0
/// Masks as PNG in 8 or 16 bits, without loss.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "appliance/interchange/warp_set.h"

namespace cyclorama::interchange {

/// Decodes any PNG. Grey and colour keep their bits (fewer than 8 become 8); an alpha channel is dropped; a palette
/// becomes colour. MaskMap::gamma is 1: a gamma in the PNG is ignored, since no calibration tool uses it. Errors:
/// kBadData with fault and remedy; more than `limit_px` pixels are refused before memory is allocated. Reentrant.
Result<MaskMap> decode_mask_png(std::span<const std::byte> png, std::size_t limit_px);

/// Encodes a mask as grey or colour with the mask's bits. Precondition: check() finds no fault in the mask.
Result<std::vector<std::byte>> encode_mask_png(const MaskMap& mask);

}  // namespace cyclorama::interchange
