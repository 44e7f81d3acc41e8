// SPDX-License-Identifier: Apache-2.0
/// The parts of a picture that are in front of the room, and the heads and shoulders among them.
///
///          ╭─╮    above: empty     A head is detected by its surroundings: it is filled, with nothing above, nothing
///     side │h│ side: empty         on at least one side, and something 2.6 times as wide below. Depth is computed from
///        ╭─┴─┴─╮                   the head's width, since it differs least between people. Boxes are in head widths.
///        │chest│
///
/// Cells count from 0 at the picture's left and upper edge; a cell's middle is at +0.5.
#pragma once

#include <optional>
#include <vector>

#include "common/image/image.h"

namespace cyclorama::tracker {

/// A half-open rectangle: (left, top) inclusive, (right, bottom) exclusive.
struct CellBounds {
  int left = 0;
  int top = 0;
  int right = 0;
  int bottom = 0;
  [[nodiscard]] bool contains(int x, int y) const { return x >= left && x < right && y >= top && y < bottom; }
};

enum class LightState {
  kLearning,  ///< There were too few pictures yet; the room is being learned.
  kSteady,
  kUnsettled,  ///< A lamp was just switched on, or the lens is covered.
  kDark        ///< Noise hides the room.
};

struct Silhouette {
  Image<float, 1> share;     ///< For each cell: 0 is the room, 1 is a person.
  Image<float, 1> contrast;  ///< Difference from the room in grey levels.
  /// Difference of the picture's gradient from the room's: positive along a person's outline. Negative along a ghost's:
  /// the outline of a person who stood there while the room was learned, and has left since.
  Image<float, 1> outline;
  LightState light = LightState::kLearning;
};

/// A possible head: the middle of its width, its top, and its width, in cells.
struct HeadCandidate {
  double u = 0.0;
  double top = 0.0;
  double width = 0.0;
  double score = 0.0;  ///< In [0, 1].
};

/// Sums of `share` over rectangles, in constant time.
class SummedShare {
 public:
  explicit SummedShare(const Image<float, 1>& share);
  /// Returns the mean over a box in cells; the area outside of the picture counts as empty.
  [[nodiscard]] double mean(double left, double top, double right, double bottom) const;
  [[nodiscard]] int width() const { return width_; }
  [[nodiscard]] int height() const { return height_; }

 private:
  int width_;
  int height_;
  std::vector<double> sums_;
};

/// Returns the best head near `near` (within a head's width, and with a width that differs by less than a fifth); empty
/// if there is none.
[[nodiscard]] std::optional<HeadCandidate> find_head_near(const SummedShare& share, const HeadCandidate& near);
/// Returns all heads with widths from `min` to `max`, the best first, none within another head's shoulders.
[[nodiscard]] std::vector<HeadCandidate> find_heads(const SummedShare& share, double min, double max);

/// A head and the body below it, measured along the silhouette's edges to fractions of a cell.
struct BodyShape {
  HeadCandidate head;
  double width_deviation = 0.0;  ///< Standard deviation of the head's width, in cells.
  /// False: the members below are unknown, since another person is beside, or the chest is not in the picture.
  bool has_chest = false;
  double chest_width = 0.0;  ///< Width including the arms, in cells: a second measure of depth.
  double chest_width_deviation = 0.0;
  double hip_u = 0.0;  ///< Position of the hip, in cells; also valid while the body leans.
  double hip_deviation = 0.0;
  double lean_rad = 0.0;  ///< Angle from hip to head; positive towards smaller u, which is the visitor's right.
  double lean_deviation = 0.0;
  double outline = 0.0;  ///< Mean of Silhouette::outline along the head.
};
/// Returns the shape below `head`; empty if the head has no edges to measure.
[[nodiscard]] std::optional<BodyShape> measured(const Silhouette& silhouette, const HeadCandidate& head);

}  // namespace cyclorama::tracker
