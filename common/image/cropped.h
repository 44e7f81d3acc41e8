// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>

#include "common/image/image.h"
#include "common/image/pixel_rect.h"

namespace cyclorama {

/// Returns a copy of one part of a picture. Precondition: the part lies inside the picture. Reentrant.
template <typename T, int Channels>
[[nodiscard]] Image<T, Channels> cropped(const Image<T, Channels>& picture, const PixelRect& part) {
  CHECK(part.x >= 0 && part.y >= 0 && part.width <= picture.width() - part.x &&
        part.height <= picture.height() - part.y);
  Image<T, Channels> result(part.width, part.height);
  if (result.empty()) return result;
  for (int y = 0; y < part.height; ++y) {
    std::copy_n(picture.at(part.x, part.y + y), result.row_values(), result.at(0, y));
  }
  return result;
}

}  // namespace cyclorama
