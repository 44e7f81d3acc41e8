// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/governor/governor.h"

#include <algorithm>
#include <cmath>

#include "common/base/check.h"

namespace cyclorama::governor {
namespace {

constexpr double kFillAfterStepDown = 0.9;
constexpr double kFillAfterStepUp = 0.8;
constexpr int kInitialStepUpFrames = 10;
constexpr int kMaxStepUpFrames = 160;
constexpr double kForgetting = 0.125;
constexpr double kJump = 1.5;

}  // namespace

Governor::Governor(ParetoFront front, double budget_ms)
    : front_(std::move(front)), budget_ms_(budget_ms), step_up_frames_(kInitialStepUpFrames) {
  CHECK(budget_ms > 0.0);
}

std::optional<double> Governor::predicted_ms(std::size_t point, double megapixels) const {
  if (!rate_) return std::nullopt;
  return *rate_ * front_[point].cost * megapixels;
}

std::size_t Governor::best_within(double milliseconds, double megapixels) const {
  std::size_t best = 0;
  for (std::size_t i = 1; i < front_.size() && *predicted_ms(i, megapixels) <= milliseconds; ++i) best = i;
  return best;
}

std::size_t Governor::choose(double megapixels) {
  if (!rate_) return point_;
  if (since_step_up_ && ++*since_step_up_ > step_up_frames_) {
    since_step_up_.reset();
    step_up_frames_ = kInitialStepUpFrames;
  }
  if (*predicted_ms(point_, megapixels) > budget_ms_) {
    if (since_step_up_) step_up_frames_ = std::min(2 * step_up_frames_, kMaxStepUpFrames);
    since_step_up_.reset();
    frames_up_possible_ = 0;
    return point_ = std::min(point_, best_within(kFillAfterStepDown * budget_ms_, megapixels));
  }
  const std::size_t up = best_within(kFillAfterStepUp * budget_ms_, megapixels);
  frames_up_possible_ = up > point_ ? frames_up_possible_ + 1 : 0;
  if (frames_up_possible_ > step_up_frames_) {
    frames_up_possible_ = 0;
    since_step_up_ = 0;
    point_ = up;
  }
  return point_;
}

void Governor::measured(std::size_t point, double megapixels, double milliseconds) {
  const double rate = milliseconds / (front_[point].cost * megapixels);
  if (!(rate > 0.0 && std::isfinite(rate))) return;
  if (!rate_) {
    rate_ = last_rate_ = rate;
    return;
  }
  const double both = std::min(rate, last_rate_);
  last_rate_ = rate;
  rate_ = both > kJump * *rate_ ? both : *rate_ + kForgetting * (std::min(rate, kJump * *rate_) - *rate_);
}

}  // namespace cyclorama::governor
