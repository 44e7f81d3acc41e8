// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/render/trade/trade_point.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

namespace cyclorama::render {
namespace {

using testing::HasSubstr;

TradePoint point_of(int samples, double cpu_s, double flip, int jpeg_quality = trade_base().jpeg_quality) {
  TradePoint point;
  point.planned = {"samples", trade_base()};
  point.planned.quality.render.samples = samples;
  point.planned.quality.jpeg_quality = jpeg_quality;
  point.cpu_s = cpu_s;
  point.shown.flip = flip;
  point.relmse = flip;
  point.bytes = 1000;
  return point;
}

TEST(TradeParetoFront, contains_the_points_that_no_cheaper_one_beats_per_shown_pixel) {
  const std::vector<TradePoint> points = {point_of(1, 1.0, 0.4), point_of(2, 3.0, 0.5), point_of(4, 4.0, 0.2)};
  const auto front = trade_pareto_front(points, 1000.0);
  ASSERT_TRUE(front) << front.error().message();
  ASSERT_EQ(front->size(), 2u);
  EXPECT_DOUBLE_EQ((*front)[0].cost, 1000.0);
  EXPECT_EQ((*front)[1].error, 0.2);
  EXPECT_TRUE(is_on(*front, points[0]));
  EXPECT_FALSE(is_on(*front, points[1]));
}

TEST(TradeParetoFront, uses_the_error_of_light_like_the_standard_one) {
  TradePoint point = point_of(1, 1.0, 0.4);
  point.relmse = 0.03;
  EXPECT_EQ((*trade_pareto_front({point}, 1000.0))[0].error, 0.03);
}

TEST(TradeParetoFront, leaves_out_points_with_another_coding) {
  const auto front = trade_pareto_front({point_of(1, 1.0, 0.4), point_of(1, 1.0, 0.1, 98)}, 1000.0);
  ASSERT_TRUE(front);
  ASSERT_EQ(front->size(), 1u);
  EXPECT_EQ((*front)[0].error, 0.4);
  EXPECT_FALSE(trade_pareto_front({point_of(1, 1.0, 0.1, 98)}, 1000.0));
}

TEST(TradeCsv, has_the_same_number_of_columns_in_each_line) {
  const std::vector<TradePoint> points = {point_of(1, 1.0, 0.4), point_of(4, 4.0, 0.2)};
  const std::string csv = trade_csv(points, *trade_pareto_front(points, 1.0));
  EXPECT_EQ(std::ranges::count(csv, '\n'), 3);
  EXPECT_EQ(std::ranges::count(csv, ','), 3 * 19);
  EXPECT_THAT(csv, HasSubstr("\nsamples,4,2,1,0,0,1,0,85,1,4000.000,"));
}

TEST(TradeSvg, names_axes_and_settings) {
  const std::vector<TradePoint> points = {point_of(1, 1.0, 0.4), point_of(4, 4.0, 0.2)};
  EXPECT_THAT(trade_svg(points, *trade_pareto_front(points, 1.0), "grotto"),
              testing::AllOf(HasSubstr("grotto"), HasSubstr("FLIP"), HasSubstr("relMSE"), HasSubstr("bytes"),
                             HasSubstr("adaptive"), HasSubstr("front")));
}

}  // namespace
}  // namespace cyclorama::render
