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

TEST(ParetoFront, keeps_what_no_cheaper_point_beats_in_the_order_of_cost) {
  const auto front = ParetoFront::make(
      {point_of(8, 1), point_of(1, 9), point_of(2, 9), point_of(4, 3), point_of(4, 2), point_of(16, 1)});
  ASSERT_TRUE(front);
  ASSERT_EQ(front->size(), 3u);
  EXPECT_EQ((*front)[0].cost, 1.0);
  EXPECT_EQ((*front)[1].error, 2.0);
  EXPECT_EQ(front->best().cost, 8.0);
}

TEST(ParetoFront, refuses_no_points_and_points_that_are_none) {
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

TEST(ParetoFront, has_a_standard_one_in_which_every_point_is_on_the_front) {
  const ParetoFront front = ParetoFront::standard(3);
  EXPECT_GE(front.size(), 8u);
  for (std::size_t i = 1; i < front.size(); ++i) {
    EXPECT_GT(front[i].cost, front[i - 1].cost);
    EXPECT_LT(front[i].error, front[i - 1].error);
  }
}

TEST(ParetoFront, has_a_standard_one_that_never_changes_the_bounces) {
  EXPECT_EQ(ParetoFront::standard()[0].quality.render.bounces, kStandardBounces);
  for (const int bounces : {0, 4, 64}) {
    const ParetoFront front = ParetoFront::standard(bounces);
    // NOLINTNEXTLINE(clang-analyzer-security.FloatLoopCounter): any few costs will do.
    for (double cost = 0.1; cost < 1000.0; cost *= 1.03) {
      ASSERT_EQ(front.at(cost).quality.render.bounces, bounces) << cost;
    }
  }
}

TEST(ParetoFront, spends_nearly_any_cost_between_its_ends) {
  const ParetoFront front = ParetoFront::standard();
  EXPECT_EQ(front.at(0.0).quality, front[0].quality);
  EXPECT_EQ(front.at(1e9).quality, front.best().quality);
  ParetoPoint last = front[0];
  // NOLINTNEXTLINE(clang-analyzer-security.FloatLoopCounter): any few costs will do.
  for (double cost = front[0].cost; cost < front.best().cost; cost *= 1.01) {
    const ParetoPoint point = front.at(cost);
    ASSERT_TRUE(validate(point.quality)) << cost;
    EXPECT_LE(point.cost, cost * (1.0 + 1e-9));
    EXPECT_GE(point.cost, 0.97 * cost) << "the samples are whole numbers";
    EXPECT_LE(point.error, last.error) << cost;
    EXPECT_GE(point.quality.render.samples, last.quality.render.samples) << cost;
    if (point.quality.render.samples == last.quality.render.samples && cost < 300.0) {
      EXPECT_GE(point.quality.scale, last.quality.scale) << cost;
    }
    last = point;
  }
}

TEST(ParetoFront, gives_pixels_first_and_keeps_most_of_them) {
  const ParetoFront front = ParetoFront::standard();
  bool is_large = false;
  // NOLINTNEXTLINE(clang-analyzer-security.FloatLoopCounter): any few costs will do.
  for (double cost = front[0].cost; cost < front.best().cost; cost *= 1.01) {
    const render::PictureQuality quality = front.at(cost).quality;
    if (quality.render.samples > 1) {
      EXPECT_GE(quality.scale, 0.7) << cost;
    }
    EXPECT_FALSE(is_large && quality.scale < 0.7) << cost;
    is_large = is_large || quality.scale >= 0.71;
  }
}

TEST(ParetoFront, returns_its_points_at_their_costs) {
  for (const ParetoFront& front :
       {ParetoFront::standard(), *ParetoFront::make({point_of(1, 4), point_of(3, 2), point_of(5, 1)})}) {
    for (std::size_t i = 0; i < front.size(); ++i) {
      const ParetoPoint point = front.at(front[i].cost);
      EXPECT_EQ(point.quality.render.samples, front[i].quality.render.samples) << i;
      EXPECT_NEAR(point.quality.scale, front[i].quality.scale, 1e-9) << i;
      EXPECT_NEAR(point.error, front[i].error, 1e-12) << i;
    }
  }
}

}  // namespace
}  // namespace cyclorama::governor
