// SPDX-License-Identifier: Apache-2.0
/// Reads pictures of light in float, of every supported format; the format is detected by the first bytes, never by the
/// name.
#pragma once

#include <cstddef>
#include <filesystem>
#include <span>

#include "common/base/result.h"
#include "common/image/image.h"

namespace cyclorama {

/// Maximum radiance of a texel. A photographed sun is about 1e9 times as bright as its sky; sums over whole pictures
/// remain far within float's range.
inline constexpr float kMaxRadiance = 1e9f;
/// Maximum of a half float. It replaces infinity, since the light of an infinite texel exceeded this maximum.
inline constexpr float kMaxHalf = 65504.0f;

/// Makes a texel's value safe to render with: NaN and negative light become 0, infinity becomes kMaxHalf, and values
/// above kMaxRadiance become kMaxRadiance. Independent of other texels.
[[nodiscard]] constexpr float sane_radiance(float value) {
  if (!(value > 0.0f)) return 0.0f;
  if (value <= kMaxRadiance) return value;
  return value < __builtin_inff() ? kMaxRadiance : kMaxHalf;
}

/// Decodes Radiance HDR, OpenEXR or PFM; all texels pass sane_radiance(). Errors: kBadData if the bytes are damaged,
/// contain more than `limit_px` pixels, or are of another format, with the remedy. Reentrant.
Result<RadianceImage> decode_radiance(std::span<const std::byte> bytes, std::size_t limit_px);
/// Reads a file. Errors: those of decode_radiance(), with the file's name; kNotFound or kSystem if it cannot be read.
Result<RadianceImage> read_radiance(const std::filesystem::path& path, std::size_t limit_px);

}  // namespace cyclorama
