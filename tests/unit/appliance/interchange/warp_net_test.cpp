// SPDX-License-Identifier: Apache-2.0
#include "appliance/interchange/warp_net.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "appliance/interchange/map_sampling.h"
#include "tests/data_sets/generated_warps.h"

namespace cyclorama::interchange {
namespace {

WarpNet square(int columns, int rows) {
  WarpNet net;
  net.columns = columns;
  net.rows = rows;
  for (int j = 0; j < rows; ++j) {
    for (int i = 0; i < columns; ++i) {
      const double x = static_cast<double>(i) / (columns - 1);
      const double y = static_cast<double>(j) / (rows - 1);
      net.nodes.push_back({x, y, x, y, 1.0});
    }
  }
  return net;
}

TEST(WarpNet, an_even_grid_becomes_the_identity_map) {
  const auto region = region_from(square(7, 5), "r", 20, 10);
  ASSERT_TRUE(region.has_value()) << region.error().message();
  EXPECT_FALSE(region->alpha.has_value());
  for (int y = 0; y < 10; ++y) {
    for (int x = 0; x < 20; ++x) {
      EXPECT_NEAR(region->map->at(x, y)[0], (x + 0.5) / 20, 1e-6) << x << ' ' << y;
      EXPECT_NEAR(region->map->at(x, y)[1], 1.0 - (y + 0.5) / 10, 1e-6) << x << ' ' << y;
    }
  }
  EXPECT_TRUE(check(*region, WarpProfile::k2d).has_value());
}

TEST(WarpNet, light_becomes_a_mask_and_undrawn_cells_are_unmapped) {
  WarpNet net = square(3, 2);
  net.nodes[0].light = net.nodes[3].light = 0.5;  // The left edge.
  net.nodes[2].light = -1.0;                      // Lower right.
  net.nodes[5].light = 1.0;
  const auto region = region_from(net, "r", 8, 4);
  ASSERT_TRUE(region.has_value());
  ASSERT_TRUE(region->alpha.has_value());
  EXPECT_NEAR(region->alpha->light_at(0, 1), 0.5 + 0.5 * 0.125, 1e-4);
  EXPECT_TRUE(std::isnan(region->map->at(7, 3)[0]));
  EXPECT_EQ(region->alpha->light_at(7, 3), 0.0);
}

TEST(WarpNet, a_smooth_map_survives_conversion_to_a_grid_and_back) {
  WarpRegion region;
  region.id = "r";
  region.width_px = 160;
  region.height_px = 100;
  region.map = WarpMap(160, 100);
  for (int y = 0; y < 100; ++y) {
    for (int x = 0; x < 160; ++x) {
      const double u = (x + 0.5) / 160;
      const double v = 1.0 - (y + 0.5) / 100;
      region.map->at(x, y)[0] = static_cast<float>(0.2 + 0.5 * u + 0.1 * std::sin(v));
      region.map->at(x, y)[1] = static_cast<float>(0.1 + 0.7 * v + 0.1 * std::sin(u));
    }
  }
  const auto net = net_from(region, 33, 21);
  ASSERT_TRUE(net.has_value());
  const auto back = region_from(*net, "r", 160, 100);
  ASSERT_TRUE(back.has_value()) << back.error().message();
  double worst = 0.0;
  for (std::size_t i = 0; i < region.map->data().size(); ++i) {
    worst = std::max(worst, std::abs(static_cast<double>(region.map->data()[i] - back->map->data()[i])));
  }
  EXPECT_LT(worst, 2e-4);
}

TEST(WarpNet, a_polar_grid_is_closed) {
  WarpNet net = square(4, 2);
  EXPECT_EQ(net.drawn().size(), 6U);
  net.closed = true;
  EXPECT_EQ(net.drawn().size(), 8U);
}

TEST(WarpNet, refuses_invalid_grids) {
  WarpNet outside = square(2, 2);
  for (WarpNode& node : outside.nodes) node.x += 5.0;
  EXPECT_EQ(region_from(outside, "r", 8, 8).error().code(), ErrorCode::kBadData);
  EXPECT_EQ(region_from(square(2, 2), "r", 0, 8).error().code(), ErrorCode::kInvalidArgument);
  WarpNet torn = square(3, 3);
  torn.nodes.pop_back();
  EXPECT_FALSE(check(torn).has_value());
  torn.columns = torn.rows = 0;
  EXPECT_FALSE(check(torn).has_value()) << "no faces";
  torn.triangles = {{0, 1, 8}};
  EXPECT_FALSE(check(torn).has_value()) << "no node 9";
  EXPECT_EQ(net_from(WarpRegion(), 3, 3).error().code(), ErrorCode::kInvalidArgument);
  WarpRegion region;
  region.map = WarpMap(1, 1);
  EXPECT_EQ(net_from(region, 1, 3).error().code(), ErrorCode::kInvalidArgument);
  EXPECT_TRUE(net_from(region, 2, 2).has_value()) << "one sample is the same everywhere";
}

TEST(MapSampling, is_linear_between_and_beyond_samples_and_nearest_at_a_rim) {
  WarpMap map(2, 1);
  map.at(0, 0)[0] = 1.0f;
  map.at(1, 0)[0] = 3.0f;
  EXPECT_EQ(sample_map(map, 0.5, 0.5)->x(), 2.0);
  EXPECT_EQ(sample_map(map, 0.0, 0.5)->x(), 0.0);
  EXPECT_EQ(sample_map(map, 1.0, 0.9)->x(), 4.0);
  map.at(0, 0)[1] = std::numeric_limits<float>::quiet_NaN();
  EXPECT_EQ(sample_map(map, 0.6, 0.5)->x(), 3.0);
  EXPECT_FALSE(sample_map(map, 0.4, 0.5).has_value());
}

}  // namespace
}  // namespace cyclorama::interchange
