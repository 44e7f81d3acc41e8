// SPDX-License-Identifier: Apache-2.0
/// The best moving picture that fits a frame budget.
#pragma once

#include <optional>

#include "renderfarm/governor/front.h"

namespace cyclorama {

/// Learns what the front's points cost on this farm, in this scene, now: milliseconds per unit of cost and megapixel.
/// Then it chooses the best point that is predicted to fit. Used by the head, one per visit.
///
/// A picture whose quality pumps is worse than one that is always a little worse, and a late frame is worse than both:
///
///   down  at once, when the point in use is predicted beyond the budget: to what fits 90 % of it;
///   up    when something better is predicted to fit 80 % for 10 frames in a row. If that proves wrong within as many
///         frames again, the next attempt takes twice as long, up to 160 frames.
///
/// The rate follows the measurements by an eighth of the difference; two in a row that are half as much again are
/// believed at once, and a single one is not, so that a hiccup changes nothing and a jump is answered after two frames.
/// The first frames are at the cheapest point, which is also used when nothing fits.
///
/// Invariant: when costs are steady, a larger budget never leads to a point of larger error. Pure; thread-bound.
class Governor {
 public:
  /// Precondition: the budget is above 0.
  Governor(Front front, double budget_ms);

  /// The point for the next frame of `megapixels` (as shown, whatever the point's scale). Call it once per frame.
  std::size_t choose(double megapixels);
  /// How long a frame kept the farm busy. A time that is none (NaN, infinite, not above 0) is ignored.
  void measured(std::size_t point, double megapixels, double milliseconds);

  [[nodiscard]] const Front& front() const { return front_; }
  [[nodiscard]] double budget_ms() const { return budget_ms_; }
  /// Nothing before the first measurement.
  [[nodiscard]] std::optional<double> predicted_ms(std::size_t point, double megapixels) const;

 private:
  [[nodiscard]] std::size_t best_within(double milliseconds, double megapixels) const;

  const Front front_;
  const double budget_ms_;
  std::size_t point_ = 0;
  std::optional<double> rate_;        ///< Milliseconds per cost and megapixel.
  double last_rate_ = 0.0;            ///< As the last frame alone would have it.
  int frames_up_possible_ = 0;        ///< In a row.
  int patience_;                      ///< Frames before a step up.
  std::optional<int> since_step_up_;  ///< Frames, while the step is on probation.
};

}  // namespace cyclorama
