// SPDX-License-Identifier: Apache-2.0
/// PNG by libspng: textures in, pictures for people out.
#pragma once

#include <cstddef>
#include <filesystem>
#include <span>
#include <vector>

#include "common/base/result.h"
#include "common/image/image.h"

namespace cyclorama {

/// Any PNG, as 8-bit RGBA (16-bit files are rounded down to 8). kBadData says what is wrong; refuses more than
/// `limit_px` pixels before it allocates. Reentrant.
Result<RgbaImage> decode_png(std::span<const std::byte> png, std::size_t limit_px);

Result<std::vector<std::byte>> encode_png(const RgbImage& image);
/// Written whole or not at all.
Status write_png(const std::filesystem::path& path, const RgbImage& image);

}  // namespace cyclorama
