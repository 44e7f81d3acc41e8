// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/governor/governor.h"

#include <algorithm>
#include <utility>

#include "common/base/check.h"

namespace cyclorama::governor {
namespace {

/// Standard deviations between the mean and the 95th percentile: 1.645 for a normal distribution, and the rest for
/// changes of the view.
constexpr double kSdsOfP95 = 1.85;
/// Distance from the limit to the aim (kAim…), and from the aim to the time below which there is room for a step up
/// (kRoom…). Each is a fraction of the upper value plus a multiple of the noise.
constexpr double kAimBelow = 0.02;
constexpr double kAimBelowPerNoise = 0.3;
constexpr double kRoomBelow = 0.03;
constexpr double kRoomBelowPerNoise = 0.5;
/// A step up requires that a frame with at least this share of the current work was measured, since frames in flight
/// belong to earlier pictures, or that kSurelySeen frames have passed, since small pictures are rounded to whole cells
/// and may have less work.
constexpr double kSeen = 0.8;
constexpr int kSurelySeen = 8;
/// Below this multiple of the time that leaves room, the wait is half as long.
constexpr double kFar = 0.9;
constexpr double kStepUpMs = 300.0;
constexpr int kMinStepUpFrames = 3;
constexpr int kMaxInitialStepUpFrames = 10;
constexpr int kMaxStepUpFrames = 160;
/// Duration of the trial after a step up, as a multiple of the initial wait.
constexpr int kTrials = 2;
/// A step up was wrong if the picture takes longer than predicted by this factor.
constexpr double kWrong = 1.15;

}  // namespace

Governor::Governor(ParetoFront front, double budget_ms)
    : front_(std::move(front)),
      budget_ms_(budget_ms),
      initial_step_up_frames_(
          std::clamp(static_cast<int>(kStepUpMs / budget_ms), kMinStepUpFrames, kMaxInitialStepUpFrames)),
      current_(front_[0]),
      step_up_frames_(initial_step_up_frames_) {
  CHECK(budget_ms > 0.0);
}

std::optional<double> Governor::predicted_ms(double cost, double megapixels) const {
  if (!model_.is_known()) return std::nullopt;
  return model_.ms_of(cost * megapixels);
}

void Governor::step_to(double cost) {
  current_ = front_.at(cost);
  frames_up_possible_ = 0;
  since_step_ = 0;
}

const ParetoPoint& Governor::choose(double megapixels) {
  if (!model_.is_known() || !(megapixels > 0.0)) return current_;
  ++since_step_;
  if (trial_ && ++trial_->frames > kTrials * initial_step_up_frames_) {
    trial_.reset();
    step_up_frames_ = initial_step_up_frames_;
  }
  const double limit = budget_ms_ / (1.0 + kSdsOfP95 * model_.noise());
  const double aim = (1.0 - kAimBelow - kAimBelowPerNoise * model_.noise()) * limit;
  const double room = (1.0 - kRoomBelow - kRoomBelowPerNoise * model_.noise()) * aim;
  const double expected = model_.ms_of(current_.cost * megapixels);
  if (expected > limit) {
    if (trial_ && expected > kWrong * trial_->promised_ms) {
      step_up_frames_ = std::min(2 * step_up_frames_, kMaxStepUpFrames);
    }
    trial_.reset();
    is_starting_ = false;
    step_to(std::min(current_.cost, model_.work_within(aim) / megapixels));
    return current_;
  }
  if (expected >= room || current_.cost >= front_.best().cost) {
    is_starting_ = false;
    frames_up_possible_ = std::max(0, frames_up_possible_ - 1);
    return current_;
  }
  frames_up_possible_ += expected < kFar * room ? 2 : 1;
  if (frames_up_possible_ <= step_up_frames_ && !is_starting_) return current_;
  if (since_step_ < kSurelySeen && model_.last_work() < kSeen * current_.cost * megapixels) return current_;
  const double cost = model_.work_surely_within(aim) / megapixels;
  if (front_.at(cost).cost <= current_.cost) return current_;
  step_to(cost);
  if (!is_starting_) trial_ = {model_.ms_of(current_.cost * megapixels), 0};
  return current_;
}

}  // namespace cyclorama::governor
