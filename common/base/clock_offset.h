// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>

#include "common/base/clock.h"

namespace cyclorama {

/// One exchange of times with another computer: a request and its answer, with two times of each clock.
struct ClockExchange {
  TimePoint asked{};             ///< Sending of the request, on this computer's clock.
  std::int64_t received_ns = 0;  ///< Arrival of the request, on the other clock.
  std::int64_t answered_ns = 0;
  TimePoint heard{};  ///< Arrival of the answer, on this computer's clock.
};

/// Relation of another clock to this computer's clock. A value that may cross threads.
struct ClockReading {
  bool is_known = false;
  std::uint64_t offset_ns = 0;  ///< The other clock's time minus this clock's, modulo 2^64.
  Duration error{};             ///< Upper bound of the offset's error.

  /// Returns the other clock's time in nanoseconds when this clock shows `ours`. Precondition: is_known.
  [[nodiscard]] std::int64_t at(TimePoint ours) const {
    return static_cast<std::int64_t>(static_cast<std::uint64_t>(to_nanoseconds(ours)) + offset_ns);
  }
};

/// Estimates the offset of another computer's CLOCK_MONOTONIC from this computer's, from the four times of each
/// exchange, as NTP does (RFC 5905, section 8).
///
/// 1. However long each direction of an exchange took, the offset differs from the middle by at most half the
///    round trip.
/// 2. Clocks drift apart by at most 100 ppm: crystals are better, and chrony adjusts a running clock no faster. An
///    exchange therefore becomes less certain with its age, and the one that is now the most certain is used.
/// 3. Two exchanges that contradict each other prove that a clock was stepped, or stood still while its computer was
///    suspended: then only the newer exchange counts.
///
/// Accepts any times and ignores implausible ones. Thread-bound; allocates nothing.
class ClockOffset {
 public:
  /// Returns false if the exchange is implausible and was ignored.
  bool add(const ClockExchange& exchange);
  /// Discards all exchanges, for example to continue with another computer.
  void reset() { *this = {}; }
  /// Returns the offset with its uncertainty at `now`.
  [[nodiscard]] ClockReading reading(TimePoint now) const;
  /// Number of exchanges accepted.
  [[nodiscard]] std::uint64_t count() const { return count_; }

 private:
  struct Sample {
    std::uint64_t offset_ns = 0;
    Duration half_trip{};
    TimePoint heard{};
  };
  static constexpr std::size_t kWindow = 64;
  static Duration error_at(const Sample& sample, TimePoint now);

  std::array<Sample, kWindow> samples_{};
  std::size_t kept_ = 0;
  std::size_t next_ = 0;
  std::uint64_t count_ = 0;
};

}  // namespace cyclorama
