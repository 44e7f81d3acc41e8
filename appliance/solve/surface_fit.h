// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <span>
#include <string>
#include <vector>

#include "appliance/calibration/calibration.h"
#include "appliance/solve/measurements.h"
#include "appliance/solve/surface_cost.h"
#include "common/base/result.h"

namespace cyclorama::solve {

/// Candidate lens models of projectors: those that a wall's samples can distinguish.
inline constexpr calibration::LensModel kProjectorLensModels[] = {
    calibration::LensModel::kPinhole, calibration::LensModel::kRadial1, calibration::LensModel::kRadial2,
    calibration::LensModel::kDecentred};

struct SurfaceFitOptions {
  calibration::LensModel lens = calibration::LensModel::kRadial1;
  bool with_covariance = true;
  int max_steps = 40;
  /// False if the start already fits similar samples; outliers are then ignored from the first step.
  bool is_from_afar = true;
};

/// Fits the wall and the poses of all projectors to the samples. `start` is the initial estimate. Errors:
/// kInvalidArgument if a projector has no prior pose or no samples; kBadData if no fit is found from this start.
/// Reentrant.
Result<calibration::SurfaceFit> fit_surface(const std::vector<MeasuredProjector>& projectors,
                                            std::span<const MapSample> samples, const calibration::SurfaceFit& start,
                                            const SurfaceFitOptions& options = {});

/// Returns an initial estimate: the installation's poses, and a plane perpendicular to the samples' mean direction.
Result<calibration::SurfaceFit> surface_start(const std::vector<MeasuredProjector>& projectors,
                                              std::span<const MapSample> samples, double wall_distance_m);

/// Returns the RMS error per axis in projector pixels, without the worst twentieth; a sample that the fit misses counts
/// as 100 px.
[[nodiscard]] double prediction_error_px(const calibration::SurfaceFit& fit, std::span<const MapSample> samples);

}  // namespace cyclorama::solve
