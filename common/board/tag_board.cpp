// SPDX-License-Identifier: Apache-2.0
#include "common/board/tag_board.h"

namespace cyclorama {

std::optional<std::array<Eigen::Vector2d, 4>> TagBoard::tag_corners_m(int tag) const {
  int left = tag - first_tag;
  if (left < 0 || left >= tags()) return std::nullopt;
  for (int y = 0; y < rows; ++y) {
    for (int x = 0; x < columns; ++x) {
      if (is_black(x, y) || left-- > 0) continue;
      const Eigen::Vector2d middle = square_m * Eigen::Vector2d(x - 0.5, y - 0.5);
      const double half = 0.5 * tag_m;
      return std::array{Eigen::Vector2d(middle + Eigen::Vector2d(-half, -half)),
                        Eigen::Vector2d(middle + Eigen::Vector2d(half, -half)),
                        Eigen::Vector2d(middle + Eigen::Vector2d(half, half)),
                        Eigen::Vector2d(middle + Eigen::Vector2d(-half, half))};
    }
  }
  return std::nullopt;
}

}  // namespace cyclorama
