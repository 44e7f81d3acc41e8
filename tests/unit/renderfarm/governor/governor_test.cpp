// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/governor/governor.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <limits>
#include <random>

namespace cyclorama::governor {
namespace {

/// Costs 1, 2, 4 ... and errors that halve.
ParetoFront front_of(int points) {
  std::vector<ParetoPoint> made(static_cast<std::size_t>(points));
  for (int i = 0; i < points; ++i) {
    made[static_cast<std::size_t>(i)].cost = static_cast<double>(1 << i);
    made[static_cast<std::size_t>(i)].error = 1.0 / static_cast<double>(1 << i);
  }
  return *ParetoFront::make(std::move(made));
}

/// Runs the governor for frames whose time is `ms_of(frame, cost)`; returns its choices.
std::vector<std::size_t> play(Governor& governor, int frames, const std::function<double(int, double)>& ms_of,
                              double megapixels = 1.0) {
  std::vector<std::size_t> chosen;
  for (int frame = 0; frame < frames; ++frame) {
    const std::size_t point = governor.choose(megapixels);
    governor.measured(point, megapixels, ms_of(frame, governor.front()[point].cost) * megapixels);
    chosen.push_back(point);
  }
  return chosen;
}

int changes(const std::vector<std::size_t>& chosen, std::size_t from = 0) {
  int count = 0;
  for (std::size_t i = from + 1; i < chosen.size(); ++i) count += chosen[i] != chosen[i - 1] ? 1 : 0;
  return count;
}

TEST(Governor, starts_at_the_cheapest_point_and_goes_directly_to_the_best_that_fits) {
  Governor governor(front_of(8), 50.0);
  const auto chosen = play(governor, 200, [](int, double cost) { return 2.0 * cost; });
  EXPECT_EQ(chosen.front(), 0u);
  EXPECT_EQ(chosen.back(), 4u) << "32 ms: 64 would be too long";
  EXPECT_EQ(changes(chosen), 1);
}

TEST(Governor, reduces_quality_within_two_frames_when_costs_jump_tenfold) {
  Governor governor(front_of(8), 50.0);
  play(governor, 100, [](int, double cost) { return cost; });
  const auto chosen = play(governor, 100, [](int, double cost) { return 10.0 * cost; });
  EXPECT_EQ(chosen[0], 5u);
  EXPECT_EQ(chosen[2], 2u) << "40 ms";
  EXPECT_EQ(changes(chosen), 1);
}

TEST(Governor, returns_when_the_costs_have_fallen_again) {
  Governor governor(front_of(8), 50.0);
  const auto chosen = play(governor, 400, [](int frame, double cost) { return (frame < 100 ? 10.0 : 1.0) * cost; });
  EXPECT_EQ(chosen[99], 2u);
  EXPECT_EQ(chosen[105], 2u) << "slowly";
  EXPECT_EQ(chosen.back(), 5u);
}

TEST(Governor, ignores_one_slow_frame) {
  Governor governor(front_of(8), 50.0);
  play(governor, 100, [](int, double cost) { return cost; });
  const auto chosen = play(governor, 100, [](int frame, double cost) { return (frame == 50 ? 30.0 : 1.0) * cost; });
  EXPECT_EQ(changes(chosen), 0);
}

TEST(Governor, stays_at_the_cheapest_point_when_the_budget_cannot_be_kept) {
  Governor governor(front_of(8), 0.001);
  const auto chosen = play(governor, 100, [](int, double cost) { return cost; });
  EXPECT_EQ(*std::ranges::max_element(chosen), 0u);
}

TEST(Governor, takes_the_best_point_for_a_huge_budget) {
  Governor governor(front_of(8), 1e12);
  EXPECT_EQ(play(governor, 100, [](int, double cost) { return cost; }).back(), 7u);
}

TEST(Governor, has_no_choice_with_one_point) {
  Governor governor(front_of(1), 10.0);
  const auto chosen = play(governor, 100, [](int frame, double) { return frame % 2 == 0 ? 1.0 : 1000.0; });
  EXPECT_EQ(*std::ranges::max_element(chosen), 0u);
}

TEST(Governor, ignores_invalid_times) {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  constexpr double kInfinite = std::numeric_limits<double>::infinity();
  for (const double bad : {0.0, -1.0, kNan, kInfinite}) {
    Governor governor(front_of(8), 50.0);
    play(governor, 100, [&](int, double) { return bad; });
    EXPECT_FALSE(governor.predicted_ms(0, 1.0)) << bad;
    play(governor, 100, [](int, double cost) { return cost; });
    const auto chosen = play(governor, 100, [&](int frame, double cost) { return frame % 3 == 0 ? bad : cost; });
    EXPECT_EQ(changes(chosen), 0) << bad;
    EXPECT_EQ(chosen.back(), 5u) << bad;
  }
  Governor governor(front_of(8), 50.0);
  governor.measured(0, 0.0, 10.0);
  EXPECT_FALSE(governor.predicted_ms(0, 1.0)) << "a picture without pixels";
}

TEST(Governor, adapts_at_once_to_the_size_of_the_picture) {
  Governor governor(front_of(8), 50.0);
  play(governor, 100, [](int, double cost) { return cost; });
  EXPECT_EQ(play(
                governor, 1, [](int, double cost) { return cost; }, 8.0)
                .front(),
            2u);
}

TEST(Governor, does_not_oscillate_when_times_are_noisy) {
  std::mt19937 random(7);
  std::lognormal_distribution<double> noise(0.0, 0.25);
  // The budget may lie anywhere between two points.
  for (const double budget : {33.0, 36.0, 40.0, 44.0, 48.0, 52.0, 56.0, 60.0, 64.0}) {
    Governor governor(front_of(8), budget);
    const auto chosen = play(governor, 2000, [&](int, double cost) { return cost * noise(random); });
    EXPECT_LE(changes(chosen, 100), 2000 / 80) << budget;
  }
}

TEST(Governor, retries_a_point_that_proved_too_expensive_ever_more_rarely) {
  // The more expensive point costs more than stated, so it appears to fit but does not.
  Governor governor(front_of(2), 10.0);
  const auto chosen = play(governor, 1000, [](int, double cost) { return cost < 2.0 ? 3.0 : 12.0; });
  const auto at_second = std::ranges::count(chosen, 1u);
  EXPECT_GT(at_second, 0);
  EXPECT_LT(at_second, 40);
  EXPECT_LE(changes(chosen), 24);
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
      const auto chosen = play(governor, 400, [&](int, double cost) { return overhead + cost; });
      EXPECT_LE(front[chosen.back()].error, last) << "trial " << trial << ", budget " << budget;
      last = front[chosen.back()].error;
      EXPECT_EQ(changes(chosen, 350), 0) << "trial " << trial << ", budget " << budget;
    }
  }
}

}  // namespace
}  // namespace cyclorama::governor
