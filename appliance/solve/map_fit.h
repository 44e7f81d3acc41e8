// SPDX-License-Identifier: Apache-2.0
/// Fits a projector's map to pixels of the projector and the directions in which they are seen.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <optional>
#include <span>

#include "appliance/calibration/measured_map.h"
#include "common/base/result.h"

namespace cyclorama::solve {

/// A projector's pixel and the direction in which the sweet spot sees it; the pixel has noise, the direction is exact.
/// A map is fitted to the samples of one projector, the wall to the samples of all projectors.
struct MapSample {
  Eigen::Vector2d projector_px;
  Eigen::Vector3d direction;  ///< Eye frame, unit length.
  double sigma_px = 0.1;      ///< In projector pixels, per axis.
  std::size_t projector = 0;  ///< Index of the projector, for samples of several projectors.
};

struct MapOptions {
  int cell_px = 16;           ///< Approximate spacing of the control points.
  double max_sigma_px = 2.0;  ///< Control points with a larger sigma have no direction.
  double max_gap_px = 240.0;  ///< Control points farther than this from any sample have no direction.
  std::size_t min_samples = 60;
  int left_out_every = 8;  ///< While the stiffness is chosen, one in this many blocks of samples is left out.
};

/// Fits a map by robust least squares with a smoothness prior. Creases are allowed: the sharper a bend, the less it is
/// penalised. Solver: sparse Cholesky; the control points' variances come from selected inversion. Errors:
/// kInvalidArgument, with the remedy, if there are too few samples, or they are collinear or surround the sweet spot;
/// kBadData if the least-squares problem has no solution. Reentrant.
Result<calibration::MeasuredMap> fit_measured_map(int width_px, int height_px, std::span<const MapSample> samples,
                                                  const MapOptions& options = {});

/// Returns the fraction of the samples for which the map has a direction, 0 to 1.
[[nodiscard]] double known_part(const calibration::MeasuredMap& map, std::span<const MapSample> samples);

/// Returns the RMS error over the samples, in projector pixels per axis, without the worst twentieth; nothing if the
/// map lacks a direction for most of them.
[[nodiscard]] std::optional<double> map_error_px(const calibration::MeasuredMap& map,
                                                 std::span<const MapSample> samples);

}  // namespace cyclorama::solve
