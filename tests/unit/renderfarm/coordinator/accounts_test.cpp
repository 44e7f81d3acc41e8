// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/coordinator/accounts.h"

#include <gtest/gtest.h>

#include <array>
#include <cstdint>
#include <limits>
#include <vector>

namespace cyclorama::coordinator {
namespace {

constexpr TimePoint kStart{std::chrono::hours(1)};
constexpr double kMs = 0.001;

TimePoint at(double seconds) {
  return kStart + std::chrono::duration_cast<Duration>(std::chrono::duration<double>(seconds));
}

/// A session that always has `frames` frames waiting. They cost more or less than they were predicted to.
struct Demander {
  AccountId account;
  double predicted = 0.05;
  double cost = 0.05;
  int frames = 1;
  bool completes = true;  ///< False: each frame is given up before its end, after its cost was spent.
  std::vector<Accounts::Turn> waiting{};
  double got = 0.0;
};

/// Serves the first of all waiting frames, one after the other, as one thread would.
void serve(Accounts& accounts, std::vector<Demander>& demanders, double seconds, double from = 0.0) {
  for (double now = from; now < from + seconds;) {
    Demander* first = nullptr;
    for (Demander& each : demanders) {
      while (static_cast<int>(each.waiting.size()) < each.frames) {
        each.waiting.push_back(accounts.begin(each.account, {false, each.predicted, 1.0}, at(now)));
      }
      const auto rank = [](const Demander& of) { return of.waiting.front().rank().wire(); };
      if (first == nullptr || rank(each) < rank(*first)) first = &each;
    }
    ASSERT_NE(first, nullptr);
    const Accounts::Turn turn = first->waiting.front();
    first->waiting.erase(first->waiting.begin());
    now += first->cost;
    first->got += first->cost;
    if (first->completes) accounts.charge(first->account, turn.work, first->cost, at(now));
    accounts.end(first->account, turn);
    if (!first->completes) accounts.charge(first->account, turn.work, first->cost, at(now));  // Its node ends it later.
  }
}

TEST(Accounts, give_processor_time_by_weight_whatever_a_frame_costs) {
  Accounts accounts;
  std::vector<Demander> all{{accounts.open("a", {1.0}), 0.5, 0.5},
                            {accounts.open("b", {2.0}), 0.01, 0.01},
                            {accounts.open("c", {4.0}), 0.1, 0.1}};
  serve(accounts, all, 700.0);
  EXPECT_NEAR(all[1].got / all[0].got, 2.0, 0.05);
  EXPECT_NEAR(all[2].got / all[0].got, 4.0, 0.05);
}

TEST(Accounts, charge_what_was_spent_and_not_what_was_predicted) {
  Accounts accounts;
  std::vector<Demander> all{{accounts.open("honest", {}), 0.05, 0.05}, {accounts.open("greedy", {}), 1e-4, 0.2}};
  accounts.set_threads(1.0);
  serve(accounts, all, 400.0);
  EXPECT_NEAR(all[0].got, 200.0, 3.0);
}

TEST(Accounts, charge_frames_that_were_given_up) {
  Accounts accounts;
  std::vector<Demander> all{{accounts.open("honest", {}), 0.05, 0.05}, {accounts.open("greedy", {}), 0.05, 0.2}};
  all[1].completes = false;
  serve(accounts, all, 200.0);
  EXPECT_NEAR(all[0].got, 100.0, 2.0);
}

TEST(Accounts, give_a_museum_with_many_sessions_one_share) {
  Accounts accounts;
  std::vector<Demander> all{{accounts.open("honest", {})}};
  for (int i = 0; i < 16; ++i) all.push_back({accounts.open("greedy", {}), 0.05, 0.05, 2});
  serve(accounts, all, 100.0);
  EXPECT_NEAR(all[0].got, 50.0, 2.0);
}

TEST(Accounts, of_sessions_without_a_name_are_their_own) {
  Accounts accounts;
  std::vector<Demander> all{{accounts.open("", {})}, {accounts.open("", {})}, {accounts.open("", {})}};
  serve(accounts, all, 30.0);
  for (const Demander& each : all) EXPECT_NEAR(each.got, 10.0, 0.2);
}

TEST(Accounts, let_an_absent_museum_catch_up_with_a_second_of_its_share_and_no_more) {
  Accounts accounts;
  accounts.set_threads(1.0);
  std::vector<Demander> all{{accounts.open("present", {})}, {accounts.open("absent", {})}};
  std::vector<Demander> one{all[0]};
  serve(accounts, one, 100.0);
  all[0].waiting = one[0].waiting;
  serve(accounts, all, 100.0, 100.0);
  const double credit = Accounts::kCreditSeconds / 2.0;  // There are two museums.
  EXPECT_NEAR(all[1].got - all[0].got, credit, 0.11);
}

TEST(Accounts, serve_a_museum_within_its_share_before_one_that_takes_all_it_can_get) {
  Accounts accounts;
  accounts.set_threads(1.0);
  std::vector<Demander> greedy{{accounts.open("greedy", {}), 0.001, 0.001, 8}};
  const AccountId modest = accounts.open("modest", {});
  serve(accounts, greedy, 10.0);
  for (int step = 0; step < 100; ++step) {
    const double now = 10.0 + 0.1 * step;
    const auto turn = accounts.begin(modest, {false, 0.03, 1.0}, at(now));
    EXPECT_LT(turn.rank().wire(), greedy[0].waiting.front().rank().wire()) << now;
    accounts.charge(modest, turn.work, 0.03, at(now));
    accounts.end(modest, turn);
    serve(accounts, greedy, 0.07, now + 0.03);
  }
}

TEST(Accounts, serve_museums_within_their_shares_in_the_order_of_their_requests_whatever_they_took_before) {
  Accounts accounts;
  accounts.set_threads(1.0);
  const AccountId seldom = accounts.open("seldom", {});
  const AccountId often = accounts.open("often", {});
  const auto begin = [&](AccountId id, double seconds) { return accounts.begin(id, {false, 0.01, 1.0}, at(seconds)); };
  const auto before = begin(often, 0.0);
  accounts.charge(often, before.work, 0.4, at(0.4));  // Less than the credit.
  accounts.end(often, before);
  const auto first = begin(often, 1.0);
  const auto second = begin(seldom, 1.001);
  EXPECT_LE(first.rank().wire(), second.rank().wire());
  accounts.end(often, first);
  accounts.end(seldom, second);
  // A third, which takes all it can get, changes nothing.
  std::vector<Demander> greedy{{accounts.open("greedy", {}), 0.001, 0.001, 8}};
  serve(accounts, greedy, 10.0, 2.0);
  EXPECT_LE(begin(often, 12.0).rank().wire(), begin(seldom, 12.001).rank().wire());
}

TEST(Accounts, leave_a_museum_that_waits_its_place_when_it_requests_more) {
  Accounts accounts;
  accounts.set_threads(1.0);
  const AccountId waiting = accounts.open("waiting", {});
  const auto first = accounts.begin(waiting, {false, 0.1, 1.0}, at(0.0));
  std::vector<Demander> greedy{{accounts.open("greedy", {}), 0.05, 0.05, 8}};
  serve(accounts, greedy, 100.0);
  const auto second = accounts.begin(waiting, {false, 0.1, 1.0}, at(100.0));
  EXPECT_NEAR(second.start, first.start + 0.1, 1e-9);
  EXPECT_LT(second.rank().wire(), greedy[0].waiting.front().rank().wire());
}

TEST(Accounts, serve_work_beyond_a_quota_of_processors_after_everything_else_until_it_is_paid) {
  Accounts accounts;
  const AccountId account = accounts.open("museum", {1.0, 2.0});
  const auto now = [&](double seconds) { return accounts.begin(account, {false, 0.1, 1.0}, at(seconds)); };
  EXPECT_EQ(now(0.0).work, WorkClass::kMoving);
  accounts.charge(account, WorkClass::kMoving, 2.0 * Accounts::kQuotaBurstSeconds - 0.1, at(0.0));
  EXPECT_EQ(now(0.0).work, WorkClass::kMoving) << "an unused quota lasts for a while";
  accounts.charge(account, WorkClass::kMoving, 4.0, at(0.0));
  EXPECT_EQ(now(0.0).work, WorkClass::kSpare);
  EXPECT_EQ(now(1.0).work, WorkClass::kSpare);
  EXPECT_EQ(now(2.0).work, WorkClass::kMoving);
  EXPECT_EQ(accounts.begin(account, {true, 0.1, 1.0}, at(2.0)).work, WorkClass::kAtRest);
}

TEST(Accounts, count_requested_pixels_against_a_quota) {
  Accounts accounts;
  const AccountId account = accounts.open("museum", {1.0, 0.0, 10.0});
  int spare = 0;
  for (int frame = 0; frame < 100; ++frame) {  // Twice the quota.
    const auto turn = accounts.begin(account, {false, 0.1, 2.0}, at(0.1 * frame));
    spare += turn.work == WorkClass::kSpare ? 1 : 0;
    accounts.end(account, turn);
  }
  EXPECT_GT(spare, 70);
  EXPECT_EQ(accounts.begin(account, {false, 0.1, 2.0}, at(60.0)).work, WorkClass::kMoving);
}

TEST(Accounts, keep_a_museums_debt_while_it_is_away_and_forget_sessions_without_a_name) {
  Accounts accounts;
  const AccountId named = accounts.open("museum", {1.0, 1.0});
  const AccountId nameless = accounts.open("", {1.0, 1.0});
  for (const AccountId id : {named, nameless}) accounts.charge(id, WorkClass::kMoving, 60.0, kStart);
  accounts.close(named);
  accounts.close(nameless);
  accounts.charge(nameless, WorkClass::kMoving, 1.0, kStart);
  EXPECT_EQ(accounts.charged_seconds(nameless), 0.0);
  accounts.charge(named, WorkClass::kMoving, 1.0, kStart);
  EXPECT_EQ(accounts.charged_seconds(named), 61.0) << "a block that ended after its session";
  ASSERT_EQ(accounts.open("museum", {1.0, 1.0}), named);
  EXPECT_EQ(accounts.begin(named, {false, 0.1, 1.0}, at(kMs)).work, WorkClass::kSpare);
}

TEST(Accounts, rank_the_classes_of_work_one_after_the_other) {
  using Turn = Accounts::Turn;
  const double kInfinite = std::numeric_limits<double>::infinity();
  std::uint64_t last = 0;
  for (const WorkClass work : {WorkClass::kMoving, WorkClass::kAtRest, WorkClass::kSpare}) {
    for (const double start : {-1.0, 1.0, 2.0, 1e12, kInfinite}) {
      const Rank rank = Turn{work, start, 0.0}.rank();
      EXPECT_GE(rank.wire(), last);
      last = rank.wire();
      EXPECT_EQ(Rank::of(last).work, work);
      EXPECT_EQ(Rank::of(last).position, rank.position);
    }
  }
  EXPECT_EQ(Rank::of(~std::uint64_t{0}).work, WorkClass::kSpare);
}

}  // namespace
}  // namespace cyclorama::coordinator
