// SPDX-License-Identifier: Apache-2.0
#include "appliance/display/synchronised_refresh.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>

namespace cyclorama::display {
namespace {

// Hysteresis, as a share of the period: ten times the uncertainty of a clock over a wired network.
constexpr double kHold = 0.1;
constexpr Duration kMaxLead = std::chrono::seconds(1);
// A headless output reports its refreshes late by the drawing time; a mean over this many refreshes smooths the delay.
constexpr int kSmoothing = 32;
constexpr std::uint64_t kMaxGap = 1'000'000;

std::int64_t nearest(std::int64_t t_ns, std::int64_t period_ns) {
  const std::int64_t whole = t_ns / period_ns;
  const std::int64_t rest = t_ns % period_ns;
  if (rest >= period_ns - rest) return whole + 1;
  return rest < 0 && -rest > period_ns + rest ? whole - 1 : whole;
}

}  // namespace

void SynchronisedRefresh::shown(const output::Presented& presented, double refresh_hz) {
  const auto period = std::chrono::duration_cast<Duration>(std::chrono::duration<double>(1.0 / refresh_hz));
  const std::uint64_t passed = std::min(presented.refresh - refresh_, kMaxGap);
  const TimePoint expected = at_ + period * static_cast<std::int64_t>(passed);
  const Duration late = presented.at - expected;
  if (seen_ == 0 || period != output_period_ || late > period / 2 || late < -period / 2) {
    at_ = presented.at;
    seen_ = 1;
  } else {
    seen_ = std::min(seen_ + 1, kSmoothing);
    at_ = expected + std::clamp(late, -period / 8, period / 8) / seen_;
  }
  output_period_ = period;
  refresh_ = presented.refresh;
  shown_.reset();
  // A picture drawn for one refresh may have been shown at a later one.
  if (coming_) shown_ = static_cast<std::int64_t>(presented.refresh) + shift_;
}

std::optional<std::int64_t> SynchronisedRefresh::number_at(std::uint64_t refresh, TimePoint at) {
  if (period_ns_ == 0 || !clock_.is_known) {
    is_numbered_ = false;
    return std::nullopt;
  }
  const std::int64_t t_ns = std::clamp(clock_.at(at), -kMaxShowAt_ns, kMaxShowAt_ns);
  const std::int64_t near = nearest(t_ns, period_ns_);
  const auto own = static_cast<std::int64_t>(refresh);
  if (is_numbered_ && numbered_period_ns_ == period_ns_ && std::llabs(own + shift_ - near) <= 1) {
    const std::int64_t number = own + shift_;
    const auto off_ns = static_cast<double>(t_ns - near * period_ns_) -
                        static_cast<double>(number - near) * static_cast<double>(period_ns_);
    if (std::abs(off_ns) <= (0.5 + kHold) * static_cast<double>(period_ns_)) return number;
  }
  is_numbered_ = true;
  numbered_period_ns_ = period_ns_;
  shift_ = near - own;
  return near;
}

void SynchronisedRefresh::begin(TimePoint drawing_at) {
  coming_ = seen_ == 0 ? std::nullopt : number_at(refresh_ + 1, at_ + output_period_);
  if (!coming_) return;
  drawn_ahead_ = std::chrono::nanoseconds(*coming_ * period_ns_ -
                                          std::clamp(clock_.at(drawing_at), -kMaxShowAt_ns, kMaxShowAt_ns));
}

bool SynchronisedRefresh::is_due(const ShowAt& at) const {
  if (at.period_ns == 0 || !coming_ || at.period_ns != period_ns_) return true;
  return at.refresh <= *coming_ || at.refresh - *coming_ > kMaxLead / std::chrono::nanoseconds(period_ns_);
}

}  // namespace cyclorama::display
