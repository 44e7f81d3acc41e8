// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "appliance/tracker/markerless/silhouette.h"
#include "common/base/clock.h"
#include "common/image/image.h"

namespace cyclorama::tracker {

struct BackgroundSettings {
  /// Pictures are reduced to about this many cells across; a cell is the mean of its pixels.
  int cells_across = 160;
  Duration learns_for = std::chrono::milliseconds(1500);  ///< Duration of learning at the start.
  Duration follows_in = std::chrono::seconds(20);  ///< Time constant with which changes of the room are followed.
  /// Something that stands still for this long becomes part of the room.
  Duration absorbs_after = std::chrono::seconds(20);
};

/// The room without visitors, learned from grey pictures. It finds the parts of a picture that differ from the room.
///
///   picture ─▶ cells ─▶ minus change of light ─▶ compared to each cell's mean and deviation ─▶ Silhouette
///                          (light_fit.h)                     ▲ learned where nobody stands
///
/// A change of the whole room is a change of light; a change of only a part is a person. If no single change of light
/// explains enough of the room, another lamp was switched on: this picture gives no silhouette, and the room is learned
/// again from it, except around the visitor of the picture before. Ghosts, left by a person who stood there while the
/// room was learned, fade after `absorbs_after`. Thread-bound; the same pictures give the same silhouettes.
class Background {
 public:
  explicit Background(const BackgroundSettings& settings) : settings_(settings) {}

  /// Returns the silhouette of `picture`, taken at `at`; valid until the next call. The room is not learned within
  /// `visitor`, where a person is known to stand. A picture of another size, or a jump in time of more than 5 s,
  /// restarts the learning.
  const Silhouette& update(const GreyImage& picture, TimePoint at, const std::optional<CellBounds>& visitor);
  [[nodiscard]] const Silhouette& silhouette() const { return silhouette_; }
  /// Returns the side of a cell in pixels, for pictures of `width_px`.
  [[nodiscard]] int cell_px(int width_px) const;

 private:
  struct Cell {
    float mean = 0.0f;      ///< Logarithm of the brightness, relative to the light at the start.
    float variance = 0.0f;  ///< Variance of that logarithm from picture to picture.
    float seen = 0.0f;      ///< Number of pictures that the cell was learned from.
    float held = 0.0f;      ///< Value that the cell has shown for `still_s`; for ghosts and chairs.
    float still_s = 0.0f;
  };
  void begin(int width, int height, TimePoint at);
  void reduce(const GreyImage& picture);
  /// True if enough of the room is explained by one change of light.
  bool follow_light(const std::optional<CellBounds>& visitor);
  void learn_anew(const std::optional<CellBounds>& visitor);
  void compare(double seconds, const std::optional<CellBounds>& visitor);
  void outline();

  BackgroundSettings settings_;
  Silhouette silhouette_;
  std::vector<Cell> cells_;
  Image<float, 1> grey_;   ///< Brightness of the picture's cells.
  Image<float, 1> level_;  ///< Logarithm of grey_; from follow_light() on, without the room's change of light.
  double noise_ = 0.0;     ///< Median over the cells of the deviation of level_ from picture to picture.
  std::optional<TimePoint> last_at_;
  TimePoint learning_since_{};
};

}  // namespace cyclorama::tracker
