// SPDX-License-Identifier: Apache-2.0
/// Chooses the quality of a moving picture so that frames fit a budget.
#pragma once

#include <optional>

#include "renderfarm/governor/frame_time_model.h"
#include "renderfarm/governor/front.h"

namespace cyclorama::governor {

/// Learns what frames cost at present on this farm and in this scene (FrameTimeModel). Chooses the best picture along
/// the Pareto front, or between its points, that is predicted to fit the budget. Used by the coordinator, one per
/// session.
///
/// Quality that oscillates is worse than quality that is always slightly lower, and a late frame is worse than both:
///
///   limit  the mean frame time at which 95 % of frames keep the budget, given the noise of the frames so far;
///   aim    2 % and 0.3 times the noise below the limit;
///   down   at once, to the aim, if the current picture is predicted to exceed the limit;
///   up     if the current picture is predicted to stay more than 3 % and half of the noise below the aim for 0.3 s
///          (3 to 10 frames): to the largest work that surely keeps the aim (FrameTimeModel::work_surely_within), so
///          that an unknown fixed time is approached from below. Until the aim is reached for the first time, steps up
///          need no wait. If a picture after a step up takes 15 % longer than predicted and is given up within 0.6 s,
///          the wait before the next attempt is doubled, up to 160 frames.
///
/// The first frames use the cheapest point. It is also used if no picture fits.
///
/// Invariant: at constant costs, a larger budget never selects a picture of larger error. Pure; thread-bound.
class Governor {
 public:
  /// Precondition: the budget is above 0.
  Governor(ParetoFront front, double budget_ms);

  /// Returns the picture for the next frame. `megapixels` is the displayed size, whatever the picture's scale. To be
  /// called once per frame. The reference is valid until the next call.
  const ParetoPoint& choose(double megapixels);
  /// Learns from a frame. Invalid frames are ignored (FrameTimeModel::add).
  void measured(const MeasuredFrame& frame) { model_.add(frame); }

  [[nodiscard]] const ParetoFront& front() const { return front_; }
  [[nodiscard]] double budget_ms() const { return budget_ms_; }
  /// Returns the picture that choose() returned last; before the first call, the cheapest.
  [[nodiscard]] const ParetoPoint& current() const { return current_; }
  /// Returns the predicted time of a picture with this ParetoPoint::cost; null before the first measurement.
  [[nodiscard]] std::optional<double> predicted_ms(double cost, double megapixels) const;
  [[nodiscard]] const FrameTimeModel& model() const { return model_; }

 private:
  void step_to(double cost);

  const ParetoFront front_;
  const double budget_ms_;
  const int initial_step_up_frames_;
  FrameTimeModel model_;
  ParetoPoint current_;
  bool is_starting_ = true;     ///< True until the aim is reached for the first time.
  int frames_up_possible_ = 0;  ///< Number of consecutive frames with room for a step up.
  int since_step_ = 0;          ///< Number of frames since the last step up or down.
  int step_up_frames_;          ///< Number of frames to wait before a step up.
  struct Trial {
    double promised_ms = 0.0;
    int frames = 0;
  };
  std::optional<Trial> trial_;  ///< Last step up, until it has been confirmed.
};

}  // namespace cyclorama::governor
