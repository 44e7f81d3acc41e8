// SPDX-License-Identifier: Apache-2.0
/// Features that a prediction and a picture have in common, at any distance, and the pose that follows from them: the
/// recovery from a bump that is too large for patches.
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
  std::vector<FeatureMatch> matches;  ///< Matches within one projector's light; unique both ways.
  int in_prediction = 0;              ///< Number of features found in the prediction.
  int in_picture = 0;
};
/// Matches features of a prediction and a picture. Errors: kBadData if OpenCV fails.
Result<FeatureMatches> match_features(const Prediction& prediction, const LightPlane& picture, FeatureKind kind);

/// Returns the step from a projector's believed pose to the one that fits most of its observations; empty if fewer than
/// 12 fit. Method: perspective from three points in a RANSAC with a fixed random sequence, then refinement.
[[nodiscard]] std::optional<calibration::PoseStep> find_projector(const calibration::ShowCalibration& room,
                                                                  std::size_t projector,
                                                                  std::span<const PatchObservation> observations);
/// Returns the step of a camera in the same way; all projectors keep their believed poses.
[[nodiscard]] std::optional<calibration::PoseStep> find_camera(const calibration::ShowCalibration& room,
                                                               std::size_t camera,
                                                               std::span<const PatchObservation> observations);

}  // namespace cyclorama::healing
