// SPDX-License-Identifier: Apache-2.0
/// A projector's warp as a pair of files: a map as PFM, and a mask as PNG of 16 bits. Game engines and planetarium
/// programs without MPCDI read these.
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <span>

#include "appliance/interchange/warp_set.h"

namespace cyclorama::interchange {

/// Decodes a map of three channels ("PF"), in either byte order, with rows from the bottom. Errors: kBadData with the
/// offset of the fault, also for a grey file. Reentrant.
Result<WarpMap> decode_warp_pfm(std::span<const std::byte> pfm, const WarpLimits& limits = {});

/// Reads one region. Its id is the PFM's name without extension, and its size that of the map. `mask` becomes the
/// alpha, in linear light (gamma 1). Errors: those of check() and the decoders, with the file's name.
Result<WarpRegion> read_warp_pair(const std::filesystem::path& pfm, const std::optional<std::filesystem::path>& mask,
                                  WarpProfile profile, const WarpLimits& limits = {});

/// Writes both files, or only the PFM if the region has no alpha; an existing mask file then stays. Each file is
/// written completely or not at all. A mask of 8 bits, of colour, or with a gamma becomes linear grey in 16 bits.
/// Errors: kInvalidArgument if the region has no map; kSystem with errno.
Status write_warp_pair(const std::filesystem::path& pfm, const std::filesystem::path& mask, const WarpRegion& region);

}  // namespace cyclorama::interchange
