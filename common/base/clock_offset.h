// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>

#include "common/base/clock.h"

namespace cyclorama {

/// A question about another computer's time and its answer: two times of each clock.
struct ClockExchange {
  TimePoint asked{};             ///< On our clock.
  std::int64_t received_ns = 0;  ///< On theirs.
  std::int64_t answered_ns = 0;
  TimePoint heard{};  ///< On ours.
};

/// What another clock shows when ours shows something. A value that may cross threads.
struct ClockReading {
  bool is_known = false;
  std::uint64_t offset_ns = 0;  ///< Theirs minus ours, modulo 2^64.
  Duration error{};             ///< The offset is not farther off than this.

  /// Precondition: is_known.
  [[nodiscard]] std::int64_t at(TimePoint ours) const {
    return static_cast<std::int64_t>(static_cast<std::uint64_t>(to_nanoseconds(ours)) + offset_ns);
  }
};

/// How far another computer's CLOCK_MONOTONIC is from ours, by four times per exchange (NTP's way, RFC 5905 section 8).
///
/// 1. Whatever the two ways of an exchange took, the offset is within half its round trip of the middle.
/// 2. Clocks drift apart by at most 100 ppm: crystals are better, and chrony turns a clock no faster once it runs. So
///    an exchange grows less sure with its age, and the one that is surest now decides.
/// 3. Two exchanges that cannot both be true prove that a clock was stepped or stood still (a computer that slept):
///    then only the newer one counts.
///
/// All times may be anything: what makes no sense is left out. Thread-bound; allocates nothing.
class ClockOffset {
 public:
  /// False when the exchange makes no sense and was left out.
  bool add(const ClockExchange& exchange);
  /// Forgets everything: another computer.
  void reset() { *this = {}; }
  /// As sure as it is at `now`.
  [[nodiscard]] ClockReading reading(TimePoint now) const;
  /// Exchanges that were taken.
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
