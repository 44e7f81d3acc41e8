// SPDX-License-Identifier: Apache-2.0
// Objects that pass between threads: the slot, the ring and the pool.
#include <gtest/gtest.h>

#include <future>
#include <thread>

#include "appliance/display/atomic_slot.h"
#include "appliance/display/decode_pool.h"
#include "appliance/display/event_ring.h"
#include "appliance/display/newest_value.h"
#include "appliance/display/recent_headings.h"
#include "appliance/display/waiting_frames.h"

namespace cyclorama::display {
namespace {

TEST(AtomicSlot, returns_every_value_exactly_once_to_either_side) {
  AtomicSlot<int> slot;
  EXPECT_TRUE(slot.is_empty());
  constexpr int kValues = 20000;
  std::vector<int> seen(kValues, 0);
  std::vector<int> returned(kValues, 0);
  std::atomic<bool> done{false};
  std::jthread taker([&] {
    while (!done || !slot.is_empty()) {
      if (const auto value = slot.take()) ++seen[static_cast<std::size_t>(*value)];
    }
  });
  for (int n = 0; n < kValues; ++n) {
    if (const auto old = slot.put(std::make_unique<int>(n))) ++returned[static_cast<std::size_t>(*old)];
  }
  done = true;
  taker.join();
  for (std::size_t n = 0; n < kValues; ++n) ASSERT_EQ(seen[n] + returned[n], 1) << n;
  EXPECT_EQ(seen[kValues - 1], 1);
}

TEST(NewestValue, returns_the_newest_value_untorn_and_once) {
  struct Pair {
    int a = 0;
    int b = 0;
  };
  NewestValue<Pair> slot;
  Pair seen;
  EXPECT_FALSE(slot.take(&seen));
  constexpr int kValues = 50000;
  std::jthread producer([&] {
    for (int n = 1; n <= kValues; ++n) slot.put({n, -n});
  });
  while (seen.a < kValues) {
    const int before = seen.a;
    if (!slot.take(&seen)) continue;
    ASSERT_GT(seen.a, before);
    ASSERT_EQ(seen.b, -seen.a);
  }
  EXPECT_FALSE(slot.take(&seen));
}

TEST(EventRing, keeps_the_order_and_counts_events_that_do_not_fit) {
  EventRing<int, 4> ring;
  for (int n = 0; n < 6; ++n) ring.push(n);
  EXPECT_EQ(ring.lost(), 2U);
  for (int n = 0; n < 4; ++n) EXPECT_EQ(ring.pop(), n);
  EXPECT_EQ(ring.pop(), std::nullopt);

  EventRing<int, 64> busy;
  std::jthread producer([&] {
    for (int n = 0; n < 50000; ++n) busy.push(n);
    busy.push(-1);
    while (busy.lost() != 0 && busy.pop() == std::nullopt) return;
  });
  producer.join();
  int previous = -1;
  int popped = 0;
  for (auto value = busy.pop(); value; value = busy.pop(), ++popped) {
    if (*value < 0) break;
    EXPECT_GT(*value, previous);
    previous = *value;
  }
  EXPECT_GT(popped, 0);
}

TEST(EventRing, passes_events_between_two_threads) {
  EventRing<int, 8> ring;
  constexpr int kEvents = 20000;
  std::atomic<bool> done{false};
  std::jthread producer([&] {
    for (int n = 1; n <= kEvents; ++n) ring.push(n);
    done = true;
  });
  int previous = 0;
  std::uint64_t popped = 0;
  for (;;) {
    const bool was_done = done;
    const auto value = ring.pop();
    if (!value && was_done) break;
    if (!value) continue;
    ASSERT_GT(*value, previous);
    previous = *value;
    ++popped;
  }
  EXPECT_EQ(popped + ring.lost(), static_cast<std::uint64_t>(kEvents));
}

TEST(WaitingFrames, returns_every_frame_exactly_once_to_either_side) {
  WaitingFrames waiting;
  constexpr std::size_t kFrames = 20000;
  std::vector<int> outcomes(kFrames + 1, 0);
  std::atomic<bool> done{false};
  std::vector<std::uint64_t> taken;
  std::jthread taker([&] {
    for (;;) {
      const bool was_done = done;
      const auto frame = waiting.take();
      if (frame == nullptr && was_done) break;
      if (frame != nullptr) taken.push_back(frame->order);
    }
  });
  for (std::size_t n = 1; n <= kFrames; ++n) {
    auto frame = std::make_unique<DisplayFrame>();
    frame->order = n;
    if (const auto old = waiting.put(std::move(frame))) ++outcomes[old->order];
  }
  done = true;
  taker.join();
  for (const std::uint64_t order : taken) ++outcomes[order];
  for (std::size_t n = 1; n <= kFrames; ++n) ASSERT_EQ(outcomes[n], 1) << n;
}

TEST(HeadingTrack, keeps_the_newest_heading_and_earlier_ones) {
  HeadingTrack track;
  RecentHeadings recent;
  EXPECT_FALSE(track.take(&recent));
  for (int n = 1; n <= 3; ++n) track.put({0.1 * n, n});
  ASSERT_TRUE(track.take(&recent));
  EXPECT_FALSE(track.take(&recent));
  ASSERT_EQ(recent.count, 3U);
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(recent.headings[i].order, 3 - i);
    EXPECT_EQ(recent.headings[i].shutter_ns, static_cast<std::int64_t>(3 - i));
  }
  for (int n = 4; n <= 40; ++n) track.put({0.1 * n, n});
  ASSERT_TRUE(track.take(&recent));
  EXPECT_EQ(recent.count, recent.headings.size());
  EXPECT_EQ(recent.headings.front().order, 40U);
  EXPECT_EQ(recent.headings.back().order, 40 - recent.headings.size() + 1);
}

TEST(DecodePool, runs_every_task_on_its_own_threads) {
  DecodePool pool(3);
  std::atomic<int> runs{0};
  std::promise<std::thread::id> last;
  for (int n = 1; n <= 100; ++n) {
    pool.submit([&](JpegDecoder&) {
      if (++runs == 100) last.set_value(std::this_thread::get_id());
    });
  }
  auto thread = last.get_future();
  ASSERT_EQ(thread.wait_for(std::chrono::seconds(20)), std::future_status::ready);
  EXPECT_NE(thread.get(), std::this_thread::get_id());
}

TEST(DecodePool, destroys_tasks_that_have_not_begun) {
  const auto token = std::make_shared<int>(0);
  std::promise<void> gate;
  {
    DecodePool pool(1);
    std::promise<void> begun;
    pool.submit([&, opened = gate.get_future().share()](JpegDecoder&) {
      begun.set_value();
      opened.wait_for(std::chrono::seconds(20));
    });
    begun.get_future().wait_for(std::chrono::seconds(20));
    for (int n = 0; n < 10; ++n) pool.submit([token](JpegDecoder&) {});
    EXPECT_EQ(token.use_count(), 11);
    gate.set_value();
  }
  EXPECT_EQ(token.use_count(), 1);
}

}  // namespace
}  // namespace cyclorama::display
