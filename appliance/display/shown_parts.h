// SPDX-License-Identifier: Apache-2.0
/// Which parts of a panorama the heads show, so that the others need not be decoded.
#pragma once

#include <memory>
#include <vector>

#include "appliance/warp/blend_mask.h"
#include "appliance/warp/pixel_map.h"
#include "common/image/pixel_rect.h"

namespace cyclorama {

/// The directions that a head lights: for each of some slices of the tangent of elevation, the least and the most
/// azimuth. A value; reentrant.
class HeadFootprint {
 public:
  /// Of all pixels that the mask does not blacken. Precondition: warp and mask have one size.
  HeadFootprint(const Warp& warp, const MaskImage& mask);

  struct Span {
    double least_rad = 0.0;
    double most_rad = 0.0;
  };
  /// Of azimuths anywhere between two tangents of elevation; nothing where the head lights none.
  [[nodiscard]] std::optional<Span> azimuths_between(double least_tan, double most_tan) const;

 private:
  double least_tan_ = 0.0;
  double tan_per_slice_ = 1.0;
  std::vector<std::optional<Span>> slices_;
};

/// How far a picture may be turned, and what of it is then seen.
struct ShownParts {
  double reach_rad = 0.0;
  std::vector<PixelRect> parts;  ///< Whole cells of 16 pixels, cut at the picture's edges; none overlap.

  /// Whether any part meets this one.
  [[nodiscard]] bool meets(const PixelRect& rect) const;
};

/// How far a picture can be turned before a wall that shows `shown_span_rad` of it sees its edge. A picture of a whole
/// turn has none; there it is half a radian, for which a visitor takes longer than a farm.
[[nodiscard]] double turn_reach(const Panorama& picture, double shown_span_rad);

/// What some head shows of a picture while the visitor turns within turn_reach(), with what filters need around it.
[[nodiscard]] ShownParts shown_parts(const std::vector<HeadFootprint>& heads, const Panorama& picture,
                                     double shown_span_rad);

}  // namespace cyclorama
