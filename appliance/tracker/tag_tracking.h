// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>

#include "appliance/tracker/one_euro.h"
#include "appliance/tracker/pose_chooser.h"
#include "appliance/tracker/tag_detector.h"

namespace cyclorama {

struct TrackingSettings {
  double tag_size_m = 0.12;    ///< Edge of the black square. More than 0.
  std::optional<int> only_id;  ///< The visitor's tag; any when not given.
  ChooserSettings chooser;
  OneEuroSettings position{1.5, 40.0, 1.0};
  OneEuroSettings rotation{1.5, 20.0, 1.0};
};

/// What is remembered from picture to picture. Empty at the start.
struct TrackingState {
  std::optional<int> id;
  TimePoint seen_at{};
  std::optional<Hypotheses> hypotheses;
  std::optional<FilteredPosition> position;
  std::optional<FilteredRotation> rotation;
};

/// The followed tag in one picture.
struct TrackedTag {
  TagDetection detection;
  TagPoses measured;         ///< Both explanations, unfiltered, with their reprojection errors.
  ChosenPose chosen;         ///< Which of them is believed, and how firmly.
  T_CameraTag T_camera_tag;  ///< The chosen one, filtered: what the tour steers by.
};

struct TrackingResult {
  TrackingState state;
  std::optional<TrackedTag> tag;  ///< Nothing when the followed tag is not in the picture.
};

/// Follows one tag: the same as before while it is seen or was lost for less than kKeepFor, else the largest. Pure.
[[nodiscard]] TrackingResult track(const TrackingSettings& settings, const TrackingState& last,
                                   std::span<const TagDetection> detections, const Pinhole& lens,
                                   TimePoint captured_at);

inline constexpr Duration kKeepFor = std::chrono::milliseconds(300);

}  // namespace cyclorama
