// SPDX-License-Identifier: Apache-2.0
/// A picture of light in float, of whatever format we read, told by its first bytes and never by its name.
#pragma once

#include <cstddef>
#include <filesystem>
#include <span>

#include "common/base/result.h"
#include "common/image/image.h"

namespace cyclorama {

/// A photographed sun is some 1e9 times as bright as its sky; sums over whole pictures stay far inside of float.
inline constexpr float kMaxRadiance = 1e9f;
/// What half floats can say: an infinite texel of a picture was brighter than that.
inline constexpr float kMaxHalf = 65504.0f;

/// A texel's value that can be rendered with: NaN and negative light are 0, infinity is kMaxHalf, and what is brighter
/// than kMaxRadiance is kMaxRadiance. No neighbour has a say.
[[nodiscard]] constexpr float sane_radiance(float value) {
  if (!(value > 0.0f)) return 0.0f;
  if (value <= kMaxRadiance) return value;
  return value < __builtin_inff() ? kMaxRadiance : kMaxHalf;
}

/// Radiance HDR, OpenEXR or PFM; all texels pass sane_radiance(). kBadData  damaged, larger than `limit_px`, or another
/// format, with the remedy. Reentrant.
Result<RadianceImage> decode_radiance(std::span<const std::byte> bytes, std::size_t limit_px);
/// As decode_radiance(); errors name the file. kNotFound, kSystem  the file cannot be read.
Result<RadianceImage> read_radiance(const std::filesystem::path& path, std::size_t limit_px);

}  // namespace cyclorama
