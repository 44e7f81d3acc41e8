// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>

#include "common/wire/view.pb.h"

namespace cyclorama {

/// Returns the size of a tile's payload: its JPEG and its depth. Limits and statistics in bytes use it.
[[nodiscard]] inline std::size_t payload_bytes(const wire::Tile& tile) {
  return tile.jpeg().size() + tile.depth().size();
}

}  // namespace cyclorama
