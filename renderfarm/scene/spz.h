// SPDX-License-Identifier: Apache-2.0
/// SPZ: Gaussian splats in about 10 to 60 bytes each. Source: Niantic, github.com/nianticlabs/spz, versions 2 to 4.
#pragma once

#include <cstddef>
#include <span>

#include "common/base/result.h"
#include "renderfarm/scene/splat_cloud.h"

namespace cyclorama::scene {

/// Returns true if the bytes begin like an SPZ file of version 4, which is not compressed as a whole.
[[nodiscard]] bool is_bare_spz(std::span<const std::byte> bytes);

/// Decodes a file; the y axis of the result points up. Sets `ret_left_out` to the number of invisible splats, which are
/// left out. Errors: kBadData if the file is damaged, of another version, or would need more than `limit_bytes`; a
/// count that the bytes cannot contain is refused before memory is allocated.
Result<SplatCloud> decode_spz(std::span<const std::byte> spz, std::size_t limit_bytes, std::size_t* ret_left_out);

}  // namespace cyclorama::scene
