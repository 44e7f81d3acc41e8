// SPDX-License-Identifier: Apache-2.0
/// Board for calibrating a camera's lens: a chessboard with tags in its white squares (ChArUco in OpenCV). A visible
/// part of the board is enough, even at the picture's edge, since the tags identify its corners.
///
///     ■ 1 ■ 2 ■      Tags are of the family tag36h11, numbered row by row. Corners, where four squares meet, are also
///     3 ■ 4 ■ 5      numbered row by row. x right, y down, as seen from the front; origin at the first corner; z into
///     ■ 6 ■ 7 ■      the board.
#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>

namespace cyclorama {

/// Dimensions of a board, with lengths as printed. A value.
struct TagBoard {
  int columns = 11;  ///< Number of squares in a row.
  int rows = 7;
  double square_m = 0.024;
  double tag_m = 0.018;  ///< Edge of a tag's black square.
  int first_tag = 549;   ///< The last 38 tags of the family, which only wands from number 183 on also use.

  [[nodiscard]] int corners() const { return (columns - 1) * (rows - 1); }
  [[nodiscard]] Eigen::Vector2d corner_m(int index) const {
    return square_m * Eigen::Vector2d(index % (columns - 1), index / (columns - 1));
  }
  /// True if the square in column `x`, row `y` is black.
  [[nodiscard]] static bool is_black(int x, int y) { return (x + y) % 2 == 0; }
  [[nodiscard]] int tags() const { return columns * rows / 2; }
  /// Returns the corners of a tag's black square: upper left, upper right, lower right, lower left. Empty for a tag
  /// that is not on the board.
  [[nodiscard]] std::optional<std::array<Eigen::Vector2d, 4>> tag_corners_m(int tag) const;
  /// Returns the same board with all lengths multiplied by `scale`.
  [[nodiscard]] TagBoard scaled(double scale) const {
    return {columns, rows, scale * square_m, scale * tag_m, first_tag};
  }
};

}  // namespace cyclorama
