// SPDX-License-Identifier: Apache-2.0
/// Reads pictures of every supported format; the format is detected by the first bytes, never by the name.
#pragma once

#include <cstddef>
#include <filesystem>
#include <span>

#include "common/base/result.h"
#include "common/image/image.h"

namespace cyclorama {

inline constexpr std::size_t kTextureLimitPx = std::size_t{16384} * 16384;
inline constexpr std::size_t kPhotoLimitPx = std::size_t{64} << 20;

/// Decodes PNG, JPEG, WebP or KTX2 (ktx2.h). Errors: kBadData if the bytes are damaged, contain more than `limit_px`
/// pixels, or are of another format (named, with the remedy). Reentrant.
Result<RgbaImage> decode_image(std::span<const std::byte> bytes, std::size_t limit_px);
/// Reads a file. Errors: those of decode_image(), with the file's name.
Result<RgbaImage> read_image(const std::filesystem::path& path, std::size_t limit_px);
/// Reads only the luma of a file (Rec. 601, as in JPEG), for detectors.
Result<GreyImage> read_grey_image(const std::filesystem::path& path, std::size_t limit_px);
[[nodiscard]] RgbImage without_alpha(const RgbaImage& picture);

}  // namespace cyclorama
