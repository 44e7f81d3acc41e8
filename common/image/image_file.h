// SPDX-License-Identifier: Apache-2.0
/// A picture of whatever format we read, told by its first bytes and never by its name.
#pragma once

#include <cstddef>
#include <filesystem>
#include <span>

#include "common/base/result.h"
#include "common/image/image.h"

namespace cyclorama {

inline constexpr std::size_t kTextureLimitPx = std::size_t{16384} * 16384;
inline constexpr std::size_t kPhotoLimitPx = std::size_t{64} << 20;

/// PNG or JPEG. kBadData  damaged, larger than `limit_px`, or another format (named, with the remedy). Reentrant.
Result<RgbaImage> decode_image(std::span<const std::byte> bytes, std::size_t limit_px);
/// As decode_image(); errors name the file.
Result<RgbaImage> read_image(const std::filesystem::path& path, std::size_t limit_px);
/// Luma (Rec. 601, as JPEG's own), for detectors.
Result<GreyImage> read_grey_image(const std::filesystem::path& path, std::size_t limit_px);
[[nodiscard]] RgbImage without_alpha(const RgbaImage& picture);

}  // namespace cyclorama
