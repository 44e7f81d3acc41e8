// SPDX-License-Identifier: Apache-2.0
/// What stands before the room, and where in it heads and shoulders are.
///
///          ╭─╮    above: empty     A head is known by its surroundings: something, with nothing above and nothing
///     side │h│ side: empty         on one side at least, on something 2.6 times as wide. All boxes are in units
///        ╭─┴─┴─╮                   of the head's width, which is what a depth is read from: heads differ least.
///        │chest│
///
/// Cells count from 0 at the picture's left and upper edge; a cell's middle is at +0.5.
#pragma once

#include <optional>
#include <vector>

#include "common/image/image.h"

namespace cyclorama::tracker {

/// From (left, top) to before (right, bottom).
struct CellBounds {
  int left = 0;
  int top = 0;
  int right = 0;
  int bottom = 0;
  [[nodiscard]] bool contains(int x, int y) const { return x >= left && x < right && y >= top && y < bottom; }
};

enum class LightState {
  kLearning,  ///< Too few pictures yet: the room is being learned.
  kSteady,
  kUnsettled,  ///< Another light was switched on just now, or the lens covered.
  kDark        ///< Noise drowns the room.
};

struct Silhouette {
  Image<float, 1> share;     ///< Of each cell: 0 is the room, 1 is somebody.
  Image<float, 1> contrast;  ///< How much it differs from the room, in grey levels.
  /// How much steeper the picture is than the room there: along somebody's outline positive. Where the room was learned
  /// with somebody in it who has left, the outline is in the room and not in the picture: a ghost, negative.
  Image<float, 1> outline;
  LightState light = LightState::kLearning;
};

/// Where a head may be: the middle of its width, its top, and its width, in cells.
struct HeadCandidate {
  double u = 0.0;
  double top = 0.0;
  double width = 0.0;
  double score = 0.0;  ///< 0 to 1.
};

/// Sums over rectangles in constant time.
class SummedShare {
 public:
  explicit SummedShare(const Image<float, 1>& share);
  /// Mean over a box in cells; outside of the picture there is nobody.
  [[nodiscard]] double mean(double left, double top, double right, double bottom) const;
  [[nodiscard]] int width() const { return width_; }
  [[nodiscard]] int height() const { return height_; }

 private:
  int width_;
  int height_;
  std::vector<double> sums_;
};

/// The best place about `near` (within a width of it and a fifth of its width), or nothing.
[[nodiscard]] std::optional<HeadCandidate> find_head_near(const SummedShare& share, const HeadCandidate& near);
/// Every head with widths from `least` to `most`, the best first, none within another's shoulders.
[[nodiscard]] std::vector<HeadCandidate> find_heads(const SummedShare& share, double min, double max);

/// A head and the body below it, measured along the silhouette's edges to parts of a cell.
struct BodyShape {
  HeadCandidate head;
  double width_deviation = 0.0;  ///< Of the head's width, cells.
  bool has_chest = false;        ///< Else the rest is not known: somebody beside, or no chest in the picture.
  double chest_width = 0.0;      ///< With the arms, cells: a second word on the depth.
  double chest_width_deviation = 0.0;
  double hip_u = 0.0;  ///< Where the body stands, also when it leans, cells.
  double hip_deviation = 0.0;
  double lean_rad = 0.0;  ///< Of hip to head; positive towards smaller u, which is the visitor's right.
  double lean_deviation = 0.0;
  double outline = 0.0;  ///< Mean of Silhouette::outline along the head.
};
/// Nothing when the head has no edges to measure.
[[nodiscard]] std::optional<BodyShape> measured(const Silhouette& silhouette, const HeadCandidate& head);

}  // namespace cyclorama::tracker
