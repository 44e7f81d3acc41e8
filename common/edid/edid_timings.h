// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "common/edid/video_timing.h"

namespace cyclorama {

inline constexpr std::size_t kEdidBlock = 128;
inline constexpr std::size_t kEdidDescriptor = 18;

/// Returns the timings of an EDID as Edid::timings states them. Precondition: at least one whole block.
[[nodiscard]] std::vector<VideoTiming> edid_timings(std::span<const std::uint8_t> bytes);

}  // namespace cyclorama
