// SPDX-License-Identifier: Apache-2.0
/// The parts of KHR_meshopt_compression that the system's meshoptimizer lacks: version 1 of the attribute stream and
/// the filter for colours. Source: appendices A and B of the extension's specification.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace cyclorama::scene {

/// Returns true for a stream of version 1.
[[nodiscard]] bool is_meshopt_attributes_v1(std::span<const std::byte> stored);

/// Decodes a stream of version 1 into count x stride bytes; nothing for a damaged one. Precondition: `stride` is a
/// multiple of 4 from 4 to 256. Reentrant.
[[nodiscard]] std::optional<std::vector<std::byte>> decode_meshopt_attributes_v1(std::span<const std::byte> stored,
                                                                                 std::size_t count, std::size_t stride);

/// Turns luma, chroma and alpha into RGBA, in place. Precondition: `stride` is 4 or 8, for components of 8 or 16 bits,
/// and `bytes` are whole elements.
void apply_meshopt_colour_filter(std::size_t stride, std::span<std::byte> bytes);

}  // namespace cyclorama::scene
