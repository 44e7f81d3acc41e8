// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/node/render_queue.h"

#include <gtest/gtest.h>

#include <set>
#include <vector>

namespace cyclorama {
namespace {

std::shared_ptr<BlockOrder> order(LinkId link, std::uint64_t block, std::uint64_t rank) {
  auto made = std::make_shared<BlockOrder>();
  made->link = link;
  made->block.set_block(block);
  made->block.set_rank(rank);
  return made;
}

/// The blocks of the links that take tiles, in the order in which they are worked at.
std::vector<std::uint64_t> emptied(RenderQueue& queue, const std::set<LinkId>& full = {}) {
  std::vector<std::uint64_t> blocks;
  while (const auto next = queue.next([&](LinkId link) { return !full.contains(link); })) {
    blocks.push_back(next->block.block());
    queue.remove(next->link, next->block.block());
  }
  return blocks;
}

TEST(RenderQueue, gives_the_lowest_rank_first_and_of_one_rank_what_came_first) {
  RenderQueue queue;
  EXPECT_EQ(emptied(queue), std::vector<std::uint64_t>{});
  for (const auto& [block, rank] : {std::pair{10u, 5u}, {11u, 0u}, {12u, 5u}, {13u, 2u}, {9u, 5u}, {14u, 0u}}) {
    EXPECT_TRUE(queue.add(order(1, block, rank)));
  }
  EXPECT_EQ(queue.size(), 6u);
  EXPECT_EQ(emptied(queue), (std::vector<std::uint64_t>{11, 14, 13, 10, 12, 9}));
  EXPECT_EQ(queue.size(), 0u);
}

TEST(RenderQueue, keeps_the_block_at_work_until_it_is_done_and_says_when_another_goes_first) {
  RenderQueue queue;
  const auto all = [](LinkId) { return true; };
  queue.add(order(1, 1, 7));
  EXPECT_EQ(queue.next(all)->block.block(), 1u);
  queue.add(order(1, 2, 7));
  EXPECT_EQ(queue.next(all)->block.block(), 1u);
  queue.add(order(2, 1, 3));
  EXPECT_EQ(queue.next(all)->link, 2u);
  queue.remove(2, 1);
  EXPECT_EQ(queue.next(all)->block.block(), 1u);
}

TEST(RenderQueue, gives_a_cancelled_block_first_as_it_only_wants_its_end) {
  RenderQueue queue;
  const auto waiting = order(1, 2, 9);
  queue.add(order(1, 1, 0));
  queue.add(waiting);
  queue.cancel(1, 77);
  queue.cancel(2, 2);
  EXPECT_FALSE(waiting->cancelled);
  queue.cancel(1, 2);
  queue.cancel(1, 2);
  EXPECT_TRUE(waiting->cancelled);
  EXPECT_EQ(emptied(queue), (std::vector<std::uint64_t>{2, 1}));
}

TEST(RenderQueue, passes_over_a_link_that_takes_no_tiles_but_for_its_cancelled_blocks) {
  RenderQueue queue;
  queue.add(order(1, 1, 0));
  queue.add(order(1, 2, 1));
  queue.add(order(2, 3, 5));
  queue.cancel(1, 2);
  EXPECT_EQ(emptied(queue, {1}), (std::vector<std::uint64_t>{2, 3}));
  EXPECT_EQ(emptied(queue), (std::vector<std::uint64_t>{1}));
}

TEST(RenderQueue, refuses_a_number_in_use_and_more_blocks_of_a_link_than_a_picture_has_tiles) {
  RenderQueue queue;
  EXPECT_TRUE(queue.add(order(1, 1, 0)));
  EXPECT_FALSE(queue.add(order(1, 1, 3)));
  EXPECT_TRUE(queue.add(order(2, 1, 0))) << "another head's";
  for (std::uint64_t block = 2; block <= 8192; ++block) ASSERT_TRUE(queue.add(order(1, block, 0)));
  EXPECT_FALSE(queue.add(order(1, 8193, 0)));
  EXPECT_TRUE(queue.add(order(2, 8193, 0)));
  queue.remove(1, 5);
  EXPECT_TRUE(queue.add(order(1, 8193, 0)));
}

TEST(RenderQueue, drops_all_of_a_link_and_nothing_else) {
  RenderQueue queue;
  const auto gone = order(1, 1, 0);
  queue.add(gone);
  queue.add(order(1, 2, 4));
  queue.add(order(2, 3, 0));
  queue.cancel(1, 2);
  queue.drop(1);
  queue.drop(9);
  EXPECT_TRUE(gone->cancelled) << "whoever works at it stops";
  EXPECT_EQ(queue.size(), 1u);
  EXPECT_TRUE(queue.add(order(1, 1, 0)));
  EXPECT_EQ(emptied(queue), (std::vector<std::uint64_t>{3, 1}));
}

}  // namespace
}  // namespace cyclorama
