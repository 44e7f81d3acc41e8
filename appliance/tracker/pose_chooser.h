// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "appliance/tracker/tag_pose.h"
#include "common/base/clock.h"

namespace cyclorama::tracker {

struct ChooserSettings {
  double memory_s = 0.7;  ///< Evidence fades to 1/e over this time. More than 0.
};

/// What is known of one tag's two explanations after some pictures.
struct Hypotheses {
  Eigen::Quaterniond first = Eigen::Quaterniond::Identity();
  std::optional<Eigen::Quaterniond> second;
  /// Log odds that `first` is the true one.
  double log_odds = 0.0;
  TimePoint at{};
};

struct ChosenPose {
  TagPose pose;
  std::optional<TagPose> other;  ///< The one that was not chosen.
  double probability = 1.0;      ///< That this is the right one of the two, as far as the noise model is right.
  Hypotheses state;
};

/// Decides between the two poses of a pattern over time: each explanation is followed from picture to picture by its
/// rotation, and how much better one fits than the other (TagPose::misfit) is added up (a sequential likelihood ratio
/// test: Wald, "Sequential Tests of Statistical Hypotheses", 1945). One picture of a small tag often prefers the wrong
/// one; ten rarely do.
///
/// Evidence fades, and faster while the two are so close that nobody can follow which is which; that is also where the
/// choice matters least. A pure function of (settings, state, measurement, time).
[[nodiscard]] ChosenPose choose(const ChooserSettings& settings, const std::optional<Hypotheses>& last,
                                const TagPoses& measured, TimePoint at);

}  // namespace cyclorama::tracker
