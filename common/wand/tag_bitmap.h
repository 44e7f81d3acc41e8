// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

namespace cyclorama {

/// The picture of one tag of the family tag36h11, white border included, for printers and painters.
struct TagBitmap {
  int cells = 0;             ///< Across the picture: 10.
  double width_in_tags = 0;  ///< Of the picture, in edges of the black square: 1.25.
  std::vector<bool> white;   ///< Row by row from above.

  [[nodiscard]] bool is_white(int x, int y) const { return white[static_cast<std::size_t>(y * cells + x)]; }
};

inline constexpr int kBitmaps = 587;

/// Precondition: id is 0 to kBitmaps - 1.
[[nodiscard]] TagBitmap tag_bitmap(int id);

}  // namespace cyclorama
