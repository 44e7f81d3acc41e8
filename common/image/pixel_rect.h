// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <compare>
#include <cstdint>

namespace cyclorama {

/// A part of a picture, in whole pixels from its upper left corner. A value.
struct PixelRect {
  int x = 0;
  int y = 0;
  int width = 0;
  int height = 0;

  [[nodiscard]] bool empty() const { return width <= 0 || height <= 0; }
  [[nodiscard]] std::int64_t area() const { return empty() ? 0 : std::int64_t{width} * height; }
  friend auto operator<=>(const PixelRect&, const PixelRect&) = default;
};

}  // namespace cyclorama
