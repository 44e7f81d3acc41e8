// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "appliance/photometry/inverse_map.h"
#include "appliance/photometry/photometry_input.h"
#include "appliance/warp/blend_mask.h"

namespace cyclorama::photometry {

/// Blend of several measured projectors in each direction. A picture fades only towards the parts of its sides that lie
/// on another picture:
///
///      ┌─────────────┐   A       A fades towards the covered part of its lower and right sides, B towards that of its
///      │        ┌────┼──────┐    upper and left sides. Where the sides of two pictures cross at the rim of the lit
///      └────────┼────┘      │ B  area (twice here), all weights meet in a point: near it they depend only on the
///               └───────────┘    distances to the sides, and do not jump within the few pixels by which one picture
///                                extends beyond another.
///
/// A picture also fades where its map ends inside another picture, as when a column hides the wall. weight_i = r_i /
/// sum of r. Here r is the square of the product of t (2 - t) over the sides, and t the distance from a side's covered
/// parts in half pictures, at most 1, as in blend_weights() of appliance/warp. Reentrant; borrows the inverse maps.
class BlendWeights {
 public:
  BlendWeights(const std::vector<PhotometricProjector>& projectors, const std::vector<InverseMap>& inverses);

  struct Share {
    std::size_t projector = 0;
    Eigen::Vector2d pixel;
    double weight = 0.0;
  };
  /// Returns the shares of all projectors that light this direction; their weights add up to 1. Empty if no projector
  /// lights it.
  [[nodiscard]] std::vector<Share> at(const Eigen::Vector3d& direction) const;
  /// Returns the shares in the direction of a projector's pixel, which the inverse map might miss by rounding.
  [[nodiscard]] std::vector<Share> at(const Eigen::Vector3d& direction, std::size_t projector,
                                      const Eigen::Vector2d& pixel) const;

 private:
  /// Part of a side that lies on another picture.
  struct Stretch {
    Eigen::Vector2d from;
    Eigen::Vector2d to;
  };
  struct Picture {
    int width_px = 0;
    int height_px = 0;
    int cells_x = 0;
    int cells_y = 0;
    std::array<std::vector<Stretch>, 4> sides{};  ///< Upper, lower, left, right.
    std::vector<double> inward_px;  ///< Per control point: distance to an end of the map inside another picture.
  };
  [[nodiscard]] bool is_on_another(std::size_t picture, const calibration::MeasuredMap& map,
                                   const Eigen::Vector2d& pixel) const;
  [[nodiscard]] std::vector<Stretch> covered(std::size_t picture, const calibration::MeasuredMap& map,
                                             const Stretch& side) const;
  void find_inner_ends(const std::vector<PhotometricProjector>& projectors);
  [[nodiscard]] double inwardness(const Picture& picture, const Eigen::Vector2d& pixel) const;

  const std::vector<InverseMap>& inverses_;
  std::vector<Picture> pictures_;
};

}  // namespace cyclorama::photometry
