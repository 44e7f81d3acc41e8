// SPDX-License-Identifier: Apache-2.0
/// KTX 2.0 with Basis Universal: textures of glTF's KHR_texture_basisu. Debian 12 has no library for it.
#pragma once

#include <cstddef>
#include <span>

#include "common/base/result.h"
#include "common/image/image.h"

namespace cyclorama {

/// True if the bytes begin like a KTX 2.0 file.
[[nodiscard]] bool is_ktx2(std::span<const std::byte> bytes);

/// Decodes the largest level of a flat picture in ETC1S (with BasisLZ) or UASTC (plain or with Zstandard). Errors:
/// kBadData if the file is damaged, is of another kind (named), or has more than `limit_px` pixels, which are refused
/// before allocation. Reentrant.
Result<RgbaImage> decode_ktx2(std::span<const std::byte> ktx2, std::size_t limit_px);

}  // namespace cyclorama
