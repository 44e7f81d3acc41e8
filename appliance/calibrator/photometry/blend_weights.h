// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <vector>

#include "appliance/calibrator/photometry/inverse_map.h"
#include "appliance/calibrator/photometry/photometry_input.h"
#include "appliance/warp/blend_mask.h"

namespace cyclorama {

/// How several measured projectors share each direction: as blend_weights() of appliance/warp does with exact maps, and
/// where a map ends inside of another projector's picture (a column hides the wall, say) it fades there too.
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
  struct Picture {
    int width_px = 0;
    int height_px = 0;
    int cells_x = 0;
    int cells_y = 0;
    std::vector<double> inward_px;  ///< Per control point: how far from where the map ends inside of another's.
  };
  [[nodiscard]] double inwardness(const Picture& picture, const Eigen::Vector2d& pixel) const;

  const std::vector<InverseMap>& inverses_;
  std::vector<Picture> pictures_;
};

}  // namespace cyclorama
