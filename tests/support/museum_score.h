// SPDX-License-Identifier: Apache-2.0
/// True registration of a calibration's maps on the wall of a simulated museum.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <optional>

#include "drivers/simulated/museum/true_museum.h"

namespace cyclorama {

/// Distances on the wall in projector pixels, sampled at 80 columns of each picture.
struct MuseumScore {
  double mean_px = 0.0;  ///< Mean distance at which two projectors draw one point of the wall.
  double p95_px = 0.0;
  double max_px = 0.0;
  std::size_t correspondences = 0;  ///< Number in overlaps.
  double true_p95_px =
      0.0;  ///< 95th percentile against the view from the turntable's centre, after alignment of heading and tilt.
  double true_max_px = 0.0;  ///< Maximum of the same errors.
  std::size_t lit = 0;       ///< Pixels that light the wall.
  std::size_t missing = 0;   ///< Pixels of those that have no direction.
};

using DirectionOfPixel =
    std::function<std::optional<Eigen::Vector3d>(std::size_t projector, const Eigen::Vector2d& pixel)>;
[[nodiscard]] MuseumScore museum_score(const simulated::TrueMuseum& truth, const DirectionOfPixel& mapped);

}  // namespace cyclorama
