// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

namespace cyclorama {

/// The picture of one tag of the family tag36h11, including its white border, for printing and rendering.
struct TagBitmap {
  int cells = 0;             ///< Cells across the picture: 10.
  double width_in_tags = 0;  ///< Width of the picture in edges of the black square: 1.25.
  std::vector<bool> white;   ///< True for a white cell; row by row from the top.

  [[nodiscard]] bool is_white(int x, int y) const { return white[static_cast<std::size_t>(y * cells + x)]; }
};

inline constexpr int kBitmaps = 587;

/// Returns the picture of a tag. Precondition: `id` is 0 to kBitmaps - 1.
[[nodiscard]] TagBitmap tag_bitmap(int id);

}  // namespace cyclorama
