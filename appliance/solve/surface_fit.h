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

/// Rungs of lens_models.h that a wall's samples can tell of a projector.
inline constexpr calibration::LensModel kProjectorLensModels[] = {
    calibration::LensModel::kPinhole, calibration::LensModel::kRadial1, calibration::LensModel::kRadial2,
    calibration::LensModel::kDecentred};

struct SurfaceFitOptions {
  calibration::LensModel lens = calibration::LensModel::kRadial1;
  bool with_covariance = true;
  int max_steps = 40;
  bool is_from_afar = true;  ///< False where the start fitted such samples already: then gross errors go at once.
};

/// A wall and the places of all projectors that tell where each pixel is seen. `start` is where the search begins.
/// kInvalidArgument  a projector has no place to begin with, or no samples. kBadData  no fit from this start.
/// Reentrant.
Result<calibration::SurfaceFit> fit_surface(const std::vector<MeasuredProjector>& projectors,
                                            std::span<const MapSample> samples, const calibration::SurfaceFit& start,
                                            const SurfaceFitOptions& options = {});

/// A start from the installation's places and a plane straight ahead of the samples' middle.
Result<calibration::SurfaceFit> surface_start(const std::vector<MeasuredProjector>& projectors,
                                              std::span<const MapSample> samples, double wall_distance_m);

/// Per axis, in projector pixels, without the worst twentieth; a place that the fit misses counts 100 px.
[[nodiscard]] double prediction_error_px(const calibration::SurfaceFit& fit, std::span<const MapSample> samples);

}  // namespace cyclorama::solve
