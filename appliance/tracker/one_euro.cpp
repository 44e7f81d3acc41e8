// SPDX-License-Identifier: Apache-2.0
#include "appliance/tracker/one_euro.h"

#include <cmath>
#include <numbers>

namespace cyclorama::tracker {
namespace {

/// Returns the share of the new value in a first-order low-pass (equations 3 to 6 of the paper).
double alpha_of(double cutoff_hz, double step_s) {
  const double tau_s = 1.0 / (2.0 * std::numbers::pi * cutoff_hz);
  return 1.0 / (1.0 + tau_s / step_s);
}

enum class Step { kUse, kIgnore, kRestart };

Step step_of(bool has_last, bool finite, Duration since_last) {
  if (!finite) return Step::kIgnore;
  if (!has_last || since_last >= kRestartAfter || since_last <= -kRestartAfter) return Step::kRestart;
  return since_last <= Duration::zero() ? Step::kIgnore : Step::kUse;
}

/// Updates the smoothed speed, and returns the share of the new measurement.
double advance_speed(const OneEuroSettings& settings, const Eigen::Vector3d& speed, double step_s,
                     Eigen::Vector3d* ret_smoothed) {
  *ret_smoothed += alpha_of(settings.speed_cutoff_hz, step_s) * (speed - *ret_smoothed);
  return alpha_of(settings.min_cutoff_hz + settings.cutoff_per_speed * ret_smoothed->norm(), step_s);
}

}  // namespace

std::optional<FilteredPosition> filter(const OneEuroSettings& settings, const std::optional<FilteredPosition>& last,
                                       const Eigen::Vector3d& measured, TimePoint at) {
  const Duration since_last = last ? at - last->at : Duration::zero();
  const Step step = step_of(last.has_value(), measured.allFinite(), since_last);
  if (step == Step::kIgnore) return last;
  if (step == Step::kRestart) return FilteredPosition{measured, Eigen::Vector3d::Zero(), at};
  const double step_s = to_seconds(since_last);
  FilteredPosition next = *last;
  const double alpha = advance_speed(settings, (measured - last->value) / step_s, step_s, &next.speed);
  next.value += alpha * (measured - last->value);
  next.at = at;
  return next;
}

std::optional<FilteredRotation> filter(const OneEuroSettings& settings, const std::optional<FilteredRotation>& last,
                                       const Eigen::Quaterniond& measured, TimePoint at) {
  const double norm = measured.norm();
  const bool usable = std::isfinite(norm) && norm > 1e-6;
  const Duration since_last = last ? at - last->at : Duration::zero();
  const Step step = step_of(last.has_value(), usable, since_last);
  if (step == Step::kIgnore) return last;
  const Eigen::Quaterniond target = measured.normalized();
  if (step == Step::kRestart) return FilteredRotation{target, Eigen::Vector3d::Zero(), at};
  const double step_s = to_seconds(since_last);
  // AngleAxis gives an angle from 0 to π, which is the shorter way.
  const Eigen::AngleAxisd turn(last->value.conjugate() * target);
  FilteredRotation next = *last;
  const double alpha = advance_speed(settings, turn.axis() * (turn.angle() / step_s), step_s, &next.speed);
  next.value = last->value.slerp(alpha, target).normalized();
  next.at = at;
  return next;
}

}  // namespace cyclorama::tracker
