// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/node/render_queue.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "common/wire/rank.h"

namespace cyclorama::node {
namespace {

constexpr std::uint64_t kAtRest = Rank::kPerClass;
constexpr std::uint64_t kSpare = 2 * Rank::kPerClass;

std::shared_ptr<BlockOrder> order(LinkId link, std::uint64_t block, std::uint64_t rank) {
  auto made = std::make_shared<BlockOrder>();
  made->link = link;
  made->block.set_block(block);
  made->block.set_rank(rank);
  return made;
}

bool all(const BlockOrder& /*order*/) { return true; }

/// Returns how long the first block may go on; infinite if there is none.
double seconds_ahead(const RenderQueue& queue) {
  const auto first = queue.next(all);
  return first == nullptr ? std::numeric_limits<double>::infinity() : queue.seconds_ahead(*first, all);
}

/// Returns the blocks of the links that accept tiles, in the order in which they are rendered.
std::vector<std::uint64_t> emptied(RenderQueue& queue, const std::set<LinkId>& full = {}) {
  std::vector<std::uint64_t> blocks;
  while (const auto next = queue.next([&](const BlockOrder& of) { return of.cancelled || !full.contains(of.link); })) {
    blocks.push_back(next->block.block());
    queue.remove(next->link, next->block.block());
  }
  return blocks;
}

TEST(RenderQueue, returns_the_lowest_rank_first_and_equal_ranks_in_order_of_arrival) {
  RenderQueue queue;
  EXPECT_EQ(emptied(queue), std::vector<std::uint64_t>{});
  for (const auto& [block, rank] : {std::pair{10u, 5u}, {11u, 0u}, {12u, 5u}, {13u, 2u}, {9u, 5u}, {14u, 0u}}) {
    EXPECT_TRUE(queue.add(order(1, block, rank)));
  }
  EXPECT_EQ(queue.size(), 6u);
  EXPECT_EQ(emptied(queue), (std::vector<std::uint64_t>{11, 14, 13, 10, 12, 9}));
  EXPECT_EQ(queue.size(), 0u);
}

TEST(RenderQueue, keeps_the_block_in_progress_until_it_is_done_and_reports_preemption) {
  RenderQueue queue;
  queue.add(order(1, 1, 7));
  EXPECT_EQ(queue.next(all)->block.block(), 1u);
  queue.add(order(1, 2, 7));
  EXPECT_EQ(queue.next(all)->block.block(), 1u);
  queue.add(order(1, 3, 3));
  EXPECT_EQ(queue.next(all)->block.block(), 3u);
  queue.remove(1, 3);
  EXPECT_EQ(queue.next(all)->block.block(), 1u);
}

/// Returns the coordinators whose blocks are rendered, in order; each coordinator always has another block waiting.
std::string coordinators_at_work(RenderQueue& queue, std::vector<std::uint64_t> ranks,
                                 const std::vector<std::uint64_t>& steps, int count) {
  std::string coordinators;
  std::uint64_t number = 1000;
  const auto go_on = [&](LinkId link) {
    const std::size_t coordinator = link - 1;
    EXPECT_TRUE(queue.add(order(link, number++, ranks[coordinator])));
    ranks[coordinator] += steps[coordinator];
  };
  for (LinkId link = 1; link <= ranks.size(); ++link) {
    go_on(link);
    go_on(link);
  }
  for (int i = 0; i < count; ++i) {
    const auto next = queue.next(all);
    coordinators += static_cast<char>('0' + next->link);
    queue.remove(next->link, next->block.block());
    go_on(next->link);
  }
  return coordinators;
}

TEST(RenderQueue, shares_time_between_coordinators_that_began_at_different_times) {
  RenderQueue queue;
  for (const auto& began :
       {std::vector<std::uint64_t>{0, 7'000'000'000}, {7'000'000'000, 0}, {4'000'000'000'000'000'000, 3}}) {
    const std::string coordinators = coordinators_at_work(queue, began, {10'000, 10'000}, 40);
    EXPECT_EQ(std::count(coordinators.begin(), coordinators.end(), '1'), 20) << coordinators;
    EXPECT_EQ(coordinators.find("111"), std::string::npos) << coordinators;
    EXPECT_EQ(coordinators.find("222"), std::string::npos) << coordinators;
    queue.drop(1);
    queue.drop(2);
  }
}

TEST(RenderQueue, gives_a_coordinator_with_blocks_of_half_the_cost_twice_as_many) {
  RenderQueue queue;
  const std::string coordinators = coordinators_at_work(queue, {500, 90'000'000}, {10'000, 20'000}, 60);
  EXPECT_NEAR(static_cast<double>(std::count(coordinators.begin(), coordinators.end(), '1')), 40.0, 1.0)
      << coordinators;
}

TEST(RenderQueue, gives_no_credit_to_a_coordinator_for_time_without_blocks) {
  RenderQueue queue;
  for (std::uint64_t i = 0; i < 5; ++i) queue.add(order(1, i, 1'000'000 * i));
  queue.add(order(2, 100, 50));
  queue.remove(2, 100);
  for (std::uint64_t i = 0; i < 3; ++i) queue.remove(1, i);
  queue.add(order(2, 101, 51));
  queue.add(order(2, 102, 5'000'000));
  EXPECT_EQ(emptied(queue), (std::vector<std::uint64_t>{101, 3, 4, 102}));
}

TEST(RenderQueue, renders_refinements_after_all_moving_pictures_of_any_coordinator) {
  RenderQueue queue;
  queue.add(order(1, 1, kAtRest));
  queue.add(order(1, 2, ~std::uint64_t{0}));
  queue.add(order(2, 3, kAtRest - 1));
  queue.add(order(2, 4, kAtRest + 5));
  queue.add(order(3, 5, 8));
  EXPECT_EQ(emptied(queue), (std::vector<std::uint64_t>{3, 5, 1, 4, 2}));
}

std::shared_ptr<BlockOrder> order_of(std::uint64_t account, std::uint64_t block, std::uint64_t rank,
                                     double rank_per_cpu_second = 1.0) {
  auto made = order(1, block, rank);
  made->block.set_account(account);
  made->block.set_rank_per_cpu_second(rank_per_cpu_second);
  return made;
}

/// Serves pieces of one millisecond for a while. Returns the seconds that each account got.
std::map<std::uint64_t, double> served(RenderQueue& queue, int pieces) {
  std::map<std::uint64_t, double> seconds;
  for (int i = 0; i < pieces; ++i) {
    const auto next = queue.next(all);
    queue.serve(next->link, next->block.block(), 0.001);
    seconds[next->block.account()] += 0.001;
  }
  return seconds;
}

TEST(RenderQueue, divides_time_among_accounts_however_many_endless_blocks_they_have) {
  RenderQueue queue;
  queue.add(order_of(1, 1, 1000));
  queue.add(order_of(2, 2, 1000, 0.5));  // It has twice the weight.
  for (std::uint64_t block = 10; block < 74; ++block) queue.add(order_of(3, block, 0));
  auto seconds = served(queue, 4001);
  EXPECT_NEAR(seconds[1], 1.0, 0.003);
  EXPECT_NEAR(seconds[2], 2.0, 0.003);
  EXPECT_NEAR(seconds[3], 1.0, 0.003);
}

TEST(RenderQueue, counts_what_an_account_received_elsewhere) {
  RenderQueue queue;
  queue.add(order_of(1, 1, 0));
  queue.add(order_of(2, 2, 30'000));
  auto seconds = served(queue, 130);
  EXPECT_NEAR(seconds[1] - seconds[2], 0.030, 0.002);
}

TEST(RenderQueue, learns_what_an_account_that_waits_received_elsewhere_meanwhile) {
  RenderQueue queue;
  queue.add(order_of(1, 1, 0));
  queue.add(order_of(2, 2, kAtRest));
  const auto later = order_of(3, 3, 900'000);
  EXPECT_EQ(queue.next(all)->block.block(), 1u);
  const auto state = [&](std::uint64_t account, std::uint64_t rank) {
    wire::AccountService& service = *later->block.add_received();
    service.set_account(account);
    service.set_rank(rank);
  };
  state(1, 1'000'000);
  state(2, kAtRest + 5);
  state(77, 1'000'000);
  queue.add(later);
  EXPECT_EQ(queue.next(all)->block.block(), 3u) << "account 1 got more from the farm";
  queue.serve(1, 3, 0.2);
  EXPECT_EQ(queue.next(all)->block.block(), 1u);
}

TEST(RenderQueue, tells_how_long_the_first_block_stays_the_first) {
  RenderQueue queue;
  EXPECT_EQ(seconds_ahead(queue), std::numeric_limits<double>::infinity());
  queue.add(order_of(1, 1, 5000));
  queue.add(order_of(1, 2, 6000));
  EXPECT_EQ(seconds_ahead(queue), std::numeric_limits<double>::infinity()) << "blocks of one account do not compete";
  queue.add(order_of(2, 3, kAtRest));
  EXPECT_EQ(seconds_ahead(queue), std::numeric_limits<double>::infinity());
  queue.add(order_of(3, 4, 9000));
  EXPECT_NEAR(seconds_ahead(queue), 0.004, 1e-9);
  queue.serve(1, 1, 0.003);
  EXPECT_NEAR(seconds_ahead(queue), 0.001, 1e-9);
  queue.serve(1, 1, 0.003);
  EXPECT_EQ(queue.next(all)->block.block(), 4u);
  EXPECT_NEAR(seconds_ahead(queue), 0.002, 1e-9);
  queue.serve(1, 77, 1.0);
  queue.serve(1, 4, -1.0);
  EXPECT_NEAR(seconds_ahead(queue), 0.002, 1e-9);
}

TEST(RenderQueue, renders_spare_work_after_all_other) {
  RenderQueue queue;
  queue.add(order_of(1, 1, kSpare));
  queue.add(order_of(2, 2, kAtRest + 7));
  queue.add(order_of(1, 3, 9));
  EXPECT_EQ(emptied(queue), (std::vector<std::uint64_t>{3, 2, 1}));
}

TEST(RenderQueue, returns_a_cancelled_block_first) {
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

TEST(RenderQueue, skips_a_link_that_takes_no_tiles_except_for_its_cancelled_blocks) {
  RenderQueue queue;
  queue.add(order(1, 1, 0));
  queue.add(order(1, 2, 1));
  queue.add(order(2, 3, 5));
  queue.cancel(1, 2);
  EXPECT_EQ(emptied(queue, {1}), (std::vector<std::uint64_t>{2, 3}));
  EXPECT_EQ(emptied(queue), (std::vector<std::uint64_t>{1}));
}

TEST(RenderQueue, refuses_a_used_number_and_more_blocks_of_a_link_than_a_picture_has_tiles) {
  RenderQueue queue;
  EXPECT_TRUE(queue.add(order(1, 1, 0)));
  EXPECT_FALSE(queue.add(order(1, 1, 3)));
  EXPECT_TRUE(queue.add(order(2, 1, 0))) << "another coordinator's";
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
}  // namespace cyclorama::node
