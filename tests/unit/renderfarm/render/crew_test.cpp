// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/render/crew.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <new>
#include <thread>
#include <vector>

namespace cyclorama::render {
namespace {

TEST(Crew, calls_for_each_cell_once_whatever_the_threads) {
  for (const int threads : {1, 2, 7}) {
    Crew crew(threads);
    EXPECT_EQ(crew.threads(), threads);
    for (const int count : {0, 1, 2, 1000}) {
      std::vector<std::atomic<int>> calls(static_cast<std::size_t>(count));
      crew.run(count, [&](int i) { ++calls[static_cast<std::size_t>(i)]; });
      EXPECT_TRUE(std::ranges::all_of(calls, [](const auto& times) { return times == 1; })) << threads << ", " << count;
    }
  }
}

TEST(Crew, throws_what_a_cell_threw_and_goes_on_with_the_next_step) {
  Crew crew(3);
  std::atomic<int> calls = 0;
  EXPECT_THROW(crew.run(1000,
                        [&](int i) {
                          ++calls;
                          if (i == 10) throw std::bad_alloc();
                        }),
               std::bad_alloc);
  EXPECT_LT(calls, 1000);
  calls = 0;
  crew.run(1000, [&](int) { ++calls; });
  EXPECT_EQ(calls, 1000);
}

TEST(Crew, computes_the_pictures_of_several_threads_at_once) {
  for (const int count : {1, 2, 4}) {
    Crew crew(count);
    std::vector<std::thread> threads;
    std::atomic<int> wrong = 0;
    for (std::uint64_t order = 0; order < 6; ++order) {
      threads.emplace_back([&crew, &wrong, order] {
        for (int round = 0; round < 50; ++round) {
          Crew::Picture picture(crew, order);
          for (int step = 0; step < 4; ++step) {
            std::vector<int> cells(64);
            crew.run(64, [&](int i) { cells[static_cast<std::size_t>(i)] = i + step; });
            for (int i = 0; i < 64; ++i) wrong += cells[static_cast<std::size_t>(i)] == i + step ? 0 : 1;
            picture.set_order(order + static_cast<std::uint64_t>(step));
          }
        }
      });
    }
    for (std::thread& thread : threads) thread.join();
    EXPECT_EQ(wrong, 0) << count;
  }
}

TEST(Crew, serves_the_picture_of_the_lowest_order_first) {
  Crew crew(2);
  std::atomic<bool> has_urgent = false;
  std::atomic<int> after_urgent = 0;
  std::thread patient([&] {
    const Crew::Picture picture(crew, 5);
    crew.run(400, [&](int) {
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
      if (has_urgent) ++after_urgent;
    });
  });
  std::this_thread::sleep_for(std::chrono::milliseconds(20));
  {
    const Crew::Picture picture(crew, 0);
    has_urgent = true;
    crew.run(20, [](int) { std::this_thread::sleep_for(std::chrono::milliseconds(1)); });
    has_urgent = false;
  }
  EXPECT_LE(after_urgent, 2 * 4) << "each thread ends the cells that it has, of half a millisecond together or one";
  patient.join();
}

TEST(Crew, states_a_pictures_share_of_all_that_is_computed) {
  Crew crew(2);
  const auto cell = [](int) { std::this_thread::sleep_for(std::chrono::milliseconds(2)); };
  const Crew::Picture picture(crew, 1);
  EXPECT_EQ(picture.share(), 1.0);
  crew.run(3, cell);
  EXPECT_EQ(picture.share(), 1.0);
  std::thread other([&] { crew.run(3, cell); });
  other.join();
  EXPECT_GT(picture.share(), 0.0);
  EXPECT_LT(picture.share(), 1.0);
}

}  // namespace
}  // namespace cyclorama::render
