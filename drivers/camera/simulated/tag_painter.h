// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "common/geometry/rigid_transform.h"
#include "common/image/image.h"
#include "common/room/pinhole.h"

namespace cyclorama {

/// Paints a hand that holds a card with an AprilTag (family tag36h11) as a lens sees it. Each pixel is the mean light
/// over its area and over the moments of the exposure, found by tracing rays back to the card's plane, so edges are
/// anti-aliased without bias. Immutable; reentrant.
class TagPainter {
 public:
  /// The tag's picture comes from libapriltag. Preconditions: id 0 to 586, size_m > 0.
  TagPainter(int id, double size_m);

  /// Paints over `picture` (grey levels, any range), which the lens must match in size. One pose per moment of the
  /// exposure; where the card is behind the lens it is not seen. Precondition: 1, 2, 4 or 8 poses.
  void paint(const std::vector<RigidTransform<frame::Camera, frame::Tag>>& poses, const Pinhole& lens,
             Image<float, 1>* picture) const;

 private:
  /// Grey level at a place of the card's plane, in tag sizes; negative where there is neither card nor hand.
  [[nodiscard]] float grey_at(double x, double y) const;

  double size_m_;
  int cells_ = 0;            ///< Across the bitmap, with its white border.
  double bitmap_width_ = 0;  ///< In tag sizes: the border lies outside of the tag's size.
  std::vector<float> bitmap_;
};

}  // namespace cyclorama
