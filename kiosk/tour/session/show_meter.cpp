// SPDX-License-Identifier: Apache-2.0
#include "kiosk/tour/session/show_meter.h"

#include <algorithm>
#include <iterator>
#include <utility>

namespace cyclorama::tour {
namespace {

// A display is late when it takes longer than this multiple of its usual time plus a refresh.
constexpr int kLateFactor = 2;

Duration duration_of(double s) { return std::chrono::duration_cast<Duration>(std::chrono::duration<double>(s)); }

std::optional<Duration> median(const Percentiles& values) {
  if (values.count() < ShowMeter::kMinFrames) return std::nullopt;
  return duration_of(values.at(0.5));
}

}  // namespace

void ShowMeter::joined(std::uint64_t display, Duration refresh_period) { screens_[display].period = refresh_period; }

void ShowMeter::left(std::uint64_t display) { screens_.erase(display); }

void ShowMeter::asked(std::uint64_t number, TimePoint now) {
  frames_[number] = {now, std::nullopt, false};
  if (frames_.size() > kMaxFrames) frames_.erase(frames_.begin());
}

void ShowMeter::ended(std::uint64_t number, TimePoint now) {
  const auto frame = frames_.find(number);
  if (frame != frames_.end() && !frame->second.ended_at) frame->second.ended_at = now;
}

bool ShowMeter::presented(std::uint64_t display, std::uint64_t number, Duration drawing, TimePoint now) {
  const auto screen = screens_.find(display);
  const auto frame = frames_.find(number);
  // A refined picture has its view's number and is not counted again.
  if (screen == screens_.end() || frame == frames_.end() || number <= screen->second.reported) return false;
  Screen& shown = screen->second;
  shown.reported = number;
  const Duration latency = std::clamp(now - frame->second.asked_at, Duration::zero(), kMaxLatency);
  shown.latency_s.add(to_seconds(latency));
  shown.drawing_s.add(to_seconds(std::clamp(drawing, Duration::zero(), latency)));
  if (frame->second.ended_at) shown.own_s.add(to_seconds(std::min(now - *frame->second.ended_at, kMaxLatency)));
  if (shown.presented_at) {
    const Duration gap = now - *shown.presented_at;
    if (gap > Duration::zero() && gap <= kMaxInterval) shown.interval_s.add(to_seconds(gap));
  }
  shown.presented_at = now;
  return !std::exchange(frame->second.is_presented, true);
}

std::optional<Duration> ShowMeter::not_shown(std::uint64_t display, std::uint64_t number) {
  const auto screen = screens_.find(display);
  const auto frame = frames_.find(number);
  if (screen == screens_.end() || frame == frames_.end()) return std::nullopt;
  screen->second.reported = std::max(screen->second.reported, number);
  if (!frame->second.ended_at || frame->second.is_presented) return std::nullopt;
  const auto next = std::next(frame);
  return next == frames_.end() ? Duration::zero() : next->second.asked_at - frame->second.asked_at;
}

std::optional<Duration> ShowMeter::latency() const {
  std::optional<Duration> slowest;
  for (const auto& [display, screen] : screens_) slowest = std::max(slowest, median(screen.latency_s));
  return slowest;
}

std::optional<Duration> ShowMeter::interval() const {
  std::optional<Duration> slowest;
  for (const auto& [display, screen] : screens_) slowest = std::max(slowest, median(screen.interval_s));
  return slowest;
}

Duration ShowMeter::ahead(Duration heading_lead) const {
  Duration ahead = Duration::zero();
  for (const auto& [display, screen] : screens_) {
    const auto latency = median(screen.latency_s);
    const auto interval = median(screen.interval_s);
    if (!latency || !interval) continue;
    const Duration pose_lead = std::max(heading_lead, *median(screen.drawing_s));
    ahead = std::max(ahead, std::max(*latency - pose_lead, Duration::zero()) + *interval / 2);
  }
  return ahead;
}

Duration ShowMeter::refresh_period() const {
  Duration slowest = Duration::zero();
  for (const auto& [display, screen] : screens_) slowest = std::max(slowest, screen.period);
  return slowest;
}

bool ShowMeter::is_late(const Screen& screen, TimePoint now) const {
  const auto own = median(screen.own_s);
  if (!own) return false;
  const auto owed = std::find_if(frames_.upper_bound(screen.reported), frames_.end(),
                                 [](const auto& frame) { return frame.second.ended_at.has_value(); });
  if (owed == frames_.end()) return false;
  const Duration waited = now - *owed->second.ended_at;
  return waited > kLateFactor * *own + screen.period && waited <= kMaxInterval;
}

bool ShowMeter::are_displays_late(TimePoint now) const {
  return !screens_.empty() &&
         std::ranges::all_of(screens_, [&](const auto& screen) { return is_late(screen.second, now); });
}

}  // namespace cyclorama::tour
