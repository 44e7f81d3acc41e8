// SPDX-License-Identifier: Apache-2.0
#include "common/base/frame_window.h"

#include <gtest/gtest.h>

#include <string>

namespace cyclorama {
namespace {

using Window = FrameWindow<std::string>;

std::string sent(Window* window) {
  const std::string* const request = window->send();
  return request ? *request : "nothing";
}

TEST(FrameWindow, sends_two_and_keeps_only_the_newest_of_the_rest) {
  Window window;
  EXPECT_EQ(sent(&window), "nothing");
  EXPECT_FALSE(window.put(1, "one"));
  EXPECT_EQ(sent(&window), "one");
  EXPECT_FALSE(window.put(2, "two"));
  EXPECT_EQ(sent(&window), "two");
  EXPECT_FALSE(window.put(3, "three"));
  EXPECT_FALSE(window.is_sendable());
  EXPECT_TRUE(window.put(4, "four"));
  EXPECT_EQ(sent(&window), "nothing");
  EXPECT_EQ(window.finish(1), "one");
  EXPECT_EQ(sent(&window), "four");
  EXPECT_FALSE(window.is_waiting());
  EXPECT_EQ(window.in_flight(), kFramesInFlight);
}

TEST(FrameWindow, replaces_a_waiting_request_before_it_is_sent) {
  Window window;
  window.put(1, "one");
  EXPECT_TRUE(window.put(2, "two"));
  EXPECT_EQ(sent(&window), "two");
  EXPECT_EQ(sent(&window), "nothing");
}

TEST(FrameWindow, forgets_skipped_requests) {
  Window window;
  window.add(3, "three");
  window.add(5, "five");
  EXPECT_EQ(window.skip_before(3), 0u);
  EXPECT_EQ(window.skip_before(5), 1u);
  EXPECT_EQ(window.find(3), nullptr);
  ASSERT_NE(window.find(5), nullptr);
  EXPECT_EQ(*window.find(5), "five");
  EXPECT_TRUE(window.has_room());
}

TEST(FrameWindow, finishes_only_what_is_in_flight) {
  Window window;
  window.put(1, "one");
  EXPECT_FALSE(window.finish(1).has_value()) << "it waits";
  ASSERT_EQ(sent(&window), "one");
  EXPECT_EQ(window.finish(1), "one");
  EXPECT_FALSE(window.finish(1).has_value());
  EXPECT_EQ(window.in_flight(), 0u);
}

TEST(FrameWindow, sends_the_newest_request_again_after_a_loss) {
  Window window;
  window.lose();
  EXPECT_FALSE(window.is_waiting());
  window.add(1, "one");
  window.add(2, "two");
  window.lose();
  EXPECT_EQ(window.in_flight(), 0u);
  EXPECT_EQ(sent(&window), "two");
  window.put(3, "three");
  window.lose();
  EXPECT_EQ(sent(&window), "three") << "it is newer than what was lost";
  EXPECT_EQ(sent(&window), "nothing");
}

}  // namespace
}  // namespace cyclorama
