// SPDX-License-Identifier: Apache-2.0
/// Computes which parts of a picture the heads show, so that the others need not be decoded.
#pragma once

#include <memory>
#include <vector>

#include "appliance/warp/blend_mask.h"
#include "appliance/warp/pixel_map.h"
#include "common/image/pixel_rect.h"

namespace cyclorama::display {

/// The positions that a head lights, in the coordinates of its warp (common/geometry/picture_place.h): the minimum and
/// maximum `across` for each slice of `up`. A value; reentrant.
class HeadFootprint {
 public:
  /// Covers all pixels that the mask does not blacken. Precondition: warp and mask have the same size.
  HeadFootprint(const warp::Warp& warp, const warp::MaskImage& mask);

  struct Span {
    double min = 0.0;
    double max = 0.0;
  };
  /// Range of `up`; empty if the head lights nothing.
  [[nodiscard]] std::optional<Span> up() const;
  /// Range of `across` anywhere between two values of `up`; empty if the head lights nothing there.
  [[nodiscard]] std::optional<Span> across_between(double min_up, double max_up) const;

 private:
  double min_up_ = 0.0;
  double up_per_slice_ = 1.0;
  std::vector<std::optional<Span>> slices_;
};

/// Maximum turn of a picture, and the parts of it that are visible up to that turn.
struct ShownParts {
  double turn_limit_rad = 0.0;
  std::vector<PixelRect> parts;  ///< Whole cells of 16 pixels, cut off at the picture's edges. They do not overlap.

  /// Returns whether any part overlaps `rect`.
  [[nodiscard]] bool meets(const PixelRect& rect) const;
};

/// Returns the parts of a stacked picture for two eyes, each `height_px` high, if the parts of each eye's picture are
/// `of_one`.
[[nodiscard]] ShownParts shown_by_both_eyes(const ShownParts& of_one, int height_px);

/// Returns the parts of a picture that some head shows while the visitor turns either way, with a margin for filters.
/// The turn is limited to where a wall that shows the part `wall` would reach the picture's edge (turn_reach() in
/// common/geometry/guard_band.h). For a picture without edges the limit is half a radian, because a visitor takes
/// longer for that than a farm needs for a frame; there is no limit if all turns together show hardly more, nor with
/// `for_every_turn`, for a picture that perhaps no other follows. A picture that has rows beyond the wall's is for a
/// visitor who walks: the parts then extend by the same number of rows around what the heads show, since the picture
/// may be moved by as much.
[[nodiscard]] ShownParts shown_parts(const std::vector<HeadFootprint>& heads, const PictureShape& picture,
                                     const PictureShape& wall, bool for_every_turn = false);

}  // namespace cyclorama::display
