// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/coordinator/placement.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

namespace cyclorama::coordinator {
namespace {

using testing::ElementsAre;

constexpr TimePoint kStart{std::chrono::hours(1)};
constexpr SessionId kOne{1};
constexpr SessionId kOther{2};
constexpr NodeId a{11}, b{12}, c{13}, d{14};

TimePoint at(double seconds) {
  return kStart + std::chrono::duration_cast<Duration>(std::chrono::duration<double>(seconds));
}

/// Plans ten frames of a second each.
void plan(Placement& placement, SessionId session, std::vector<Placement::NodeWork> works, double until = 10.0) {
  for (double now = until - 10.0; now <= until; now += 1.0) placement.planned(session, works, at(now));
}

std::vector<NodeId> arranged(Placement& placement, SessionId session, std::vector<NodeId> nodes) {
  placement.arrange(session, &nodes);
  return nodes;
}

TEST(Placement, gives_a_new_session_the_nodes_first_that_others_use_least) {
  Placement placement;
  EXPECT_THAT(arranged(placement, kOne, {a, b, c}), ElementsAre(a, b, c));
  plan(placement, kOne, {{a, 0.6}, {b, 0.3}});
  EXPECT_THAT(arranged(placement, kOther, {a, b, c}), ElementsAre(c, b, a));
  EXPECT_THAT(arranged(placement, kOne, {c, b, a}), ElementsAre(a, b, c)) << "its order stays";
}

TEST(Placement, leaves_a_session_what_others_do_not_take) {
  Placement placement;
  plan(placement, kOne, {{a, 0.6}, {b, 0.1}});
  EXPECT_EQ(placement.free_part(kOther, a), 0.375);
  EXPECT_EQ(placement.free_part(kOther, b), 0.875);
  EXPECT_EQ(placement.free_part(kOther, c), 1.0);
  EXPECT_EQ(placement.free_part(kOne, a), 1.0) << "its own work is not in its way";
  plan(placement, kOther, {{a, 5.0}});
  EXPECT_EQ(placement.free_part(kOne, a), Placement::kStep) << "never nothing";
  EXPECT_EQ(placement.free_part(SessionId{3}, a), Placement::kStep);
}

TEST(Placement, keeps_a_session_where_it_is_unless_another_node_is_clearly_freer) {
  Placement placement;
  plan(placement, kOne, {{a, 0.5}});
  plan(placement, kOther, {{a, 0.1}});
  EXPECT_EQ(placement.free_part(kOne, a), 1.0) << "used by another for a tenth";
  EXPECT_EQ(placement.free_part(kOne, b), 1.0);
  plan(placement, kOther, {{a, 0.9}}, 20.0);
  EXPECT_LT(placement.free_part(kOne, a), 0.3);
}

TEST(Placement, spreads_sessions_that_need_few_nodes_over_all) {
  Placement placement;
  const std::vector<NodeId> all{a, b, c, d};
  for (std::uint64_t session = 1; session <= 8; ++session) {
    std::vector<NodeId> nodes = arranged(placement, SessionId{session}, all);
    plan(placement, SessionId{session}, {{nodes.front(), 0.4}});
  }
  for (const NodeId node : all) EXPECT_NEAR(placement.load(node), 0.8, 1e-9);
}

TEST(Placement, moves_only_those_who_used_a_lost_node) {
  Placement placement;
  arranged(placement, kOne, {a, b});
  arranged(placement, kOther, {b, a});
  plan(placement, kOne, {{a, 0.5}});
  plan(placement, kOther, {{b, 0.5}});
  placement.forget(a);
  EXPECT_EQ(placement.load(a), 0.0);
  EXPECT_THAT(arranged(placement, kOther, {b, c}), ElementsAre(b, c));
  EXPECT_THAT(arranged(placement, kOne, {b, c}), ElementsAre(b, c)) << "known nodes before new ones";
}

TEST(Placement, forgets_sessions_that_left_or_rest) {
  Placement placement;
  plan(placement, kOne, {{a, 0.5}});
  plan(placement, kOther, {{a, 0.25}}, 14.0);
  EXPECT_NEAR(placement.load(a), 0.75, 1e-9);
  placement.expire(at(14.0));
  EXPECT_NEAR(placement.load(a), 0.25, 1e-9);
  placement.forget(kOther);
  placement.forget(kOther);
  EXPECT_NEAR(placement.load(a), 0.0, 1e-9);
}

TEST(Placement, measures_work_by_the_rate_of_frames) {
  Placement placement;
  for (int i = 0; i < 100; ++i) placement.planned(kOne, std::vector<Placement::NodeWork>{{a, 0.02}}, at(0.05 * i));
  EXPECT_NEAR(placement.load(a), 0.4, 0.01);
}

}  // namespace
}  // namespace cyclorama::coordinator
