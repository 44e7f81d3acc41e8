// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/balance/balancer.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <random>

#include "renderfarm/balance/tiles.h"

namespace cyclorama {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

std::vector<PixelRect> split(Balancer& balancer, PictureSize size, const std::vector<double>& speeds,
                             double heading_rad = 0.0) {
  std::vector<PixelRect> rects(speeds.size());
  for (const PlannedBlock& block : balancer.split({size, speeds, heading_rad, std::numbers::pi})) {
    rects[block.node] = block.rect;
  }
  return rects;
}

/// That the blocks tile the picture: on the grid, inside, and each 16 px cell in exactly one.
testing::AssertionResult tile_exactly(PictureSize size, const std::vector<PixelRect>& blocks) {
  const int columns = (size.width + kCutPx - 1) / kCutPx;
  const int rows = (size.height + kCutPx - 1) / kCutPx;
  std::vector<char> taken(static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows));
  std::int64_t area = 0;
  for (const PixelRect& b : blocks) {
    if (b.empty()) continue;
    const int right = b.x + b.width;
    const int bottom = b.y + b.height;
    if (b.x < 0 || b.y < 0 || right > size.width || bottom > size.height)
      return testing::AssertionFailure() << "outside";
    if (b.x % kCutPx != 0 || b.y % kCutPx != 0 || (right % kCutPx != 0 && right != size.width) ||
        (bottom % kCutPx != 0 && bottom != size.height)) {
      return testing::AssertionFailure() << "off the grid";
    }
    area += b.area();
    for (int y = b.y / kCutPx; y * kCutPx < bottom; ++y) {
      for (int x = b.x / kCutPx; x * kCutPx < right; ++x) {
        char& cell =
            taken[static_cast<std::size_t>(y) * static_cast<std::size_t>(columns) + static_cast<std::size_t>(x)];
        if (cell++ != 0) return testing::AssertionFailure() << "overlap at cell " << x << ", " << y;
      }
    }
  }
  if (area != std::int64_t{size.width} * size.height) return testing::AssertionFailure() << "a hole";
  return testing::AssertionSuccess();
}

/// Cost per pixel at a place in fractions of the picture.
using CostFunction = std::function<double(double x, double y)>;

double cost_of(const CostFunction& cost, PictureSize size, const PixelRect& block) {
  double sum = 0.0;
  for (int y = block.y; y < block.y + block.height; y += 4) {
    for (int x = block.x; x < block.x + block.width; x += 4)
      sum += cost((x + 2.0) / size.width, (y + 2.0) / size.height);
  }
  return sum;
}

struct Trial {
  double last_efficiency = 0.0;
  double mean_efficiency = 0.0;
  int moves = 0;
};

Trial rendered(Balancer& balancer, PictureSize size, const std::vector<double>& speeds, int frames,
               const std::function<CostFunction(int)>& cost_at, double radians_per_frame = 0.0) {
  Trial result;
  std::vector<PixelRect> before;
  for (int frame = 0; frame < frames; ++frame) {
    const double heading = radians_per_frame * frame;
    const auto blocks = split(balancer, size, speeds, heading);
    EXPECT_TRUE(tile_exactly(size, blocks));
    std::vector<MeasuredBlock> measured;
    std::vector<double> loads;
    for (std::size_t i = 0; i < blocks.size(); ++i) {
      measured.push_back({blocks[i], cost_of(cost_at(frame), size, blocks[i])});
      loads.push_back(measured.back().cpu_seconds / speeds[i]);
    }
    result.last_efficiency = balance_efficiency(loads);
    result.mean_efficiency += result.last_efficiency / frames;
    result.moves += blocks != before;
    before = blocks;
    balancer.learn({size, measured, heading});
  }
  return result;
}

/// A relic in the middle of nothing, the hard case: most of the cost on a tenth of the picture.
double relic(double x, double y) {
  const double r2 = (x - 0.4) * (x - 0.4) * 9.0 + (y - 0.5) * (y - 0.5) * 4.0;
  return 0.1 + 4.0 * std::exp(-6.0 * r2);
}
double rough_wall(double x, double y) { return 1.0 + 0.6 * std::sin(9.0 * x) * std::cos(7.0 * y) + 0.8 * x; }

TEST(Balancer, tiles_the_picture_exactly_for_1_to_300_nodes) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> cost(0.0, 3.0);
  for (const BalanceStrategy strategy : {BalanceStrategy::kEqual, BalanceStrategy::kPbt}) {
    for (const PictureSize size : {PictureSize{1920, 1080}, PictureSize{1000, 777}, PictureSize{4096, 300}}) {
      for (std::size_t n = 1; n <= 300; ++n) {
        const auto balancer = make_balancer(strategy);
        const std::vector<double> speeds(n, 1.0);
        for (int frame = 0; frame < 3; ++frame) {
          const auto blocks = split(*balancer, size, speeds);
          ASSERT_EQ(blocks.size(), n);
          ASSERT_TRUE(tile_exactly(size, blocks)) << n << " nodes, " << size.width << "x" << size.height;
          std::vector<MeasuredBlock> measured;
          for (const PixelRect& block : blocks) measured.push_back({block, cost(random)});
          balancer->learn({size, measured, 0.0});
        }
      }
    }
  }
}

TEST(Balancer, tiles_pictures_of_any_size) {
  for (const PictureSize size :
       {PictureSize{1, 1}, PictureSize{1, 16384}, PictureSize{16384, 1}, PictureSize{16384, 16384}, PictureSize{17, 17},
        PictureSize{33, 47}, PictureSize{48, 48}, PictureSize{16, 160}}) {
    for (const std::size_t n : {1u, 2u, 3u, 4u, 7u, 8u, 9u, 16u, 64u, 300u}) {
      const auto blocks = split(*make_balancer(BalanceStrategy::kPbt), size, std::vector<double>(n, 1.0));
      ASSERT_TRUE(tile_exactly(size, blocks)) << n << " nodes, " << size.width << "x" << size.height;
      const std::size_t cells =
          static_cast<std::size_t>((size.width + 15) / 16) * static_cast<std::size_t>((size.height + 15) / 16);
      EXPECT_EQ(static_cast<std::size_t>(std::ranges::count_if(blocks, [](const auto& b) { return !b.empty(); })),
                std::min(n, cells));
    }
  }
}

TEST(Balancer, bears_costs_and_speeds_that_are_no_numbers) {
  for (const double bad : {0.0, kNan, kInfinity, -kInfinity, -1.0, 1e308, 5e-324}) {
    for (const bool all : {true, false}) {
      const auto balancer = make_balancer(BalanceStrategy::kPbt);
      const PictureSize size{1600, 900};
      for (int frame = 0; frame < 4; ++frame) {
        const auto blocks = split(*balancer, size, {1.0, all ? bad : 1.0, 2.0, 1.0, bad}, frame == 2 ? bad : 0.0);
        ASSERT_TRUE(tile_exactly(size, blocks)) << bad;
        std::vector<MeasuredBlock> measured;
        for (const PixelRect& block : blocks) measured.push_back({block, all || measured.size() == 2 ? bad : 1.0});
        balancer->learn({size, measured, all ? bad : 0.0});
      }
    }
  }
}

TEST(Balancer, has_nothing_to_say_without_nodes) {
  EXPECT_TRUE(split(*make_balancer(BalanceStrategy::kPbt), {640, 480}, {}).empty());
}

TEST(Pbt, converges_on_uneven_costs_within_a_few_frames) {
  for (const auto& [name, cost] : {std::pair("relic", CostFunction(relic)), {"rough_wall", CostFunction(rough_wall)}}) {
    const auto pbt = make_balancer(BalanceStrategy::kPbt);
    const Trial result =
        rendered(*pbt, {1920, 1080}, std::vector<double>(8, 1.0), 10, [&, c = cost](int) { return c; });
    EXPECT_GE(result.last_efficiency, 0.9);
    RecordProperty(name, std::to_string(result.last_efficiency));
  }
}

TEST(Pbt, is_better_than_equal_blocks_on_a_picture_that_moves) {
  const auto moving = [](int frame) {
    return CostFunction([frame](double x, double y) { return relic(x + 0.3 * std::sin(0.05 * frame), y); });
  };
  for (const std::size_t n : {8u, 16u, 32u}) {
    const std::vector<double> speeds(n, 1.0);
    const Trial equal = rendered(*make_balancer(BalanceStrategy::kEqual), {1920, 1080}, speeds, 60, moving);
    const Trial pbt = rendered(*make_balancer(BalanceStrategy::kPbt), {1920, 1080}, speeds, 60, moving);
    EXPECT_GT(pbt.mean_efficiency, 1.3 * equal.mean_efficiency) << n << " nodes";
    RecordProperty("pbt_" + std::to_string(n), std::to_string(pbt.mean_efficiency));
    RecordProperty("equal_" + std::to_string(n), std::to_string(equal.mean_efficiency));
  }
}

TEST(Pbt, gives_a_faster_node_more) {
  const std::vector<double> speeds{1.0, 4.0, 1.0, 2.0};
  const Trial result = rendered(*make_balancer(BalanceStrategy::kPbt), {1920, 1080}, speeds, 10,
                                [](int) { return CostFunction(rough_wall); });
  EXPECT_GE(result.last_efficiency, 0.93);
}

TEST(Pbt, stands_still_when_times_only_tremble) {
  std::mt19937 random(3);
  std::normal_distribution<double> tremble(1.0, 0.003);
  const Trial result =
      rendered(*make_balancer(BalanceStrategy::kPbt), {1920, 1080}, std::vector<double>(8, 1.0), 60, [&](int) {
        return CostFunction([factor = tremble(random)](double x, double y) { return factor * rough_wall(x, y); });
      });
  EXPECT_LE(result.moves, 8);
}

TEST(Pbt, goes_on_when_nodes_come_and_go) {
  const auto pbt = make_balancer(BalanceStrategy::kPbt);
  for (const std::size_t n : {4u, 5u, 3u, 8u}) {
    const Trial result =
        rendered(*pbt, {1920, 1080}, std::vector<double>(n, 1.0), 10, [](int) { return CostFunction(relic); });
    EXPECT_GE(result.last_efficiency, 0.88) << n;
  }
}

TEST(Pbt, takes_the_costs_along_when_the_visitor_turns) {
  // The picture spans pi, so turning by r shifts its content left by r / pi.
  const double turn = 0.06;
  const auto turned = [&](int frame) {
    return CostFunction(
        [shift = turn * frame / std::numbers::pi](double x, double y) { return relic(x + shift - 0.4, y); });
  };
  const std::vector<double> speeds(8, 1.0);
  const Trial told = rendered(*make_balancer(BalanceStrategy::kPbt), {1920, 1080}, speeds, 30, turned, turn);
  const Trial untold = rendered(*make_balancer(BalanceStrategy::kPbt), {1920, 1080}, speeds, 30, turned, 0.0);
  EXPECT_GT(told.mean_efficiency, untold.mean_efficiency);
}

TEST(BalanceEfficiency, is_mean_over_largest) {
  EXPECT_DOUBLE_EQ(balance_efficiency(std::vector<double>{1.0, 1.0, 1.0}), 1.0);
  EXPECT_DOUBLE_EQ(balance_efficiency(std::vector<double>{1.0, 3.0}), 2.0 / 3.0);
  EXPECT_DOUBLE_EQ(balance_efficiency(std::vector<double>{0.0, 0.0, 0.0, 2.0}), 0.25);
  EXPECT_DOUBLE_EQ(balance_efficiency({}), 1.0);
}

}  // namespace
}  // namespace cyclorama
