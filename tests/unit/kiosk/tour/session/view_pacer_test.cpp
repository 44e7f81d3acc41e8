// SPDX-License-Identifier: Apache-2.0
#include "kiosk/tour/session/view_pacer.h"

#include <gtest/gtest.h>

namespace cyclorama::tour {
namespace {

using namespace std::chrono_literals;

wire::View view(std::uint64_t number, double heading, std::int64_t shutter_ns = 0) {
  wire::View view;
  view.set_number(number);
  view.set_heading_rad(heading);
  view.set_shutter_ns(shutter_ns);
  return view;
}

TEST(ViewPacer, requests_new_views_at_once_and_old_ones_once_a_second) {
  ViewPacer pacer(false);
  const TimePoint now(10s);
  EXPECT_TRUE(pacer.wants(view(1, 0.0), now));
  pacer.asked(view(1, 0.0), now);
  EXPECT_FALSE(pacer.wants(view(2, 0.0), now + 999ms));
  EXPECT_FALSE(pacer.wants(view(2, 0.0, 12345), now + 999ms)) << "a new picture of a still tag";
  EXPECT_TRUE(pacer.wants(view(2, 0.0), now + 1s));
  EXPECT_TRUE(pacer.wants(view(2, 1e-6), now + 1ms));
}

TEST(ViewPacer, requests_nothing_from_a_refining_farm_until_a_display_needs_the_picture) {
  ViewPacer pacer(true);
  const TimePoint now(10s);
  EXPECT_TRUE(pacer.wants(view(1, 0.0), now));
  pacer.asked(view(1, 0.0), now);
  pacer.ended(1);
  EXPECT_FALSE(pacer.wants(view(2, 0.0), now + 1h));
  EXPECT_TRUE(pacer.wants(view(2, 1e-6), now + 1ms));
  pacer.request_again();
  EXPECT_TRUE(pacer.wants(view(2, 0.0), now + 1h));
  pacer.asked(view(2, 0.0), now + 1h);
  EXPECT_FALSE(pacer.wants(view(3, 0.0), now + 2h));
}

TEST(ViewPacer, keeps_at_most_two_frames_in_flight) {
  ViewPacer pacer(false);
  const TimePoint now(10s);
  pacer.asked(view(1, 0.1), now);
  pacer.asked(view(2, 0.2), now);
  EXPECT_FALSE(pacer.wants(view(3, 0.3), now + 5s));
  pacer.ended(1);
  EXPECT_TRUE(pacer.wants(view(3, 0.3), now));
}

TEST(ViewPacer, keeps_views_a_refresh_apart_so_that_each_frame_can_be_shown) {
  ViewPacer pacer(true);
  const TimePoint now(10s);
  EXPECT_TRUE(pacer.is_due(now));
  EXPECT_FALSE(pacer.due_at());
  pacer.set_refresh_period(50ms);
  EXPECT_GE(pacer.interval(), 50ms);
  EXPECT_LT(pacer.interval(), 60ms);
  pacer.asked(view(1, 0.1), now);
  EXPECT_EQ(pacer.due_at(), now + pacer.interval());
  EXPECT_FALSE(pacer.wants(view(2, 0.2), *pacer.due_at() - 1ns));
  EXPECT_TRUE(pacer.wants(view(2, 0.2), *pacer.due_at()));
  pacer.asked(view(2, 0.2), now + 100ms);
  EXPECT_FALSE(pacer.due_at()) << "two are in flight";
  pacer.ended(1);
  pacer.request_again();
  EXPECT_TRUE(pacer.is_due(now + 101ms)) << "a display that joined need not wait";
}

TEST(ViewPacer, waits_longer_after_frames_that_were_not_shown_within_bounds) {
  ViewPacer pacer(true);
  pacer.set_refresh_period(50ms);
  for (int i = 0; i < 10000; ++i) pacer.shown();
  EXPECT_EQ(pacer.interval(), 50ms) << "no display shows more";
  Duration before = pacer.interval();
  for (int i = 0; i < 10; ++i) {
    pacer.not_shown(0s);
    EXPECT_GT(pacer.interval(), before);
    before = pacer.interval();
  }
  for (int i = 0; i < 99; ++i) pacer.shown();
  pacer.not_shown(0s);
  EXPECT_NEAR(to_milliseconds(pacer.interval()), to_milliseconds(before), 0.1) << "one in a hundred";
  pacer.not_shown(pacer.interval() + 7ms);
  EXPECT_NEAR(to_milliseconds(pacer.interval()), to_milliseconds(before) * 1.04, 7.0) << "so long was too short";
  before = pacer.interval();
  pacer.not_shown(1h);
  EXPECT_NEAR(to_milliseconds(pacer.interval()), 1.5 * to_milliseconds(before), 1e-3)
      << "a farm's pause is no interval";
  for (int i = 0; i < 1000; ++i) pacer.not_shown(0s);
  EXPECT_EQ(pacer.interval(), ViewPacer::kMaxInterval);
  pacer.set_refresh_period(50ms);
  EXPECT_EQ(pacer.interval(), ViewPacer::kMaxInterval);
  pacer.set_refresh_period(20ms);
  EXPECT_LT(pacer.interval(), 25ms) << "another display";
}

TEST(ViewPacer, counts_views_that_the_farm_skipped) {
  ViewPacer pacer(false);
  pacer.asked(view(1, 0.1), TimePoint(1s));
  pacer.asked(view(2, 0.2), TimePoint(1s));
  EXPECT_EQ(pacer.began(2), 1u);
  EXPECT_EQ(pacer.in_flight(), 1u);
  pacer.ended(2);
  EXPECT_EQ(pacer.in_flight(), 0u);
}

TEST(ViewPacer, keeps_the_newest_in_flight_when_the_farm_is_lost) {
  ViewPacer pacer(false);
  pacer.lost();
  pacer.asked(view(1, 0.1), TimePoint(1s));
  pacer.asked(view(2, 0.2), TimePoint(1s));
  pacer.lost();
  EXPECT_EQ(pacer.in_flight(), 1u);
  EXPECT_EQ(pacer.began(2), 0u);
}

}  // namespace
}  // namespace cyclorama::tour
