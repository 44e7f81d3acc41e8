// SPDX-License-Identifier: Apache-2.0
/// SPZ: Gaussian splats in about 10 to 60 bytes each. Source: Niantic, github.com/nianticlabs/spz, versions 2 to 4.
#pragma once

#include <cstddef>
#include <span>

#include "common/base/result.h"
#include "renderfarm/scene/splat_cloud.h"

namespace cyclorama::scene {

/// True if the bytes begin as an SPZ file does that is not compressed as a whole: version 4.
[[nodiscard]] bool is_bare_spz(std::span<const std::byte> bytes);

/// Decodes a file. The y axis points up. Errors: kBadData if it is damaged, of another version, or would need more than
/// `limit_bytes`; a count that the bytes cannot hold is refused before memory is taken.
/// `ret_left_out` becomes the number of splats that cannot be seen.
Result<SplatCloud> decode_spz(std::span<const std::byte> spz, std::size_t limit_bytes, std::size_t* ret_left_out);

}  // namespace cyclorama::scene
