// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "appliance/tracker/tag_pose.h"
#include "common/base/clock.h"

namespace cyclorama::tracker {

struct ChooserSettings {
  double memory_s = 0.7;  ///< Time in which evidence fades to 1/e. More than 0.
};

/// State of the two hypotheses for one pattern, after some pictures.
struct Hypotheses {
  Eigen::Quaterniond first = Eigen::Quaterniond::Identity();
  std::optional<Eigen::Quaterniond> second;
  /// Log odds that `first` is the true rotation.
  double log_odds = 0.0;
  TimePoint at{};
};

struct ChosenPose {
  TagPose pose;
  std::optional<TagPose> other;  ///< The pose that was not chosen.
  /// Probability that the chosen pose, not the other, is right, if the noise model holds.
  double probability = 1.0;
  Hypotheses state;
};

/// Decides over time between the two poses of a pattern: each hypothesis is followed from picture to picture by its
/// rotation, and the differences of the misfits (TagPose::misfit) are summed (a sequential likelihood ratio test: Wald,
/// "Sequential Tests of Statistical Hypotheses", 1945). One picture of a small tag often prefers the wrong pose; ten
/// pictures rarely do.
///
/// Evidence fades, and faster while the two poses are too close to be told apart; the choice then matters least. A pure
/// function of (settings, state, measurement, time).
[[nodiscard]] ChosenPose choose(const ChooserSettings& settings, const std::optional<Hypotheses>& last,
                                const TagPoses& measured, TimePoint at);

}  // namespace cyclorama::tracker
