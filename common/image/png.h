// SPDX-License-Identifier: Apache-2.0
/// PNG with libspng: reads textures, and writes pictures that people look at.
#pragma once

#include <cstddef>
#include <filesystem>
#include <span>
#include <vector>

#include "common/base/result.h"
#include "common/image/image.h"

namespace cyclorama {

/// Decodes any PNG as 8-bit RGBA (16-bit samples are rounded down to 8). Errors: kBadData, which names the fault; more
/// than `limit_px` pixels are refused before allocation. Reentrant.
Result<RgbaImage> decode_png(std::span<const std::byte> png, std::size_t limit_px);

Result<std::vector<std::byte>> encode_png(const RgbImage& image);
/// Writes the whole file or nothing.
Status write_png(const std::filesystem::path& path, const RgbImage& image);

}  // namespace cyclorama
