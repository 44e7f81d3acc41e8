// SPDX-License-Identifier: Apache-2.0
/// Measures the true registration of a calibration's maps on the wall of a simulated museum.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <optional>
#include <vector>

#include "drivers/simulated/museum/true_museum.h"

namespace cyclorama {

/// Distances on the wall, in projector pixels, at samples in 80 columns of each picture.
struct MuseumScore {
  double mean_px = 0.0;  ///< Mean distance between two projectors' drawings of one point of the wall.
  double p95_px = 0.0;
  double max_px = 0.0;
  std::vector<double> apart_px{};   ///< All of these distances, the smallest first.
  std::size_t correspondences = 0;  ///< Number of compared points in overlaps.
  /// 95th percentile of the errors against the view from the turntable's centre, after alignment of heading and tilt.
  double true_p95_px = 0.0;
  double true_max_px = 0.0;  ///< Maximum of the errors of `true_p95_px`.
  /// Part of those errors that are within the 95 % that the calibration states; only with stated sigmas.
  double covered_95 = 0.0;
  std::size_t lit = 0;       ///< Number of pixels that light the wall.
  std::size_t missing = 0;   ///< Number of the lit pixels for which the calibration has no direction.
};

using DirectionOfPixel =
    std::function<std::optional<Eigen::Vector3d>(std::size_t projector, const Eigen::Vector2d& pixel)>;
/// The sigma that a calibration states of a direction, in projector pixels per axis; infinite for none.
using SigmaOfPixel = std::function<double(std::size_t projector, const Eigen::Vector2d& pixel)>;
[[nodiscard]] MuseumScore museum_score(const simulated::TrueMuseum& truth, const DirectionOfPixel& mapped,
                                       const SigmaOfPixel& stated = {});

}  // namespace cyclorama
