// SPDX-License-Identifier: Apache-2.0
/// From pixels of a projector and the directions in which they are seen to the projector's map.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <optional>
#include <span>

#include "appliance/calibration/measured_map.h"
#include "common/base/result.h"

namespace cyclorama::solve {

/// A projector's pixel and the direction in which the sweet spot sees it; the pixel has noise, the direction has none.
/// Maps are fitted to one projector's samples, the wall to those of all projectors.
struct MapSample {
  Eigen::Vector2d projector_px;
  Eigen::Vector3d direction;  ///< Eye frame, unit length.
  double sigma_px = 0.1;      ///< In projector pixels, per axis.
  std::size_t projector = 0;  ///< Index of the projector, where several are meant.
};

struct MapOptions {
  int cell_px = 16;           ///< Approximate spacing of the control points.
  double max_sigma_px = 2.0;  ///< A gap with a larger sigma is not filled.
  double max_gap_px = 240.0;  ///< Nor is it filled farther than this from any sample.
  std::size_t min_samples = 60;
  int left_out_every = 8;  ///< One block of samples in so many is held out while the stiffness is chosen.
};

/// Robust least squares with smoothness, by sparse Cholesky; control points' variances by selected inversion. Creases
/// are allowed for: a bend counts less the sharper it is.
/// kInvalidArgument  too few samples, all on a line, or all round the sweet spot: says what to add.
/// kBadData  the least-squares problem has no solution. Reentrant.
Result<calibration::MeasuredMap> fit_measured_map(int width_px, int height_px, std::span<const MapSample> samples,
                                                  const MapOptions& options = {});

/// The share of the samples for which the map has a direction: 0 to 1.
[[nodiscard]] double known_part(const calibration::MeasuredMap& map, std::span<const MapSample> samples);

/// RMS error over the samples, in projector pixels per axis, without the worst twentieth. Nothing where the map lacks a
/// direction for most of them.
[[nodiscard]] std::optional<double> map_error_px(const calibration::MeasuredMap& map,
                                                 std::span<const MapSample> samples);

}  // namespace cyclorama::solve
