// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/governor/frame_time_model.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace cyclorama::governor {
namespace {

constexpr double kMoreExpensive = 1.25;
constexpr double kCheaper = 0.8;
constexpr double kCostForgetting = 0.2;
constexpr double kNoiseForgetting = 0.05;
/// Factor by which one frame may increase the noise at most, so that a frame that hung counts little.
constexpr double kMaxNoiseGrowth = 2.5;
constexpr double kSameWork = 0.1;
constexpr double kMinNoise = 0.02;
constexpr double kMaxNoise = 0.3;
/// Ratio of the standard deviation to the mean absolute difference of two independent normal values: sqrt(pi) / 2.
constexpr double kSdPerChange = 0.8862;
constexpr double kOutlierSds = 3.5;
/// Parameters of the cumulative sum test, in standard deviations: two outliers in a row are a jump, and one is not.
constexpr double kCusumSlack = 0.75;
constexpr double kCusumLimit = 5.4;
/// Share of a jump that the fixed time may explain; a scene's cost jumps more often than a network's time.
constexpr double kFixedJump = 0.25;
/// Relative standard deviation of the prior: of the slope and of the fixed time, the latter relative to the first
/// frame's time.
constexpr double kPriorSd = 0.5;
/// Standard deviations of the random walk per frame: of the fixed time, relative to the frame time; and of the slope,
/// relative to itself. Without thread times, the slope includes the scene's cost, which changes faster.
constexpr double kFixedDrift = 0.005;
constexpr double kSlopeDrift = 0.01;
constexpr double kSlopeDriftWithoutRays = 0.02;
/// Lower bounds of the slope: the first as a share of the slope that results without a fixed time; the second applies
/// only with thread times, since a busy node cannot be much faster than its threads.
constexpr double kMinSlopePart = 0.02;
constexpr double kMinSlopeWithRays = 0.4;
/// Parameters of work_surely_within(): the number of standard deviations added to the prediction, and the maximum of
/// its result as a multiple of the last work.
constexpr double kSureSds = 2.0;
constexpr double kMaxGrowth = 5.0;

bool is_valid(double value) { return value > 0.0 && std::isfinite(value); }

}  // namespace

double FrameTimeModel::ms_of(double work) const { return fixed_ + slope_ * cost_rate_ * work; }

double FrameTimeModel::sd_ms(double work) const {
  const double rays = cost_rate_ * work;
  return std::sqrt(std::max(0.0, covariance_.fixed + 2.0 * rays * covariance_.both + rays * rays * covariance_.slope));
}

double FrameTimeModel::work_within(double ms) const { return std::max(0.0, (ms - fixed_) / (slope_ * cost_rate_)); }

double FrameTimeModel::work_surely_within(double ms) const {
  const double by_secant = last_work_ * ms / ms_of(last_work_);
  double low = 0.0;
  double high = work_within(ms);
  constexpr int kHalvings = 30;
  for (int i = 0; i < kHalvings; ++i) {
    const double middle = 0.5 * (low + high);
    (ms_of(middle) + kSureSds * sd_ms(middle) <= ms ? low : high) = middle;
  }
  return std::min({work_within(ms), std::max(by_secant, low), kMaxGrowth * last_work_});
}

void FrameTimeModel::add(const MeasuredFrame& frame) {
  if (!is_valid(frame.work) || !is_valid(frame.ms)) return;
  const bool measured = is_valid(frame.rays_ms);
  if (!known_) {
    has_rays_ = measured;
    start(frame, measured ? frame.rays_ms : frame.work);
  } else {
    if (measured && !has_rays_) begin_rays(frame.rays_ms / frame.work);
    const double deviation = std::log(frame.ms / ms_of(frame.work));
    const double change = std::abs(deviation - std::exchange(last_deviation_, deviation));
    if (std::abs(frame.work - last_work_) < kSameWork * last_work_) learn_noise(change);
    if (measured) learn_cost(frame.rays_ms / frame.work);
    learn_split(measured ? frame.rays_ms : cost_rate_ * frame.work, frame.ms);
  }
  last_work_ = frame.work;
}

void FrameTimeModel::start(const MeasuredFrame& frame, double rays) {
  known_ = true;
  cost_rate_ = has_rays_ ? rays / frame.work : 1.0;
  slope_ = has_rays_ ? std::min(1.0, frame.ms / rays) : frame.ms / rays;
  fixed_ = std::max(0.0, frame.ms - slope_ * rays);
  const double sd_fixed = kPriorSd * frame.ms;
  const double sd_slope = kPriorSd * slope_;
  covariance_ = {sd_fixed * sd_fixed, sd_slope * sd_slope, 0.0};
  correct(rays, 0.0, std::pow(noise_ * frame.ms, 2));
}

void FrameTimeModel::begin_rays(double rate) {
  has_rays_ = true;
  cost_rate_ = rate;
  slope_ /= rate;
  covariance_.slope /= rate * rate;
  covariance_.both /= rate;
}

void FrameTimeModel::learn_noise(double change) {
  const double sd = std::min(kSdPerChange * change, kMaxNoiseGrowth * noise_);
  noise_ = std::clamp(noise_ + kNoiseForgetting * (sd - noise_), kMinNoise, kMaxNoise);
}

void FrameTimeModel::learn_cost(double rate) {
  const double ratio = rate / cost_rate_;
  const bool is_cheap = ratio < kCheaper;
  if (ratio > kMoreExpensive || (is_cheap && was_cheap_)) {
    cost_rate_ = rate;
  } else if (!is_cheap) {
    cost_rate_ *= std::pow(ratio, kCostForgetting);
  }
  was_cheap_ = is_cheap;
}

void FrameTimeModel::learn_split(double rays, double ms) {
  const double expected = fixed_ + slope_ * rays;
  const double drift = has_rays_ ? kSlopeDrift : kSlopeDriftWithoutRays;
  covariance_.fixed += std::pow(kFixedDrift * expected, 2);
  covariance_.slope += std::pow(drift * slope_, 2);
  limit(expected);
  const double noise_variance = std::pow(noise_ * expected, 2);
  const double innovation = ms - expected;
  const double variance =
      noise_variance + covariance_.fixed + 2.0 * rays * covariance_.both + rays * rays * covariance_.slope;
  const double sds = innovation / std::sqrt(variance);
  const double clipped = std::clamp(sds, -kOutlierSds, kOutlierSds);
  late_ = std::max(0.0, late_ + clipped - kCusumSlack);
  early_ = std::max(0.0, early_ - clipped - kCusumSlack);
  if (std::max(late_, early_) > kCusumLimit) {
    late_ = early_ = 0.0;
    covariance_.slope += std::pow(innovation / rays, 2);
    covariance_.fixed += std::pow(kFixedJump * innovation, 2);
  } else if (std::abs(sds) > kOutlierSds) {
    return;
  }
  correct(rays, innovation, noise_variance);
}

void FrameTimeModel::limit(double expected) {
  const double fixed = std::min(1.0, kPriorSd * expected / std::sqrt(covariance_.fixed));
  const double slope = std::min(1.0, kPriorSd * slope_ / std::sqrt(covariance_.slope));
  covariance_ = {fixed * fixed * covariance_.fixed, slope * slope * covariance_.slope,
                 fixed * slope * covariance_.both};
}

void FrameTimeModel::correct(double rays, double innovation, double variance) {
  const double with_fixed = covariance_.fixed + rays * covariance_.both;
  const double with_slope = covariance_.both + rays * covariance_.slope;
  const double total = with_fixed + rays * with_slope + variance;
  fixed_ += with_fixed / total * innovation;
  slope_ += with_slope / total * innovation;
  covariance_.fixed -= with_fixed * with_fixed / total;
  covariance_.slope -= with_slope * with_slope / total;
  covariance_.both -= with_fixed * with_slope / total;
  project(rays);
}

void FrameTimeModel::project(double rays) {
  const double expected = fixed_ + slope_ * rays;
  if (fixed_ < 0.0) {
    slope_ -= covariance_.both / covariance_.fixed * fixed_;
    fixed_ = 0.0;
  }
  const double by_time = expected / rays;
  const double min_slope = std::max(kMinSlopePart * by_time, has_rays_ ? std::min(kMinSlopeWithRays, by_time) : 0.0);
  if (slope_ >= min_slope) return;
  slope_ = min_slope;
  fixed_ = std::max(0.0, expected - min_slope * rays);
}

}  // namespace cyclorama::governor
