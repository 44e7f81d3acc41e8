// SPDX-License-Identifier: Apache-2.0
#include "common/base/clock_offset.h"

#include <algorithm>

namespace cyclorama {
namespace {
constexpr Duration kMaxRoundTrip = std::chrono::seconds(2);
constexpr int kDriftDivisor = 10'000;  // 100 ppm.
}  // namespace

Duration ClockOffset::error_at(const Sample& sample, TimePoint now) {
  return sample.half_trip + std::max(now - sample.heard, Duration::zero()) / kDriftDivisor;
}

bool ClockOffset::add(const ClockExchange& exchange) {
  const Duration away = exchange.heard - exchange.asked;
  const std::uint64_t held =
      static_cast<std::uint64_t>(exchange.answered_ns) - static_cast<std::uint64_t>(exchange.received_ns);
  if (away < Duration::zero() || away > kMaxRoundTrip) return false;
  const auto away_ns = static_cast<std::uint64_t>(away.count());
  // Also true if the answer was sent before the request arrived: the unsigned difference is then huge.
  if (held > away_ns) return false;
  const std::uint64_t half_trip_ns = (away_ns - held) / 2;
  const auto heard_ns = static_cast<std::uint64_t>(to_nanoseconds(exchange.heard));
  const Sample sample{static_cast<std::uint64_t>(exchange.answered_ns) + half_trip_ns - heard_ns,
                      // Plus one, because the division rounds down.
                      std::chrono::nanoseconds(half_trip_ns + 1), exchange.heard};
  if (const ClockReading known = reading(sample.heard); known.is_known) {
    const auto apart = static_cast<std::int64_t>(sample.offset_ns - known.offset_ns);
    const std::int64_t max = (known.error + sample.half_trip).count();
    if (apart > max || apart < -max) kept_ = next_ = 0;
  }
  samples_[next_] = sample;
  next_ = (next_ + 1) % kWindow;
  kept_ = std::min(kept_ + 1, kWindow);
  ++count_;
  return true;
}

ClockReading ClockOffset::reading(TimePoint now) const {
  ClockReading reading;
  for (std::size_t i = 0; i < kept_; ++i) {
    const Duration error = error_at(samples_[i], now);
    if (!reading.is_known || error < reading.error) reading = {true, samples_[i].offset_ns, error};
  }
  return reading;
}

}  // namespace cyclorama
