// SPDX-License-Identifier: Apache-2.0
/// UASTC LDR 4x4: blocks of 4x4 pixels in 16 bytes, a subset of ASTC with fields of its own. Source: Khronos Data
/// Format 1.3, "UASTC Compressed Texture Image Format".
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

namespace cyclorama {

inline constexpr std::size_t kUastcBlockBytes = 16;

/// RGBA of the 16 pixels, in rows.
using UastcPixels = std::array<std::array<std::uint8_t, 4>, 16>;

/// Decodes one block; empty if its bits have no meaning. Precondition: `block` has kUastcBlockBytes bytes. Reentrant.
[[nodiscard]] std::optional<UastcPixels> decode_uastc(std::span<const std::byte> block);

}  // namespace cyclorama
