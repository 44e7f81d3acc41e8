// SPDX-License-Identifier: Apache-2.0
#include "kiosk/tour/session/show_meter.h"

#include <gtest/gtest.h>

#include <map>

namespace cyclorama::tour {
namespace {

using namespace std::chrono_literals;

constexpr Duration kRefresh = 16667us;
constexpr std::uint64_t kWall = 1;
constexpr std::uint64_t kSide = 2;

/// Shows `count` frames, `interval` apart; each display presents a frame its own time after the request.
struct Meter {
  ShowMeter meter;
  TimePoint now{100s};
  std::uint64_t number = 0;

  void show(int count, Duration interval, const std::map<std::uint64_t, Duration>& latencies,
            Duration drawing = Duration::zero()) {
    for (int i = 0; i < count; ++i) {
      meter.asked(++number, now);
      meter.ended(number, now + 10ms);
      for (const auto& [display, latency] : latencies) meter.presented(display, number, drawing, now + latency);
      now += interval;
    }
  }
};

TEST(ShowMeter, concludes_nothing_before_some_frames_were_shown) {
  Meter m;
  EXPECT_EQ(m.meter.ahead(0s), 0s);
  m.meter.joined(kWall, kRefresh);
  m.show(2, 100ms, {{kWall, 80ms}});
  EXPECT_FALSE(m.meter.latency());
  EXPECT_FALSE(m.meter.interval());
  m.show(1, 100ms, {{kWall, 80ms}});
  EXPECT_EQ(m.meter.latency(), 80ms);
  EXPECT_EQ(m.meter.ahead(0s), 0s) << "two gaps are not enough";
  m.show(1, 100ms, {{kWall, 80ms}});
  EXPECT_EQ(m.meter.interval(), 100ms);
  EXPECT_EQ(m.meter.ahead(0s), 80ms + 50ms);
}

TEST(ShowMeter, predicts_no_farther_than_the_pose_that_is_drawn_with_the_frame) {
  Meter m;
  m.meter.joined(kWall, kRefresh);
  m.show(9, 100ms, {{kWall, 80ms}}, 30ms);
  EXPECT_EQ(m.meter.ahead(0s), 50ms + 50ms);
  EXPECT_EQ(m.meter.ahead(42ms), 38ms + 50ms) << "synchronised displays show poses later";
  EXPECT_EQ(m.meter.ahead(10s), 50ms);
}

TEST(ShowMeter, ignores_single_late_frames_rests_and_refined_pictures) {
  Meter m;
  m.meter.joined(kWall, kRefresh);
  m.show(9, 100ms, {{kWall, 80ms}});
  m.show(1, 700ms, {{kWall, 600ms}});
  for (int i = 1; i < 20; ++i) EXPECT_FALSE(m.meter.presented(kWall, m.number, 0s, m.now + i * 300ms)) << "refined";
  m.now += 1h;
  m.show(3, 100ms, {{kWall, 80ms}});
  EXPECT_EQ(m.meter.latency(), 80ms);
  EXPECT_EQ(m.meter.interval(), 100ms);
}

TEST(ShowMeter, follows_a_farm_that_becomes_slower) {
  Meter m;
  m.meter.joined(kWall, kRefresh);
  m.show(100, 50ms, {{kWall, 80ms}});
  m.show(8, 200ms, {{kWall, 400ms}});
  EXPECT_EQ(m.meter.latency(), 400ms);
}

TEST(ShowMeter, takes_the_slowest_of_several_displays) {
  Meter m;
  m.meter.joined(kWall, kRefresh);
  m.meter.joined(kSide, 50ms);
  EXPECT_EQ(m.meter.refresh_period(), 50ms);
  m.show(9, 100ms, {{kWall, 80ms}, {kSide, 150ms}});
  EXPECT_EQ(m.meter.latency(), 150ms);
  EXPECT_EQ(m.meter.ahead(0s), 200ms);
  m.meter.left(kSide);
  EXPECT_EQ(m.meter.latency(), 80ms);
  EXPECT_EQ(m.meter.refresh_period(), kRefresh);
}

TEST(ShowMeter, is_bounded_whatever_displays_and_clocks_report) {
  Meter m;
  EXPECT_EQ(m.meter.refresh_period(), 0s);
  m.meter.joined(kWall, kRefresh);
  m.show(20, 100ms, {{kWall, 3600s}}, 1h);
  EXPECT_EQ(m.meter.latency(), ShowMeter::kMaxLatency);
  EXPECT_GE(m.meter.ahead(0s), 0s);
  m.show(20, 0ms, {{kWall, -1h}}, -1h);
  EXPECT_EQ(m.meter.latency(), 0ms);
  EXPECT_GE(m.meter.ahead(0s), 0s);
  EXPECT_FALSE(m.meter.presented(kWall, 1'000'000, 0s, m.now)) << "never requested";
  EXPECT_FALSE(m.meter.presented(77, m.number, 0s, m.now)) << "a display that is not here";
}

TEST(ShowMeter, counts_a_frame_as_not_shown_if_it_was_complete_and_nobody_showed_it) {
  Meter m;
  m.meter.joined(kWall, kRefresh);
  m.meter.joined(kSide, kRefresh);
  for (std::uint64_t number = 1; number <= 3; ++number) m.meter.asked(number, m.now + number * 70ms);
  m.meter.ended(2, m.now);
  m.meter.ended(3, m.now);
  EXPECT_FALSE(m.meter.not_shown(kWall, 1)) << "the farm gave it up";
  EXPECT_EQ(m.meter.not_shown(kWall, 2), 70ms) << "this soon the next one was requested";
  EXPECT_EQ(m.meter.not_shown(kWall, 3), 0ms) << "none was";
  EXPECT_TRUE(m.meter.presented(kSide, 3, 0s, m.now));
  EXPECT_FALSE(m.meter.presented(kWall, 3, 0s, m.now)) << "counted already";
  EXPECT_FALSE(m.meter.not_shown(kWall, 3)) << "the other display showed it";
  EXPECT_FALSE(m.meter.not_shown(kWall, 99));
}

TEST(ShowMeter, finds_displays_late_only_while_all_of_them_owe_a_frame_for_long) {
  Meter m;
  m.meter.joined(kWall, 50ms);
  EXPECT_FALSE(m.meter.are_displays_late(m.now));
  m.show(9, 100ms, {{kWall, 40ms}});
  m.meter.asked(++m.number, m.now);
  m.meter.ended(m.number, m.now);
  EXPECT_FALSE(m.meter.are_displays_late(m.now + 100ms));
  EXPECT_TRUE(m.meter.are_displays_late(m.now + 150ms)) << "usually 30 ms";
  m.meter.joined(kSide, 50ms);
  EXPECT_FALSE(m.meter.are_displays_late(m.now + 150ms)) << "one that is slow delays nobody";
  m.meter.left(kSide);
  EXPECT_FALSE(m.meter.are_displays_late(m.now + 5s)) << "it may never come";
  EXPECT_TRUE(m.meter.are_displays_late(m.now + 150ms));
  m.meter.not_shown(kWall, m.number);
  EXPECT_FALSE(m.meter.are_displays_late(m.now + 150ms));
}

}  // namespace
}  // namespace cyclorama::tour
