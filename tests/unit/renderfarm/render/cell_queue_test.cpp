// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/render/cell_queue.h"

#include <gtest/gtest.h>

namespace cyclorama::render {
namespace {

/// Returns "lane:first-end", or "none".
std::string text(const std::optional<CellQueue::Cells>& cells) {
  if (!cells) return "none";
  return std::to_string(cells->lane) + ":" + std::to_string(cells->first) + "-" + std::to_string(cells->end);
}

TEST(CellQueue, gives_cells_of_the_lowest_order_and_of_the_next_when_there_are_none) {
  CellQueue queue(4);
  const auto first = queue.open(1);
  const auto second = queue.open(2);
  queue.begin(second, 2);
  queue.begin(first, 1);
  EXPECT_EQ(text(queue.take()), "0:0-1");
  EXPECT_EQ(text(queue.take()), "1:0-1");
  queue.set_order(first, 3);
  EXPECT_EQ(text(queue.take(second)), "1:1-2");
  EXPECT_EQ(text(queue.take()), "none");
}

TEST(CellQueue, lets_a_pictures_own_thread_help_only_pictures_of_lower_order) {
  CellQueue queue(4);
  const auto first = queue.open(1);
  const auto second = queue.open(2);
  queue.begin(first, 1);
  queue.begin(second, 2);
  EXPECT_EQ(text(queue.take(second)), "0:0-1");
  EXPECT_EQ(text(queue.take(first)), "none");
  EXPECT_EQ(text(queue.take(second)), "1:0-1");
}

TEST(CellQueue, lets_no_more_threads_work_than_there_are) {
  CellQueue queue(2);
  const auto lane = queue.open(0);
  queue.begin(lane, 5);
  const auto other = queue.open(1);  // Its own thread works.
  const auto cells = queue.take();
  EXPECT_EQ(text(cells), "0:0-1");
  EXPECT_EQ(text(queue.take()), "none");
  EXPECT_EQ(text(queue.take(lane)), "none") << "not even its own thread";
  EXPECT_FALSE(queue.finish(*cells, 0.1));
  EXPECT_EQ(text(queue.take()), "0:1-2");
  queue.close(other);
  EXPECT_EQ(text(queue.take()), "0:2-3");
}

TEST(CellQueue, ends_a_step_with_its_last_cell_and_a_dropped_one_with_the_last_that_was_taken) {
  CellQueue queue(4);
  const auto lane = queue.open(0);
  for (const bool dropped : {false, true}) {
    queue.begin(lane, 3);
    const auto one = queue.take(lane);
    const auto two = queue.take();
    EXPECT_FALSE(queue.finish(*one, 0.1));
    if (dropped) {
      queue.drop_rest(lane);
      EXPECT_EQ(text(queue.take()), "none");
      EXPECT_TRUE(queue.finish(*two, 0.1));
      continue;
    }
    const auto three = queue.take();
    EXPECT_FALSE(queue.finish(*three, 0.1));
    EXPECT_FALSE(queue.is_complete(lane));
    EXPECT_TRUE(queue.finish(*two, 0.1));
  }
  EXPECT_TRUE(queue.is_complete(lane));
}

TEST(CellQueue, gives_many_short_cells_at_once_and_few_at_the_end) {
  CellQueue queue(2);
  const auto lane = queue.open(0);
  for (const double seconds : {1e-5, 1e-2}) {
    queue.begin(lane, 1000);
    int first = 0;
    int most = 0;
    int last = 0;
    bool is_complete = false;
    while (!is_complete) {
      const auto cells = queue.take(lane);
      ASSERT_TRUE(cells);
      EXPECT_EQ(cells->first, first);
      first = cells->end;
      last = cells->end - cells->first;
      most = std::max(most, last);
      is_complete = queue.finish(*cells, seconds * last);
    }
    EXPECT_EQ(first, 1000);
    EXPECT_EQ(last, 1);
    EXPECT_EQ(most, seconds < 1e-3 ? 50 : 1) << "about half a millisecond, but at least one";
  }
}

}  // namespace
}  // namespace cyclorama::render
