// SPDX-License-Identifier: Apache-2.0
/// What a camera's lens is calibrated with: a chessboard whose white squares hold tags (what OpenCV calls ChArUco), so
/// that a part of it is enough and its corners are known by number, also at the picture's rim.
///
///     ■ 1 ■ 2 ■      the tags are of the family tag36h11, numbered row by row; corners are where four squares meet,
///     3 ■ 4 ■ 5      row by row likewise
///     ■ 6 ■ 7 ■      x right, y down, as seen from the front; origin at the first corner, z into the board
#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>

namespace cyclorama {

/// Lengths on paper. A value.
struct TagBoard {
  int columns = 11;  ///< Of squares.
  int rows = 7;
  double square_m = 0.024;
  double tag_m = 0.018;  ///< Edge of a tag's black square.
  int first_tag = 549;   ///< The last 38 of the family: only wands from number 183 on have them too.

  [[nodiscard]] int corners() const { return (columns - 1) * (rows - 1); }
  [[nodiscard]] Eigen::Vector2d corner_m(int index) const {
    return square_m * Eigen::Vector2d(index % (columns - 1), index / (columns - 1));
  }
  /// Of the square in column `x`, row `y`.
  [[nodiscard]] static bool is_black(int x, int y) { return (x + y) % 2 == 0; }
  [[nodiscard]] int tags() const { return columns * rows / 2; }
  /// Corners of a tag's black square: left above, right above, right below, left below. Nothing for a strange tag.
  [[nodiscard]] std::optional<std::array<Eigen::Vector2d, 4>> tag_corners_m(int tag) const;
  /// The same board, all lengths times `scale`.
  [[nodiscard]] TagBoard scaled(double scale) const {
    return {columns, rows, scale * square_m, scale * tag_m, first_tag};
  }
};

}  // namespace cyclorama
