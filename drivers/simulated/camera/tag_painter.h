// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <vector>

#include "common/geometry/rigid_transform.h"
#include "common/image/image.h"
#include "common/room/pinhole.h"
#include "common/wand/wand.h"

namespace cyclorama::simulated {

/// Paints a hand that holds a wand, or a card with one tag (family tag36h11), as a lens sees it. Each pixel is the mean
/// light over its area and over the moments of the exposure, found by tracing rays back to the panels' planes, so edges
/// are anti-aliased without bias. Immutable; reentrant.
class TagPainter {
 public:
  /// A panel of paper around each of the wand's tags; with one tag alone, the hand holds its panel's lower edge.
  /// Precondition: tags 0 to 586.
  explicit TagPainter(const Wand& wand);
  /// Preconditions: id 0 to 586, size_m > 0.
  TagPainter(int id, double size_m) : TagPainter(flat_tag(id, size_m)) {}

  /// Paints over `picture` (grey levels, any range), which the lens must match in size. One pose per moment of the
  /// exposure; where the wand is behind the lens it is not seen. Precondition: 1, 2, 4 or 8 poses.
  void paint(const std::vector<RigidTransform<frame::Camera, frame::Tag>>& poses, const Pinhole& lens,
             Image<float, 1>* picture) const;

 private:
  /// A flat part of the scene, in a plane of its own; lengths on it in `unit_m`.
  struct Panel {
    RigidTransform<frame::Tag, frame::Face> T_tag_face;
    double unit_m = 0.0;
    double half = 0.0;  ///< Of the paper, about the tag.
    Eigen::AlignedBox2d box;
    int cells = 0;              ///< Across the bitmap, with its white border; 0 for the hand.
    double bitmap_width = 0.0;  ///< In tag sizes: the border lies outside of the tag's size.
    std::vector<float> bitmap;
    bool has_thumb = false;

    /// Grey level at a place of the plane; negative where there is nothing.
    [[nodiscard]] float grey_at(double x, double y) const;
  };
  std::vector<Panel> panels_;
};

}  // namespace cyclorama::simulated
