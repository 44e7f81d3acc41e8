// SPDX-License-Identifier: Apache-2.0
/// PFM ("portable float map"): linear light in float, exactly. For comparing pictures, between our tools and others'.
/// Source: Debevec, "PFM Portable FloatMap Image Format", www.pauldebevec.com/Research/HDR/PFM.
#pragma once

#include <cstddef>
#include <filesystem>
#include <span>
#include <vector>

#include "common/base/result.h"
#include "common/image/image.h"

namespace cyclorama {

/// Colour ("PF") or grey ("Pf", which becomes three equal channels), of either byte order; the size of the scale is
/// ignored, as others do. Values come as they are, NaN and infinities too: whoever compares must see them.
/// kBadData  with the byte where it went wrong; more than `limit_px` pixels are refused before memory is taken.
/// Reentrant.
Result<RadianceImage> decode_pfm(std::span<const std::byte> pfm, std::size_t limit_px);
/// As decode_pfm(); errors name the file.
Result<RadianceImage> read_pfm(const std::filesystem::path& path, std::size_t limit_px);

/// Little-endian, scale 1. Precondition: not empty.
[[nodiscard]] std::vector<std::byte> encode_pfm(const RadianceImage& image);
/// Written whole or not at all. kInvalidArgument  the picture is empty.     kSystem  errno says why.
Status write_pfm(const std::filesystem::path& path, const RadianceImage& image);

}  // namespace cyclorama
