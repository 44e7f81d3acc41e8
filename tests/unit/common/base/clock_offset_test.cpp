// SPDX-License-Identifier: Apache-2.0
// Offset of two clocks, from exchanges that are late, asymmetric, lost, damaged or of a clock that was stepped.
#include "common/base/clock_offset.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

namespace cyclorama {
namespace {

using namespace std::chrono_literals;

constexpr std::int64_t kMinTime = std::numeric_limits<std::int64_t>::min();
constexpr std::int64_t kMaxTime = std::numeric_limits<std::int64_t>::max();

/// The other clock: `ahead` of ours at our time 1000 s, and faster by `ppm`.
struct Peer {
  Duration ahead{};
  double ppm = 0.0;

  [[nodiscard]] std::int64_t at(TimePoint ours) const {
    const Duration passed = ours - TimePoint(1000s);
    const auto drift =
        std::chrono::duration_cast<Duration>(std::chrono::duration<double>(to_seconds(passed) * ppm * 1e-6));
    return to_nanoseconds(ours + drift + ahead);
  }
  [[nodiscard]] ClockExchange exchange(TimePoint asked, Duration there, Duration back, Duration held = 50us) const {
    const TimePoint received = asked + there;
    return {asked, at(received), at(received + held), received + held + back};
  }
};

/// Error of the reading in nanoseconds.
double off_ns(const ClockOffset& offset, const Peer& peer, TimePoint now) {
  const ClockReading reading = offset.reading(now);
  EXPECT_TRUE(reading.is_known);
  return static_cast<double>(reading.at(now) - peer.at(now));
}

TEST(ClockOffset, is_unknown_before_the_first_answer) {
  EXPECT_FALSE(ClockOffset().reading(TimePoint(1000s)).is_known);
}

TEST(ClockOffset, is_exact_when_both_ways_take_equally_long) {
  const Peer peer{-73h};
  ClockOffset offset;
  ASSERT_TRUE(offset.add(peer.exchange(TimePoint(1000s), 3ms, 3ms)));
  EXPECT_NEAR(off_ns(offset, peer, TimePoint(1000s)), 0.0, 2.0);
}

TEST(ClockOffset, is_within_its_stated_uncertainty_for_any_asymmetry) {
  const Peer peer{12345ms};
  std::mt19937 random(1);
  std::exponential_distribution<double> delay_ms(0.5);
  for (int run = 0; run < 200; ++run) {
    ClockOffset offset;
    TimePoint now(1000s);
    for (int n = 0; n < 100; ++n) {
      const auto some = [&] { return std::chrono::microseconds(static_cast<int>(1e3 * delay_ms(random))); };
      // The delay is all in one direction, all in the other, or in both.
      const Duration there = run % 3 == 0 ? 0us : some();
      const Duration back = run % 3 == 1 ? 0us : some();
      ASSERT_TRUE(offset.add(peer.exchange(now, there, back)));
      now += 250ms;
      const ClockReading reading = offset.reading(now);
      ASSERT_LE(std::abs(off_ns(offset, peer, now)), static_cast<double>(reading.error.count()));
    }
    // One of the last exchanges was fast.
    EXPECT_LT(offset.reading(now).error, 2ms);
  }
}

TEST(ClockOffset, prefers_the_fastest_exchange) {
  const Peer peer{5s};
  ClockOffset offset;
  ASSERT_TRUE(offset.add(peer.exchange(TimePoint(1000s), 100us, 120us)));
  for (int n = 1; n < 20; ++n) ASSERT_TRUE(offset.add(peer.exchange(TimePoint(1000s) + n * 250ms, 300us, 80ms)));
  EXPECT_NEAR(off_ns(offset, peer, TimePoint(1005s)), 0.0, 11e3);
}

TEST(ClockOffset, follows_a_clock_that_drifts_by_100_ppm_for_a_day) {
  for (const double ppm : {-99.0, 99.0}) {
    const Peer peer{1h, ppm};
    ClockOffset offset;
    std::mt19937 random(2);
    std::uniform_int_distribution<int> delay_us(100, 400);
    TimePoint now(1000s);
    for (int n = 0; n < 4 * 86400; ++n) {
      ASSERT_TRUE(offset.add(peer.exchange(now, std::chrono::microseconds(delay_us(random)),
                                           std::chrono::microseconds(delay_us(random)))));
      now += 250ms;
      if (n % 100 != 0) continue;
      ASSERT_LE(std::abs(off_ns(offset, peer, now)), 400e3) << n;
    }
  }
}

TEST(ClockOffset, follows_a_certain_step_at_once) {
  const Peer before{0s};
  const Peer after{-20ms};
  ClockOffset offset;
  TimePoint now(1000s);
  for (int n = 0; n < 50; ++n, now += 250ms) offset.add(before.exchange(now, 100us, 100us));
  offset.add(after.exchange(now, 9ms, 9ms));
  EXPECT_NEAR(off_ns(offset, after, now), 0.0, 10e6);
  // A step within the round trip's uncertainty is not detected: the old offset stays until a fast exchange shows the
  // step.
  const Peer again{-25ms};
  offset.add(again.exchange(now, 9ms, 9ms));
  offset.add(again.exchange(now, 50us, 50us));
  EXPECT_NEAR(off_ns(offset, again, now), 0.0, 1e3);
}

TEST(ClockOffset, becomes_less_certain_while_answers_are_lost_and_stays_right) {
  const Peer peer{0s, 50.0};
  ClockOffset offset;
  ASSERT_TRUE(offset.add(peer.exchange(TimePoint(1000s), 100us, 100us)));
  const TimePoint later(1100s);
  EXPECT_LE(std::abs(off_ns(offset, peer, later)), static_cast<double>(offset.reading(later).error.count()));
  EXPECT_GT(offset.reading(later).error, 10ms);
}

TEST(ClockOffset, ignores_invalid_answers) {
  const TimePoint asked(1000s);
  const TimePoint heard(1001s);
  ClockOffset offset;
  EXPECT_FALSE(offset.add({asked, 5, 4, heard})) << "answered before it was received";
  EXPECT_FALSE(offset.add({asked, kMaxTime, kMinTime + 10, asked - 1ns})) << "heard before it was asked";
  EXPECT_FALSE(offset.add({asked, 0, 2'000'000'000, heard})) << "held longer than it was away";
  EXPECT_FALSE(offset.add({asked, kMinTime, kMaxTime, heard}));
  EXPECT_FALSE(offset.add({asked, 0, 0, asked + 3s})) << "too long away to tell anything";
  EXPECT_EQ(offset.count(), 0U);
  EXPECT_FALSE(offset.reading(heard).is_known);
}

TEST(ClockOffset, handles_overflow_of_the_other_clock) {
  const TimePoint asked(1000s);
  ClockOffset offset;
  // Received just before the other clock's count overflows, answered after it.
  ASSERT_TRUE(offset.add({asked, kMaxTime - 9, kMinTime + 10, asked + 20ns}));
  const ClockReading reading = offset.reading(asked + 20ns);
  EXPECT_EQ(reading.at(asked + 20ns), kMinTime + 10);
  EXPECT_EQ(reading.at(asked), kMaxTime - 9);
  for (const std::int64_t theirs : {kMinTime, kMaxTime, std::int64_t{0}, std::int64_t{-1}}) {
    offset.reset();
    ASSERT_TRUE(offset.add({asked, theirs, theirs, asked}));
    EXPECT_EQ(offset.reading(asked).at(asked), theirs);
  }
}

}  // namespace
}  // namespace cyclorama
