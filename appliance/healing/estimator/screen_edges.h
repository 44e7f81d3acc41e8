// SPDX-License-Identifier: Apache-2.0
/// The wall's outline in a camera's picture: its upper and lower edge (conics for a cylinder) and its upright sides. It
/// does not depend on the content, and therefore locates the camera in the room.
#pragma once

#include <span>
#include <vector>

#include "appliance/healing/estimator/patch_observations.h"
#include "appliance/healing/estimator/prediction.h"

namespace cyclorama::healing {

/// Expected position of a point of the outline, from the camera's believed pose.
struct EdgePoint {
  Outline part = Outline::kUpper;
  Eigen::Vector2d at{0.0, 0.0};       ///< In camera pixels.
  Eigen::Vector2d outward{0.0, 0.0};  ///< Unit length, away from the wall.
  /// Derivative of the point's motion along `outward` with respect to the camera's step.
  Eigen::Matrix<double, 1, 6> by_camera = Eigen::Matrix<double, 1, 6>::Zero();
};

/// Returns points of the outline, about one per 16 pixels of the reduced picture.
[[nodiscard]] std::vector<EdgePoint> edge_points(const Wall& wall, const calibration::ShowCamera& camera,
                                                 const CameraSlopes& slopes, const SeenWall& seen);

/// Returns the points across which the light continues from the wall to its surroundings. Where masks keep the light
/// within the wall, the picture's border is visible instead of the wall's edge. `shone` has one element per projector.
[[nodiscard]] std::vector<EdgePoint> lit_across(const std::vector<EdgePoint>& points,
                                                const calibration::ShowCalibration& room, std::size_t camera,
                                                int factor, std::span<const LightPlane> shone);

/// Returns the points that the light of the show makes visible, with their measured positions: the steepest decrease of
/// light along the outward normal, interpolated by a parabola, within 5 pixels of the reduced picture.
[[nodiscard]] std::vector<EdgeObservation> observe_edges(const std::vector<EdgePoint>& points, std::size_t camera,
                                                         const Prediction& prediction, const LightPlane& picture,
                                                         double gain);

}  // namespace cyclorama::healing
