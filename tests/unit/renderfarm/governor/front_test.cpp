// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/governor/front.h"

#include <gtest/gtest.h>

#include <limits>

namespace cyclorama::governor {
namespace {

ParetoPoint point_of(double cost, double error) {
  ParetoPoint point;
  point.cost = cost;
  point.error = error;
  return point;
}

TEST(ParetoFront, keeps_the_points_that_no_cheaper_point_beats_in_order_of_cost) {
  const auto front = ParetoFront::make(
      {point_of(8, 1), point_of(1, 9), point_of(2, 9), point_of(4, 3), point_of(4, 2), point_of(16, 1)});
  ASSERT_TRUE(front);
  ASSERT_EQ(front->size(), 3u);
  EXPECT_EQ((*front)[0].cost, 1.0);
  EXPECT_EQ((*front)[1].error, 2.0);
  EXPECT_EQ(front->best().cost, 8.0);
}

TEST(ParetoFront, refuses_an_empty_list_and_invalid_points) {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  constexpr double kInfinite = std::numeric_limits<double>::infinity();
  EXPECT_FALSE(ParetoFront::make({}));
  for (const ParetoPoint& bad : {point_of(0, 1), point_of(-1, 1), point_of(kNan, 1), point_of(kInfinite, 1),
                                 point_of(1, kNan), point_of(1, -1), point_of(1, kInfinite)}) {
    EXPECT_FALSE(ParetoFront::make({point_of(1, 1), bad}));
  }
  ParetoPoint bad = point_of(1, 1);
  bad.quality.scale = 2.0;
  EXPECT_FALSE(ParetoFront::make({bad}));
}

TEST(ParetoFront, has_a_standard_one_of_which_no_point_is_dominated) {
  const ParetoFront front = ParetoFront::standard();
  EXPECT_GE(front.size(), 8u);
  for (std::size_t i = 1; i < front.size(); ++i) {
    EXPECT_GT(front[i].cost, front[i - 1].cost);
    EXPECT_LT(front[i].error, front[i - 1].error);
  }
}

}  // namespace
}  // namespace cyclorama::governor
