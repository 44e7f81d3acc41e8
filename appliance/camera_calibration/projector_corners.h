// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "appliance/structured_light/decoded.h"

namespace cyclorama::camera_calibration {

/// Returns the projector pixel that lights a camera position. A second-order surface is fitted to the decoded pixels
/// within `radius_px`, weighted by their sigmas, without outliers. Returns nothing if fewer than 30 pixels are decoded,
/// or all of them are on one side. A local homography (Moreno and Taubin, "Simple, Accurate, and Robust
/// Projector-Camera Calibration", 3DIMPVT 2012) is not used: it is not linear, and no more flexible. Reentrant.
/// Precondition: radius_px > 0.
[[nodiscard]] std::optional<Eigen::Vector2d> projector_pixel_at(const structured_light::Decoded& decoded,
                                                                const Eigen::Vector2d& camera_px, double radius_px);

}  // namespace cyclorama::camera_calibration
