// SPDX-License-Identifier: Apache-2.0
// The service that museums receive from a shared farm, and the requests that their grants refuse.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/wire/rank.h"
#include "tests/support/farm_simulation.h"

namespace cyclorama::coordinator {
namespace {

using testing::HasSubstr;

SessionId open(FarmSimulation& s, std::uint64_t number, const trust::Grant& grant, std::uint32_t reference = 0,
               double budget_ms = 0.0) {
  const SessionId id{1000 + number};
  s.state.session_connected(id, grant);
  wire::SessionRequest request;
  request.mutable_open()->set_museum("museum");
  request.mutable_open()->set_frame_budget_ms(budget_ms);
  request.mutable_open()->set_reference_samples(reference);
  s.state.session_requested(id, request, s.clock.now());
  if (s.delegate.replies[id].empty()) return id;
  EXPECT_TRUE(s.windows[id].take(s.delegate.replies[id].front()));
  drain_opened(s, id);
  return id;
}

/// Returns the blocks that the node was ordered to render for the session and has not ended.
std::vector<wire::RenderBlock> orders(FarmSimulation& s, NodeId node, SessionId session) {
  std::vector<wire::RenderBlock> blocks;
  for (const wire::NodeCommand& command : s.delegate.commands[node]) {
    if (command.has_render() && command.render().session() == static_cast<std::uint64_t>(session)) {
      blocks.push_back(command.render());
    }
  }
  return blocks;
}

void end_block(FarmSimulation& s, NodeId node, std::uint64_t block, double cpu_seconds, const std::string& error = "") {
  wire::NodeReport report;
  report.mutable_end()->set_block(block);
  report.mutable_end()->set_render_cpu_seconds(cpu_seconds);
  report.mutable_end()->set_error(error);
  std::erase_if(s.delegate.commands[node],
                [&](const wire::NodeCommand& command) { return command.render().block() == block; });
  s.state.node_reported(node, report);
}

TEST(CoordinatorAccounts, orders_all_sessions_of_a_museum_by_one_account) {
  FarmSimulation s;
  const NodeId node = s.add_node();
  const SessionId first = open(s, 1, {.museum = "hall-3"});
  const SessionId second = open(s, 2, {.museum = "hall-3"});
  const SessionId other = open(s, 3, {.museum = "hall-4", .weight = 2.0});
  for (const SessionId id : {first, second, other}) s.request_view(id, view_of(1, 64, 64));
  const auto account = [&](SessionId id) { return orders(s, node, id).at(0).account(); };
  EXPECT_EQ(account(first), account(second));
  EXPECT_NE(account(first), account(other));
  EXPECT_EQ(orders(s, node, first).at(0).rank_per_cpu_second(), 1.0);
  EXPECT_EQ(orders(s, node, other).at(0).rank_per_cpu_second(), 0.5);
}

TEST(CoordinatorAccounts, scale_a_nodes_part_to_the_whole_frame) {
  FarmSimulation s;
  const NodeId small = s.add_node(2);
  const NodeId large = s.add_node(6);
  const SessionId id = open(s, 1, {.museum = "hall-3"});
  s.request_view(id, view_of(1));
  EXPECT_EQ(orders(s, small, id).at(0).rank_per_cpu_second(), 4.0);
  EXPECT_NEAR(orders(s, large, id).at(0).rank_per_cpu_second(), 8.0 / 6.0, 1e-12);
}

TEST(CoordinatorAccounts, tell_a_node_what_those_who_wait_there_have_received_elsewhere) {
  FarmSimulation s;
  const NodeId busy = s.add_node();
  const NodeId other = s.add_node();
  const SessionId greedy = open(s, 1, {.museum = "greedy"});
  const SessionId honest = open(s, 2, {.museum = "honest"});
  s.request_view(greedy, view_of(1));
  const wire::RenderBlock elsewhere = orders(s, other, greedy).at(0);
  wire::NodeReport progress;
  progress.mutable_progress()->set_block(elsewhere.block());
  progress.mutable_progress()->set_render_cpu_seconds(50.0);
  s.state.node_reported(other, progress);
  s.request_view(honest, view_of(1));
  const wire::RenderBlock told = orders(s, busy, honest).at(0);
  ASSERT_EQ(told.received_size(), 1);
  EXPECT_EQ(told.received(0).account(), elsewhere.account());
  EXPECT_NEAR(static_cast<double>(told.received(0).rank() - elsewhere.rank()), 50e6, 1.0);
  s.request_view(honest, view_of(2));
  EXPECT_EQ(orders(s, busy, honest).back().received_size(), 0) << "it knows that already";
}

TEST(CoordinatorAccounts, charge_blocks_of_frames_that_were_given_up_and_of_sessions_that_left) {
  FarmSimulation s;
  const NodeId node = s.add_node();
  SessionId greedy = open(s, 1, {.museum = "greedy"});
  const SessionId honest = open(s, 2, {.museum = "honest"});
  s.request_view(greedy, view_of(1, 64, 64));
  const std::uint64_t block = orders(s, node, greedy).at(0).block();
  s.state.session_disconnected(greedy);
  s.windows.erase(greedy);
  end_block(s, node, block, 100.0, "cancelled");
  greedy = open(s, 3, {.museum = "greedy"});
  s.request_view(greedy, view_of(1, 64, 64));
  s.request_view(honest, view_of(1, 64, 64));
  EXPECT_GT(orders(s, node, greedy).at(0).rank(), orders(s, node, honest).at(0).rank());
}

TEST(CoordinatorAccounts, charge_a_long_block_while_it_is_rendered_and_never_twice) {
  FarmSimulation s;
  const NodeId node = s.add_node();
  const SessionId greedy = open(s, 1, {.museum = "greedy"});
  s.request_view(greedy, view_of(1, 64, 64));
  auto rank_now = [&, number = std::uint64_t{10}]() mutable {
    const SessionId second = open(s, number++, {.museum = "greedy"});
    s.request_view(second, view_of(1, 64, 64));
    const std::uint64_t rank = orders(s, node, second).at(0).rank();
    s.windows.erase(second);
    s.state.session_disconnected(second);
    return rank;
  };
  const std::uint64_t before = rank_now();
  const std::uint64_t block = orders(s, node, greedy).at(0).block();
  wire::NodeReport progress;
  progress.mutable_progress()->set_block(block);
  for (const double seconds : {3.0, 5.0, 5.0, 4.0}) {
    progress.mutable_progress()->set_render_cpu_seconds(seconds);
    s.state.node_reported(node, progress);
  }
  EXPECT_NEAR(static_cast<double>(rank_now() - before), 5e6, 10.0);
  end_block(s, node, block, 7.0);
  EXPECT_NEAR(static_cast<double>(rank_now() - before), 7e6, 0.1e6);
  progress.mutable_progress()->set_block(999);
  s.state.node_reported(node, progress);
  EXPECT_TRUE(s.delegate.ended_nodes.contains(node)) << "no block of this node";
}

TEST(CoordinatorAccounts, take_no_node_from_others_for_a_museum_that_asks_for_too_much) {
  FarmSimulation s;
  const NodeId quick = s.add_node();
  const NodeId stuck = s.add_node();
  const SessionId greedy = open(s, 1, {.museum = "greedy"});
  const SessionId honest = open(s, 2, {.museum = "honest"});
  s.request_view(greedy, view_of(1, 2048, 1024));
  while (s.work(quick)) {
  }
  s.clock.advance(std::chrono::seconds(20));
  s.state.tick();
  ASSERT_FALSE(orders(s, quick, greedy).empty()) << "the quick node takes over what the other owes";
  s.request_view(honest, view_of(1, 2048, 1024));
  EXPECT_FALSE(orders(s, stuck, honest).empty());
  EXPECT_FALSE(orders(s, quick, honest).empty());
}

TEST(CoordinatorAccounts, rank_work_beyond_a_quota_after_all_other) {
  FarmSimulation s;
  const NodeId node = s.add_node();
  const SessionId id = open(s, 1, {.museum = "hall-3", .cores = 1.0});
  s.request_view(id, view_of(1, 64, 64));
  EXPECT_EQ(Rank::of(orders(s, node, id).at(0).rank()).work, WorkClass::kMoving);
  end_block(s, node, orders(s, node, id).at(0).block(), 60.0, "it gave up");
  s.request_view(id, view_of(2, 64, 64));
  EXPECT_EQ(Rank::of(orders(s, node, id).back().rank()).work, WorkClass::kSpare);
}

TEST(CoordinatorAccounts, refuse_views_beyond_the_grant) {
  for (const auto& [samples, bounces, reason] :
       {std::tuple(65u, 4u, "view.samples is 65; this museum's grant allows at most 64"),
        std::tuple(64u, 5u, "view.bounces is 5; this museum's grant allows at most 4"), std::tuple(64u, 4u, "")}) {
    FarmSimulation s;
    s.add_node();
    const SessionId id = open(s, 1, {.museum = "hall-3", .samples = 64, .bounces = 4});
    wire::View view = view_of(1, 64, 64);
    view.set_samples(samples);
    view.set_bounces(bounces);
    s.request_view(id, view);
    const auto ended = s.delegate.ended_sessions.find(id);
    EXPECT_EQ(ended == s.delegate.ended_sessions.end() ? "" : ended->second.message(), reason);
  }
}

TEST(CoordinatorAccounts, refuse_a_scene_for_which_the_museum_has_no_memory_left) {
  for (const double granted : {0.0, 0.5e9, 1.5e9}) {
    FarmSimulation s;
    s.scene_memory_bytes = 1'000'000'000;
    s.add_node();
    const SessionId id = open(s, 1, {.museum = "hall-3", .scene_bytes = granted});
    const SessionId again = open(s, 2, {.museum = "hall-3", .scene_bytes = granted});
    const bool is_refused = granted == 0.5e9;
    EXPECT_EQ(s.delegate.ended_sessions.contains(id), is_refused) << granted;
    EXPECT_EQ(s.delegate.ended_sessions.contains(again), is_refused) << "a scene counts once";
    if (!is_refused) continue;
    EXPECT_THAT(s.delegate.ended_sessions.at(id).message(), HasSubstr("0.47 GiB"));
  }
}

}  // namespace
}  // namespace cyclorama::coordinator
