// SPDX-License-Identifier: Apache-2.0
/// How far from its pixel a projector would light what the eye sees: the residuals of surface_fit.cpp.
#pragma once

#include <ceres/cost_function.h>

#include <Eigen/Geometry>
#include <memory>

#include "appliance/calibrator/solve/surface.h"

namespace cyclorama {

/// A place of a projector's picture, and where the sweet spot sees it.
struct SurfaceSample {
  std::size_t projector = 0;
  Eigen::Vector2d projector_px;
  Eigen::Vector3d direction;  ///< A unit vector.
  double sigma_px = 0.1;
};

/// Two residuals in sigmas; blocks: the surface's parameters, the projector's turn (3, an angle axis applied in its own
/// frame after `R_eye_projector`), its place (3) and its lens (8). Borrows `shape` (its parameters do not count).
[[nodiscard]] std::unique_ptr<ceres::CostFunction> make_surface_cost(const Surface& shape, const SurfaceSample& sample,
                                                                     const Eigen::Matrix3d& R_eye_projector);

/// Smoothness of a profile or a mesh, and the scale of all: blocks: the surface's parameters. Sigmas are relative to
/// the wall's nearness straight ahead. Borrows `shape`.
[[nodiscard]] std::unique_ptr<ceres::CostFunction> make_spline_prior(const Surface& shape, double bend_sigma);

}  // namespace cyclorama
