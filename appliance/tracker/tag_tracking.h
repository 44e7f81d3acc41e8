// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "appliance/tags/tag_detector.h"
#include "appliance/tracker/one_euro.h"
#include "appliance/tracker/pose_chooser.h"
#include "common/wand/wand.h"

namespace cyclorama::tracker {

/// The patterns that visitors may hold: the standard wands, wands that were measured, or flat tags of one size.
struct PatternSettings {
  std::vector<Wand> wands;                ///< Measured wands, from wand.toml files; they replace the standard wands.
  std::optional<double> flat_tag_size_m;  ///< If set, tags are flat patterns of this size, and there are no wands.
  /// Number of the only standard wand, or id of the only flat tag; absent: any.
  std::optional<int> only;

  /// Returns the pattern with the tag `tag_id`; empty if no pattern has it.
  [[nodiscard]] std::optional<Wand> pattern_of(int tag_id) const;
};

struct TrackingSettings {
  PatternSettings patterns;
  /// Standard deviation of each corner due to lens, paper and folding, px. The default was measured on rendered
  /// pictures; for a real card it is about 0.1. More than 0.
  double corner_floor_px = 0.03;
  ChooserSettings chooser;
  /// Settings of both filters, at the knee of the curve of `./bench.sh visitor-trade`: 5 and 3 ms of delay in motion,
  /// with the jitter of a cut-off of 2 Hz.
  OneEuroSettings position{2.0, 120.0, 1.0};
  OneEuroSettings rotation{2.0, 60.0, 1.0};
};

/// State between two pictures; empty at the start.
struct TrackingState {
  std::optional<int> id;  ///< Wand::id() of the followed pattern.
  TimePoint seen_at{};
  std::optional<Hypotheses> hypotheses;
  std::optional<FilteredPosition> position;
  std::optional<FilteredRotation> rotation;
};

/// The followed pattern in one picture.
struct TrackedTag {
  Wand wand;
  std::vector<tags::TagDetection> seen;  ///< The pattern's tags in this picture, the largest first; at least one.
  TagPoses measured;                     ///< Both hypotheses, unfiltered, with their misfits.
  ChosenPose chosen;                     ///< The chosen hypothesis, with its probability.
  /// Covariance of the chosen pose, including the chance that the other hypothesis is right (wand_pose.h).
  Matrix6d covariance;
  T_CameraTag T_camera_tag;  ///< The chosen pose, filtered; the tour steers by it.
};

struct TrackingResult {
  TrackingState state;
  /// Empty if the followed pattern is not in the picture, or its orientation is not known yet.
  std::optional<TrackedTag> tag;
};

/// Follows one pattern: the pattern of `last` while it is visible or was lost for less than kKeepFor, else the largest.
/// Pure.
[[nodiscard]] TrackingResult track(const TrackingSettings& settings, const TrackingState& last,
                                   std::span<const tags::TagDetection> detections, const Pinhole& lens,
                                   TimePoint captured_at);

inline constexpr Duration kKeepFor = std::chrono::milliseconds(300);

}  // namespace cyclorama::tracker
