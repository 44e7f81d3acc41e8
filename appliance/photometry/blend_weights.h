// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "appliance/photometry/inverse_map.h"
#include "appliance/photometry/photometry_input.h"
#include "appliance/warp/blend_mask.h"

namespace cyclorama::photometry {

/// How several measured projectors share each direction. A picture fades towards the stretches of its sides that lie on
/// another's picture, and towards no others:
///
///      ┌─────────────┐   A       A fades towards this stretch of its lower side, and of its right one, and B towards
///      │        ┌────┼──────┐    those of its upper and left ones. Where pictures' sides cross at the rim of all that
///      └────────┼────┘      │ B  is lit (twice here) all weights meet in a point: they change by their distance to it
///      only,
///               └───────────┘    and not within the few pixels by which one picture looks out beyond another.
///
/// Where a map ends inside of another's picture (a column hides the wall, say) it fades there too.
/// weight_i = r_i / sum of r, r = square of the product over the sides of t (2 - t), t: the distance from the
/// stretches, in half pictures, at most 1. The product, and its square, as blend_weights() of appliance/warp has them.
/// Reentrant; borrows the inverse maps.
class BlendWeights {
 public:
  BlendWeights(const std::vector<PhotometricProjector>& projectors, const std::vector<InverseMap>& inverses);

  struct Share {
    std::size_t projector = 0;
    Eigen::Vector2d pixel;
    double weight = 0.0;
  };
  /// All projectors that are seen there; their weights add up to 1. Empty where there is none.
  [[nodiscard]] std::vector<Share> at(const Eigen::Vector3d& direction) const;
  /// The same for a direction of a projector's own pixel, which inverting might miss by rounding.
  [[nodiscard]] std::vector<Share> at(const Eigen::Vector3d& direction, std::size_t projector,
                                      const Eigen::Vector2d& pixel) const;

 private:
  /// A part of a side that lies on another's picture.
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
    std::vector<double> inward_px;  ///< Per control point: how far from where the map ends inside of another's.
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
