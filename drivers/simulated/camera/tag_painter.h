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
/// light over its area and over the moments of the exposure, found by tracing rays back to the planes of the panels, so
/// that edges are anti-aliased without bias. Immutable; reentrant.
class TagPainter {
 public:
  /// Makes a paper panel around each of the wand's tags; a hand holds the lower edge of a single tag's panel.
  /// Precondition: tag ids are 0 to 586.
  explicit TagPainter(const Wand& wand);
  /// Preconditions: id 0 to 586, size_m > 0.
  TagPainter(int id, double size_m) : TagPainter(flat_tag(id, size_m)) {}

  /// Paints over `picture` (grey levels, any range), whose size must match the lens. `poses` has one pose per moment of
  /// the exposure; a wand behind the lens is invisible. Precondition: 1, 2, 4 or 8 poses.
  void paint(const std::vector<RigidTransform<frame::Camera, frame::Tag>>& poses, const Pinhole& lens,
             Image<float, 1>* picture) const;

 private:
  /// A flat part of the scene in its own plane; lengths on it are in units of `unit_m`.
  struct Panel {
    RigidTransform<frame::Tag, frame::Face> T_tag_face;
    double unit_m = 0.0;
    double half = 0.0;  ///< Half the side of the paper square, centred on the tag.
    Eigen::AlignedBox2d box;
    int cells = 0;              ///< Cells across the bitmap, including its white border; 0 for the hand.
    double bitmap_width = 0.0;  ///< Width in tag sizes, including the border, which lies outside the tag's size.
    std::vector<float> bitmap;
    bool has_thumb = false;

    /// Grey level at a point of the plane; negative outside the panel.
    [[nodiscard]] float grey_at(double x, double y) const;
  };
  std::vector<Panel> panels_;
};

}  // namespace cyclorama::simulated
