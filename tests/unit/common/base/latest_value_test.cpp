// SPDX-License-Identifier: Apache-2.0
#include "common/base/latest_value.h"

#include <gtest/gtest.h>

#include <memory>
#include <thread>

namespace cyclorama {
namespace {

TimePoint soon() { return SteadyClock().now() + std::chrono::seconds(5); }

TEST(LatestValue, the_newest_wins_and_put_tells_of_the_dropped_one) {
  LatestValue<int> slot;
  EXPECT_FALSE(slot.put(1));
  EXPECT_TRUE(slot.put(2));
  EXPECT_EQ(slot.take(), 2);
  EXPECT_EQ(slot.take(), std::nullopt);
}

TEST(LatestValue, carries_what_can_only_move) {
  LatestValue<std::unique_ptr<int>> slot;
  slot.put(std::make_unique<int>(7));
  EXPECT_EQ(**slot.take(), 7);
}

TEST(LatestValue, a_waiter_gets_what_another_thread_puts) {
  LatestValue<int> slot;
  std::jthread other([&] { slot.put(3); });
  EXPECT_EQ(slot.take_before(soon()), 3);
}

TEST(LatestValue, waiting_ends_at_the_deadline) {
  LatestValue<int> slot;
  EXPECT_EQ(slot.take_before(SteadyClock().now()), std::nullopt);
}

TEST(LatestValue, closing_wakes_a_waiter_and_leaves_the_last_value) {
  LatestValue<int> slot;
  std::jthread other([&] { slot.close(); });
  EXPECT_EQ(slot.take_before(soon()), std::nullopt);
  slot.put(4);
  EXPECT_TRUE(slot.is_closed());
  EXPECT_EQ(slot.take_before(soon()), 4);
}

}  // namespace
}  // namespace cyclorama
