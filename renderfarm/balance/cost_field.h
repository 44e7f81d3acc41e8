// SPDX-License-Identifier: Apache-2.0
/// What each part of a picture is expected to cost.
#pragma once

#include <span>
#include <vector>

#include "common/image/pixel_rect.h"

namespace cyclorama {

struct PictureSize {
  int width = 0;
  int height = 0;
  friend bool operator==(const PictureSize&, const PictureSize&) = default;
};

/// A block and what it cost: thread time in seconds.
struct MeasuredBlock {
  PixelRect rect;
  double cpu_seconds = 0.0;
  /// Of each kCutPx cell of the picture's grid that the rect touches, row by row; empty when the node did not tell.
  std::vector<float> cell_cpu_seconds{};
  double speed = 1.0;  ///< Of the node that rendered it, as in SplitRequest.
};

/// Rectangle in fractions of the picture, so that a field serves pictures of any size.
struct FractionRect {
  double x0 = 0.0;
  double y0 = 0.0;
  double x1 = 1.0;
  double y1 = 1.0;
};

/// Cost per area on a fixed grid. A block's measured time scales the cells inside it, so that their sum is what was
/// measured and their contrast is what earlier, differently cut blocks taught, slowly forgotten. The prediction binary
/// tree's own rule, one density per leaf, swings to and fro where a leaf holds both a relic and the void around it: .70
/// efficiency after ten frames at 8 nodes where this has .93 (balancer_test.cpp, `relic`). A value; reentrant.
/// Invariant: every density is finite and above zero, so that every cut has an answer.
class CostField {
 public:
  /// The same everywhere.
  CostField();

  /// Takes in what the blocks of one picture cost. Times that are no measurement (NaN, infinite, negative) are ignored;
  /// a block without cost counts a little, as its neighbours may grow into it.
  void learn(PictureSize size, std::span<const MeasuredBlock> blocks);
  /// The field after the picture's content has moved to the left by `fraction` of the width (the visitor turned to the
  /// right). What comes in at an edge costs as the edge did. Not finite: stays.
  [[nodiscard]] CostField shifted_left(double fraction) const;

  /// Of a part of the picture; parts outside cost nothing. The whole costs about 1.
  [[nodiscard]] double cost_of(const FractionRect& rect) const;

 private:
  void normalise();
  [[nodiscard]] double cost_up_to(double x, double y) const;

  std::vector<double> density_;  ///< Row by row.
  std::vector<double> sums_;     ///< Of all cells above and to the left; one row and column more.
};

[[nodiscard]] FractionRect fractions_of(const PixelRect& rect, PictureSize size);

}  // namespace cyclorama
