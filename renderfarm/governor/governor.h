// SPDX-License-Identifier: Apache-2.0
/// Chooses the quality of a moving picture so that frames fit a budget.
#pragma once

#include <optional>

#include "renderfarm/governor/front.h"

namespace cyclorama::governor {

/// Estimates what the front's points cost on this farm, in this scene, at present, in milliseconds per unit of cost and
/// megapixel, and chooses the best point that is predicted to fit. Used by the coordinator, one per session.
///
/// Quality that oscillates is worse than quality that is always slightly lower, and a late frame is worse than both:
///
///   down  at once, when the current point is predicted to exceed the budget: to the best point that fits 90 % of it;
///   up    when a better point is predicted to fit 80 % for 10 frames in a row. If that proves wrong within as many
///         frames again, the next attempt takes twice as long, up to 160 frames.
///
/// The rate follows the measurements by an eighth of the difference. Two in a row that exceed it by half are adopted at
/// once, a single one is not: an outlier has little effect, and a jump is followed after two frames. The first frames
/// use the cheapest point, which is also the fallback when nothing fits.
///
/// Invariant: at constant costs, a larger budget never selects a point of larger error. Pure; thread-bound.
class Governor {
 public:
  /// Precondition: the budget is above 0.
  Governor(ParetoFront front, double budget_ms);

  /// Returns the point for the next frame of `megapixels` (as displayed, whatever the point's scale). Called once per
  /// frame.
  std::size_t choose(double megapixels);
  /// Records how long a frame occupied the farm. Invalid times (NaN, infinite, not above 0) are ignored.
  void measured(std::size_t point, double megapixels, double milliseconds);

  [[nodiscard]] const ParetoFront& front() const { return front_; }
  [[nodiscard]] double budget_ms() const { return budget_ms_; }
  /// Null before the first measurement.
  [[nodiscard]] std::optional<double> predicted_ms(std::size_t point, double megapixels) const;

 private:
  [[nodiscard]] std::size_t best_within(double milliseconds, double megapixels) const;

  const ParetoFront front_;
  const double budget_ms_;
  std::size_t point_ = 0;
  std::optional<double> rate_;        ///< Milliseconds per cost and megapixel.
  double last_rate_ = 0.0;            ///< The rate of the last frame alone.
  int frames_up_possible_ = 0;        ///< Consecutive frames with room for a step up.
  int step_up_frames_;                ///< Frames before a step up.
  std::optional<int> since_step_up_;  ///< Frames since the last step up, during its trial.
};

}  // namespace cyclorama::governor
