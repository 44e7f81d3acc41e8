// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/governor/governor.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <random>

namespace cyclorama::governor {
namespace {

/// Costs 1, 2, 4 ... of as many samples, and errors that halve.
ParetoFront front_of(int points) {
  std::vector<ParetoPoint> made(static_cast<std::size_t>(points));
  for (int i = 0; i < points; ++i) {
    ParetoPoint& point = made[static_cast<std::size_t>(i)];
    point.quality.render.samples = 1 << i;
    point.cost = static_cast<double>(1 << i);
    point.error = 1.0 / point.cost;
  }
  return *ParetoFront::make(std::move(made));
}

/// Runs the governor for frames whose time is `ms_of(frame, cost)`; returns the costs that it chose.
std::vector<double> play(Governor& governor, int frames, const std::function<double(int, double)>& ms_of,
                         double megapixels = 1.0) {
  std::vector<double> chosen;
  for (int frame = 0; frame < frames; ++frame) {
    const double cost = governor.choose(megapixels).cost;
    governor.measured({cost * megapixels, ms_of(frame, cost * megapixels)});
    chosen.push_back(cost);
  }
  return chosen;
}

int changes(const std::vector<double>& chosen, std::size_t from = 0) {
  int count = 0;
  for (std::size_t i = from + 1; i < chosen.size(); ++i) count += chosen[i] != chosen[i - 1] ? 1 : 0;
  return count;
}

TEST(Governor, starts_at_the_cheapest_and_goes_to_what_fits) {
  Governor governor(front_of(8), 50.0);
  const auto chosen = play(governor, 200, [](int, double work) { return 2.0 * work; });
  EXPECT_EQ(chosen.front(), 1.0);
  EXPECT_GT(chosen[20], 20.0) << "40 ms";
  EXPECT_LT(chosen.back(), 25.0) << "50 ms";
  EXPECT_EQ(changes(chosen, 40), 0);
}

TEST(Governor, leaves_its_worst_picture_though_a_part_of_the_time_is_fixed) {
  for (const double ms_per_work : {0.02, 0.2, 2.0}) {
    for (const double fixed_ms : {5.0, 10.0, 20.0}) {
      Governor governor(ParetoFront::standard(), 50.0);
      const auto ms_of = [&](double work) { return fixed_ms + ms_per_work * work; };
      play(governor, 60, [&](int, double work) { return ms_of(work); });
      const double best = governor.front().best().cost;
      const double ms = ms_of(governor.current().cost);
      EXPECT_LE(ms, 50.0) << fixed_ms << ", " << ms_per_work;
      EXPECT_TRUE(ms > 40.0 || governor.current().cost == best) << fixed_ms << ", " << ms_per_work << ": " << ms;
    }
  }
}

TEST(Governor, gives_way_within_two_frames_when_costs_jump_tenfold) {
  Governor governor(front_of(8), 50.0);
  play(governor, 100, [](int, double work) { return work; });
  const auto chosen = play(governor, 100, [](int, double work) { return 10.0 * work; });
  EXPECT_GT(chosen[0], 40.0);
  EXPECT_LT(chosen[2], 5.0) << "50 ms";
  EXPECT_GT(chosen[40], 4.0);
}

TEST(Governor, gives_way_after_one_frame_when_thread_times_show_the_jump) {
  Governor governor(front_of(8), 50.0);
  const auto frame = [&](double factor) {
    const double work = governor.choose(1.0).cost;
    governor.measured({work, 5.0 + factor * work, factor * work});
  };
  for (int i = 0; i < 100; ++i) frame(1.0);
  frame(3.0);
  EXPECT_LT(5.0 + 3.0 * governor.choose(1.0).cost, 50.0);
}

TEST(Governor, comes_back_when_the_costs_have_fallen_again) {
  Governor governor(front_of(8), 50.0);
  const auto chosen = play(governor, 200, [](int frame, double work) { return (frame < 100 ? 10.0 : 1.0) * work; });
  EXPECT_LT(chosen[99], 5.0);
  EXPECT_GT(chosen[150], 40.0);
}

TEST(Governor, is_not_moved_by_one_frame_that_hung) {
  Governor governor(front_of(8), 50.0);
  play(governor, 100, [](int, double work) { return work; });
  const auto chosen = play(governor, 100, [](int frame, double work) { return (frame == 50 ? 30.0 : 1.0) * work; });
  EXPECT_GT(*std::ranges::min_element(chosen), 40.0);
  EXPECT_LE(changes(chosen), 2) << "the noise is larger for a while";
}

TEST(Governor, stays_at_the_cheapest_when_the_budget_cannot_be_kept) {
  Governor governor(front_of(8), 0.001);
  const auto chosen = play(governor, 100, [](int, double work) { return work; });
  EXPECT_EQ(*std::ranges::max_element(chosen), 1.0);
}

TEST(Governor, takes_the_best_when_the_budget_is_huge) {
  Governor governor(front_of(8), 1e12);
  EXPECT_EQ(play(governor, 100, [](int, double work) { return work; }).back(), 128.0);
}

TEST(Governor, has_no_choice_with_one_point) {
  Governor governor(front_of(1), 10.0);
  const auto chosen = play(governor, 100, [](int frame, double) { return frame % 2 == 0 ? 1.0 : 1000.0; });
  EXPECT_EQ(*std::ranges::max_element(chosen), 1.0);
}

TEST(Governor, ignores_times_that_are_none) {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  constexpr double kInfinite = std::numeric_limits<double>::infinity();
  for (const double bad : {0.0, -1.0, kNan, kInfinite}) {
    Governor governor(front_of(8), 50.0);
    play(governor, 100, [&](int, double) { return bad; });
    EXPECT_FALSE(governor.predicted_ms(1.0, 1.0)) << bad;
    play(governor, 100, [](int, double work) { return work; });
    const auto chosen = play(governor, 100, [&](int frame, double work) { return frame % 3 == 0 ? bad : work; });
    EXPECT_LE(changes(chosen), 1) << bad;
    EXPECT_GT(chosen.back(), 40.0) << bad;
  }
  Governor governor(front_of(8), 50.0);
  governor.measured({0.0, 10.0});
  EXPECT_FALSE(governor.predicted_ms(1.0, 1.0)) << "a picture without pixels";
}

TEST(Governor, follows_the_size_of_the_picture_at_once) {
  Governor governor(front_of(8), 50.0);
  play(governor, 100, [](int, double work) { return work; });
  const double cost = governor.choose(8.0).cost;
  EXPECT_LE(8.0 * cost, 50.0);
  EXPECT_GT(8.0 * cost, 40.0);
}

TEST(Governor, does_not_pump_when_times_are_noisy) {
  std::mt19937 random(7);
  std::lognormal_distribution<double> noise(0.0, 0.25);
  for (const double budget : {33.0, 36.0, 40.0, 44.0, 48.0, 52.0, 56.0, 60.0, 64.0}) {
    Governor governor(front_of(8), budget);
    const auto chosen = play(governor, 2000, [&](int, double work) { return work * noise(random); });
    EXPECT_LE(changes(chosen, 100), 2000 / 20) << budget;
  }
}

TEST(Governor, tries_less_and_less_often_what_proves_too_expensive) {
  // The more expensive point costs more than stated, so it appears to fit but does not.
  Governor governor(front_of(2), 10.0);
  const auto chosen = play(governor, 1000, [](int, double work) { return work < 2.0 ? 3.0 : 12.0; });
  const auto at_second = std::ranges::count(chosen, 2.0);
  EXPECT_GT(at_second, 0);
  EXPECT_LT(at_second, 60);
}

TEST(Governor, never_chooses_a_larger_error_for_a_larger_budget) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> any(0.0, 1.0);
  for (int trial = 0; trial < 20; ++trial) {
    std::vector<ParetoPoint> points(12);
    for (ParetoPoint& point : points) {
      point.cost = std::exp(6.0 * any(random));
      point.error = any(random);
    }
    const ParetoFront front = *ParetoFront::make(points);
    const double overhead = 5.0 * any(random);
    double last = std::numeric_limits<double>::infinity();
    for (const double budget : {10.0, 20.0, 33.0, 50.0, 100.0, 1000.0, 10000.0}) {
      Governor governor(front, budget);
      const auto chosen = play(governor, 400, [&](int, double work) { return overhead + work; });
      EXPECT_LE(governor.current().error, last) << "trial " << trial << ", budget " << budget;
      last = governor.current().error;
      EXPECT_EQ(changes(chosen, 350), 0) << "trial " << trial << ", budget " << budget;
    }
  }
}

}  // namespace
}  // namespace cyclorama::governor
