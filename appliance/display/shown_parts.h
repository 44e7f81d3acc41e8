// SPDX-License-Identifier: Apache-2.0
/// Which parts of a picture the heads show, so that the others need not be decoded.
#pragma once

#include <memory>
#include <vector>

#include "appliance/warp/blend_mask.h"
#include "appliance/warp/pixel_map.h"
#include "common/image/pixel_rect.h"

namespace cyclorama::display {

/// The places that a head lights, as its warp names them (common/geometry/picture_place.h): for each of some slices of
/// `up`, the least and the most `across`. A value; reentrant.
class HeadFootprint {
 public:
  /// Of all pixels that the mask does not blacken. Precondition: warp and mask have one size.
  HeadFootprint(const warp::Warp& warp, const warp::MaskImage& mask);

  struct Span {
    double min = 0.0;
    double max = 0.0;
  };
  /// Of `up`, from the lowest to the highest; nothing when the head lights nothing.
  [[nodiscard]] std::optional<Span> up() const;
  /// Of `across` anywhere between two values of `up`; nothing where the head lights none.
  [[nodiscard]] std::optional<Span> across_between(double min_up, double max_up) const;

 private:
  double min_up_ = 0.0;
  double up_per_slice_ = 1.0;
  std::vector<std::optional<Span>> slices_;
};

/// How far a picture may be turned, and what of it is then seen.
struct ShownParts {
  double turn_limit_rad = 0.0;
  std::vector<PixelRect> parts;  ///< Whole cells of 16 pixels, cut at the picture's edges; none overlap.

  /// Whether any part meets this one.
  [[nodiscard]] bool meets(const PixelRect& rect) const;
};

/// Of two pictures of that height one above the other, of both of which the heads show the same.
[[nodiscard]] ShownParts shown_by_both_eyes(const ShownParts& of_one, int height_px);

/// What some head shows of a picture while the visitor turns either way before a wall that shows `wall` of it sees its
/// edge (turn_reach() in common/geometry/guard_band.h), with what filters need around it. Where it has no edge, it is
/// half a radian, for which a visitor takes longer than a farm; or without end, where hardly more is seen by that.
[[nodiscard]] ShownParts shown_parts(const std::vector<HeadFootprint>& heads, const PictureShape& picture,
                                     const PictureShape& wall);

}  // namespace cyclorama::display
