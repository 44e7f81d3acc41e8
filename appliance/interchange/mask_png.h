// SPDX-License-Identifier: Apache-2.0
/// Masks as PNG in 8 or 16 bits, without loss.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "appliance/interchange/warp_set.h"

namespace cyclorama::interchange {

/// Any PNG: grey and colour keep their bits (fewer than 8 become 8); an alpha channel is dropped, a palette becomes
/// colour. Gamma is 1: a PNG's own gamma is not looked at, because no tool of this trade means it.
/// kBadData  what is wrong and what to do; more than `limit_px` pixels are refused before memory is taken. Reentrant.
Result<MaskMap> decode_mask_png(std::span<const std::byte> png, std::size_t limit_px);

/// Grey or colour, in the mask's bits. Precondition: check() finds no fault in the mask.
Result<std::vector<std::byte>> encode_mask_png(const MaskMap& mask);

}  // namespace cyclorama::interchange
