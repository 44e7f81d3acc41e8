// SPDX-License-Identifier: Apache-2.0
#include "appliance/tracker/pose_chooser.h"

#include <algorithm>
#include <cmath>

namespace cyclorama::tracker {
namespace {

/// Limit of the log odds from one picture, whose error may be a reflection rather than noise.
constexpr double kMaxLogOddsPerPicture = 4.0;
/// Limit of the sum of log odds, so that a wrong decision is reversed within a few pictures.
constexpr double kMaxLogOdds = 12.0;
/// Time without a pose after which a hand's motion cannot be predicted.
constexpr Duration kForgetAfter = std::chrono::milliseconds(500);
/// Angle between the poses below which they cannot be matched from one picture to the next.
constexpr double kDistinctRad = 0.17;

double fading(const ChooserSettings& settings, const Hypotheses& last, TimePoint at) {
  const double distinct = last.second ? std::min(1.0, last.first.angularDistance(*last.second) / kDistinctRad) : 1.0;
  return distinct * std::exp(-std::max(0.0, to_seconds(at - last.at)) / settings.memory_s);
}

}  // namespace

ChosenPose choose(const ChooserSettings& settings, const std::optional<Hypotheses>& last, const TagPoses& measured,
                  TimePoint at) {
  const Eigen::Quaterniond& best = measured.best.T_camera_tag.rotation();
  if (!measured.other) {
    // A near tag has only one pose, which settles the choice.
    return {measured.best, std::nullopt, 1.0, {best, std::nullopt, kMaxLogOdds, at}};
  }
  const Eigen::Quaterniond& other = measured.other->T_camera_tag.rotation();
  const double gain = std::min(kMaxLogOddsPerPicture, 0.5 * (measured.other->misfit - measured.best.misfit));
  const bool known = last && at - last->at < kForgetAfter && last->at - at < kForgetAfter;
  bool best_is_first = true;
  double log_odds = 0.0;
  if (known) {
    const Eigen::Quaterniond& first = last->first;
    // If the last picture had only one pose, its continuation becomes the first hypothesis.
    const double straight = first.angularDistance(best) + (last->second ? last->second->angularDistance(other) : 0.0);
    const double crossed = first.angularDistance(other) + (last->second ? last->second->angularDistance(best) : 0.0);
    best_is_first = straight <= crossed;
    log_odds = last->log_odds * fading(settings, *last, at);
  }
  log_odds = std::clamp(log_odds + (best_is_first ? gain : -gain), -kMaxLogOdds, kMaxLogOdds);
  const bool first_wins = log_odds >= 0.0;
  ChosenPose chosen;
  const bool best_wins = first_wins == best_is_first;
  chosen.pose = best_wins ? measured.best : *measured.other;
  chosen.other = best_wins ? *measured.other : measured.best;
  chosen.probability = 1.0 / (1.0 + std::exp(-std::abs(log_odds)));
  chosen.state = {best_is_first ? best : other, best_is_first ? other : best, log_odds, at};
  return chosen;
}

}  // namespace cyclorama::tracker
