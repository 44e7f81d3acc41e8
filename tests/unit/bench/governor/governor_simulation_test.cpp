// SPDX-License-Identifier: Apache-2.0
// The governor's promises, in simulated time.
#include "tests/bench/governor/governor_simulation.h"

#include <gtest/gtest.h>

namespace cyclorama {
namespace {

TEST(GovernorSimulation, settles_within_two_seconds_and_uses_the_budget_without_exceeding_it) {
  std::vector<GovernorOutcome> outcomes;
  for (const GovernorCase& simulated : governor_cases(2)) {
    outcomes.push_back(simulate(governor::ParetoFront::standard(), simulated));
    const GovernorFigures one = figures_of({outcomes.back()});
    EXPECT_LE(one.settled_s_max, 2.0) << simulated.name();
    EXPECT_GE(one.used_min, 0.8) << simulated.name();
    EXPECT_EQ(one.over_p95, 0) << simulated.name();
  }
  const GovernorFigures figures = figures_of(outcomes);
  EXPECT_EQ(figures.cases, 300);
  EXPECT_EQ(figures.stuck, 0);
  EXPECT_LE(figures.changes_per_s_max, 2.0);
}

TEST(GovernorSimulation, shows_a_large_picture_where_the_time_allows) {
  // 512 cores: a sample of every pixel takes less than half of the budget in the cheap region.
  const GovernorOutcome outcome = simulate(governor::ParetoFront::standard(), {.cores = 512});
  EXPECT_GE(outcome.segments.front().min_scale, 0.7);
  EXPECT_GE(outcome.segments.back().min_scale, 0.7);
}

TEST(GovernorSimulation, runs_the_same_twice) {
  const GovernorCase simulated{.seed = 3};
  const GovernorFigures first = figures_of({simulate(governor::ParetoFront::standard(), simulated)});
  const GovernorFigures second = figures_of({simulate(governor::ParetoFront::standard(), simulated)});
  EXPECT_EQ(first.used_min, second.used_min);
  EXPECT_EQ(first.settled_s_max, second.settled_s_max);
}

}  // namespace
}  // namespace cyclorama
