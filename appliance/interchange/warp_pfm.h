// SPDX-License-Identifier: Apache-2.0
/// The plainest exchange of a projector's warp: a map as PFM, and a mask as PNG of 16 bits beside it. Game engines and
/// planetarium programs read these without MPCDI around them.
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <span>

#include "appliance/interchange/warp_set.h"

namespace cyclorama::interchange {

/// A map of three channels ("PF"), either byte order, rows from the bottom. kBadData  with the byte where it went
/// wrong, also for a grey file. Reentrant.
Result<WarpMap> decode_warp_pfm(std::span<const std::byte> pfm, const WarpLimits& limits = {});

/// One region, its id the PFM's name without its ending, of the map's size. `mask` becomes its alpha: light in linear
/// values (gamma 1). Errors as check() and the decoders', naming the file.
Result<WarpRegion> read_warp_pair(const std::filesystem::path& pfm, const std::optional<std::filesystem::path>& mask,
                                  WarpProfile profile, const WarpLimits& limits = {});

/// Both files, or no mask where the region has none (one that lies there stays). Each is written whole or not at all.
/// A mask of 8 bits, of colour, or with a gamma becomes linear grey in 16 bits.
/// kInvalidArgument  the region has no map.     kSystem  errno says why.
Status write_warp_pair(const std::filesystem::path& pfm, const std::filesystem::path& mask, const WarpRegion& region);

}  // namespace cyclorama::interchange
