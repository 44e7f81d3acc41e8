// SPDX-License-Identifier: Apache-2.0
/// The wall's outline in a camera's picture: its upper and lower edge (conics for a cylinder) and its upright sides. It
/// stands still whatever is shown, and so locates the camera in the room.
#pragma once

#include <span>
#include <vector>

#include "appliance/healing/estimator/patch_observations.h"
#include "appliance/healing/estimator/prediction.h"

namespace cyclorama::healing {

/// Expected position of a point of the outline, from the camera's believed pose.
struct EdgePoint {
  Outline part = Outline::kUpper;
  Eigen::Vector2d at{0.0, 0.0};                                                 ///< Camera pixels.
  Eigen::Vector2d outward{0.0, 0.0};                                            ///< Unit length, away from the wall.
  Eigen::Matrix<double, 1, 6> by_camera = Eigen::Matrix<double, 1, 6>::Zero();  ///< Along `outward`, per step.
};

/// Returns about one point per 16 pixels of the reduced picture. Called once per pose.
[[nodiscard]] std::vector<EdgePoint> edge_points(const Wall& wall, const calibration::ShowCamera& camera,
                                                 const CameraSlopes& slopes, const SeenWall& seen);

/// Those across which light goes on, from the wall to beside it: of a wall that is not lit beyond its edge, as masks
/// see to, it is the picture's end that is seen, and the wall's edge is not. One of `shone` per projector.
[[nodiscard]] std::vector<EdgePoint> lit_across(const std::vector<EdgePoint>& points,
                                                const calibration::ShowCalibration& room, std::size_t camera,
                                                int factor, std::span<const LightPlane> shone);

/// Those that the light of the show makes visible, with where they are: the steepest fall of light along the outward
/// normal, by a parabola through three steps, within 5 pixels of the reduced picture.
[[nodiscard]] std::vector<EdgeObservation> observe_edges(const std::vector<EdgePoint>& points, std::size_t camera,
                                                         const Prediction& prediction, const LightPlane& picture,
                                                         double gain);

}  // namespace cyclorama::healing
