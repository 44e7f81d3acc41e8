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

/// Which patterns visitors may hold: the standard wands, wands that were measured, or flat tags of one size.
struct PatternSettings {
  std::vector<Wand> wands;                ///< From wand.toml files; they replace the standard ones.
  std::optional<double> flat_tag_size_m;  ///< Any tag alone is a pattern of this size; replaces all wands.
  std::optional<int> only;                ///< Of the standard wands this number, of flat tags this id; else any.

  /// The pattern that a tag belongs to; nothing for a stranger.
  [[nodiscard]] std::optional<Wand> pattern_of(int tag_id) const;
};

struct TrackingSettings {
  PatternSettings patterns;
  /// What lens, paper and folding add to each corner's deviation, px. Measured on rendered pictures, where it is as
  /// small; on a real card 0.1. More than 0.
  double corner_floor_px = 0.03;
  ChooserSettings chooser;
  /// Where the curve of `./bench.sh visitor-trade` bends: 5 and 3 ms late in motion, at the jitter that the cut-off
  /// has.
  OneEuroSettings position{2.0, 120.0, 1.0};
  OneEuroSettings rotation{2.0, 60.0, 1.0};
};

/// What is remembered from picture to picture. Empty at the start.
struct TrackingState {
  std::optional<int> id;  ///< Wand::id() of the followed one.
  TimePoint seen_at{};
  std::optional<Hypotheses> hypotheses;
  std::optional<FilteredPosition> position;
  std::optional<FilteredRotation> rotation;
};

/// The followed pattern in one picture.
struct TrackedTag {
  Wand wand;
  std::vector<tags::TagDetection> seen;  ///< Its tags in this picture, the largest first; at least one.
  TagPoses measured;                     ///< Both explanations, unfiltered, with their misfits.
  ChosenPose chosen;                     ///< Which of them is believed, and how firmly.
  Matrix6d covariance;       ///< Of the chosen one, the chance that the other is right included (wand_pose.h).
  T_CameraTag T_camera_tag;  ///< The chosen one, filtered: what the tour steers by.
};

struct TrackingResult {
  TrackingState state;
  /// Nothing when the followed pattern is not in the picture, or which way it points is not known yet.
  std::optional<TrackedTag> tag;
};

/// Follows one pattern: the same as before while it is seen or was lost for less than kKeepFor, else the largest. Pure.
[[nodiscard]] TrackingResult track(const TrackingSettings& settings, const TrackingState& last,
                                   std::span<const tags::TagDetection> detections, const Pinhole& lens,
                                   TimePoint captured_at);

inline constexpr Duration kKeepFor = std::chrono::milliseconds(300);

}  // namespace cyclorama::tracker
