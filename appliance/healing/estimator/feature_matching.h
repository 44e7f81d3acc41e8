// SPDX-License-Identifier: Apache-2.0
/// Features that a prediction and a picture share, however far apart, and the pose that they tell: how a wall that was
/// bumped out of the patches' reach is found again.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "appliance/healing/estimator/patch_observations.h"
#include "appliance/healing/estimator/prediction.h"

namespace cyclorama::healing {

enum class FeatureKind { kSift, kAkaze };

struct FeatureMatch {
  Eigen::Vector2d predicted{0.0, 0.0};  ///< In the prediction's pixels, from its corner.
  Eigen::Vector2d seen{0.0, 0.0};
  int projector = -1;
};

struct FeatureMatches {
  std::vector<FeatureMatch> matches;  ///< Of light that is one projector's; unique both ways.
  int in_prediction = 0;              ///< Features.
  int in_picture = 0;
};
/// kBadData  OpenCV refused.
Result<FeatureMatches> match_features(const Prediction& prediction, const LightPlane& picture, FeatureKind kind);

/// The step from where a projector is believed to be to where most of its observations fit; nothing below 12 that do.
/// Perspective-three-points in a RANSAC of fixed draws, then refined.
[[nodiscard]] std::optional<calibration::PoseStep> find_projector(const calibration::ShowCalibration& room,
                                                                  std::size_t projector,
                                                                  std::span<const PatchObservation> observations);
/// The same of a camera, all projectors being where they are believed to be.
[[nodiscard]] std::optional<calibration::PoseStep> find_camera(const calibration::ShowCalibration& room,
                                                               std::size_t camera,
                                                               std::span<const PatchObservation> observations);

}  // namespace cyclorama::healing
