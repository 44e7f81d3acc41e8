// SPDX-License-Identifier: Apache-2.0
#include "common/base/latest_value.h"

#include <gtest/gtest.h>

#include <memory>
#include <thread>

namespace cyclorama {
namespace {

TimePoint soon() { return SteadyClock().now() + std::chrono::seconds(5); }

TEST(LatestValue, keeps_the_newest_value_and_put_reports_a_dropped_one) {
  LatestValue<int> slot;
  EXPECT_FALSE(slot.put(1));
  EXPECT_TRUE(slot.put(2));
  EXPECT_EQ(slot.take(), 2);
  EXPECT_EQ(slot.take(), std::nullopt);
}

TEST(LatestValue, accepts_move_only_values) {
  LatestValue<std::unique_ptr<int>> slot;
  slot.put(std::make_unique<int>(7));
  EXPECT_EQ(**slot.take(), 7);
}

TEST(LatestValue, wakes_a_waiting_thread) {
  LatestValue<int> slot;
  std::jthread other([&] { slot.put(3); });
  EXPECT_EQ(slot.take_before(soon()), 3);
}

TEST(LatestValue, stops_waiting_at_the_deadline) {
  LatestValue<int> slot;
  EXPECT_EQ(slot.take_before(SteadyClock().now()), std::nullopt);
}

TEST(LatestValue, closing_wakes_a_waiter_and_keeps_the_last_value) {
  LatestValue<int> slot;
  std::jthread other([&] { slot.close(); });
  EXPECT_EQ(slot.take_before(soon()), std::nullopt);
  slot.put(4);
  EXPECT_TRUE(slot.is_closed());
  EXPECT_EQ(slot.take_before(soon()), 4);
}

}  // namespace
}  // namespace cyclorama
