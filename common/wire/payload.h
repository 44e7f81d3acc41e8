// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>

#include "common/wire/view.pb.h"

namespace cyclorama {

/// Returns the size of all that a tile carries: its JPEG and its depth. Limits and statistics of bytes count it.
[[nodiscard]] inline std::size_t payload_bytes(const wire::Tile& tile) {
  return tile.jpeg().size() + tile.depth().size();
}

}  // namespace cyclorama
