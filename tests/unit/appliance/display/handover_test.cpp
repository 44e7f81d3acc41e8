// SPDX-License-Identifier: Apache-2.0
// What passes between threads: the slot, the ring and the pool.
#include <gtest/gtest.h>

#include <future>
#include <thread>

#include "appliance/display/atomic_slot.h"
#include "appliance/display/decode_pool.h"
#include "appliance/display/event_ring.h"
#include "appliance/display/newest_value.h"

namespace cyclorama {
namespace {

TEST(AtomicSlot, gives_every_value_to_the_taker_or_back_to_the_putter_once) {
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

TEST(NewestValue, gives_the_newest_whole_and_each_once) {
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

TEST(EventRing, keeps_order_and_counts_what_finds_no_place) {
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

TEST(DecodePool, runs_every_job_on_threads_of_its_own) {
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

TEST(DecodePool, destroys_what_it_has_not_begun) {
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
}  // namespace cyclorama
