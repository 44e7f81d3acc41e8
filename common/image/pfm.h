// SPDX-License-Identifier: Apache-2.0
/// PFM ("portable float map"): linear light in float, exactly. Used to compare pictures between this project's programs
/// and others. Source: Debevec, "PFM Portable FloatMap Image Format", www.pauldebevec.com/Research/HDR/PFM.
#pragma once

#include <cstddef>
#include <filesystem>
#include <span>
#include <vector>

#include "common/base/result.h"
#include "common/image/image.h"

namespace cyclorama {

/// Decodes colour ("PF") or grey ("Pf", which becomes three equal channels), in either byte order; the magnitude of the
/// scale is ignored, as by other programs. Values are unchanged, including NaN and infinities, so that comparisons see
/// them. Errors: kBadData with the byte of the fault; more than `limit_px` pixels are refused before allocation.
/// Reentrant.
Result<RadianceImage> decode_pfm(std::span<const std::byte> pfm, std::size_t limit_px);
/// Reads a file. Errors: those of decode_pfm(), with the file's name.
Result<RadianceImage> read_pfm(const std::filesystem::path& path, std::size_t limit_px);

/// Encodes as little-endian with scale 1. Precondition: the picture is not empty.
[[nodiscard]] std::vector<std::byte> encode_pfm(const RadianceImage& image);
/// Writes the whole file or nothing. Errors: kInvalidArgument if the picture is empty; kSystem with errno.
Status write_pfm(const std::filesystem::path& path, const RadianceImage& image);

}  // namespace cyclorama
