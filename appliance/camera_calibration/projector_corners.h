// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "appliance/structured_light/decoded.h"

namespace cyclorama::camera_calibration {

/// Where on the projector a camera's place shines, from the decoded pixels within `radius_px` of it: a second-order
/// surface through them, weighted by their sigmas, without those that lie far off. Nothing where fewer than 30 pixels
/// are decoded or they lie on one side only. Instead of a local homography (Moreno and Taubin, "Simple, Accurate, and
/// Robust Projector-Camera Calibration", 3DIMPVT 2012), which is not linear and bends no further. Reentrant.
/// Precondition: radius_px > 0.
[[nodiscard]] std::optional<Eigen::Vector2d> projector_pixel_at(const structured_light::Decoded& decoded,
                                                                const Eigen::Vector2d& camera_px, double radius_px);

}  // namespace cyclorama::camera_calibration
