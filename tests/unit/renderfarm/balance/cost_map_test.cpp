// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/balance/cost_map.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

namespace cyclorama::balance {
namespace {

constexpr PictureSize kSize{640, 320};  // 40 x 20 cells.
const CostMapOptions kSharp{.spreads = 0.0};

using Density = std::function<double(double x, double y)>;  // Seconds per pixel at a position in pixels.

MeasuredBlock measured(PictureSize size, const Density& density, bool reports_cells = true) {
  WorkGrid work(size);
  for (int y = 0; y < work.rows(); ++y) {
    for (int x = 0; x < work.columns(); ++x) {
      const double seconds = density(16.0 * x + 0.5 * work.width_px(x), 16.0 * y + 0.5 * work.height_px(y));
      work.at(x, y) = static_cast<float>(seconds * work.width_px(x) * work.height_px(y));
    }
  }
  MeasuredBlock block{{0, 0, size.width, size.height}, work.total()};
  if (reports_cells) block.cell_cpu_seconds.assign(work.cells().begin(), work.cells().end());
  return block;
}

void learn(CostMap* map, const MeasuredBlock& block, double heading_rad = 0.0, double eye_x = 0.0,
           double effort = 1.0) {
  map->learn({{block.rect.width, block.rect.height}, {&block, 1}, heading_rad, {eye_x, 0.0, 0.0}, effort});
}

SplitRequest view(PictureSize size = kSize, double heading_rad = 0.0, double eye_x = 0.0, double effort = 1.0) {
  return {.size = size,
          .speeds = {},
          .heading_rad = heading_rad,
          .azimuth_span_rad = 2.0,
          .eye_m = {eye_x, 0.0, 0.0},
          .effort = effort};
}

/// Returns the centre of the work, as a column.
double middle_of_work(const WorkGrid& work) {
  double sum = 0.0;
  double moment = 0.0;
  for (int y = 0; y < work.rows(); ++y) {
    for (int x = 0; x < work.columns(); ++x) {
      sum += work.at(x, y);
      moment += work.at(x, y) * (x + 0.5);
    }
  }
  return moment / sum;
}

Density relic_at(double px) {
  return [px](double x, double) { return 1e-6 + 1e-3 * std::exp(-0.001 * (x - px) * (x - px)); };
}

TEST(CostMap, assumes_equal_costs_before_anything_is_measured) {
  const WorkGrid work = CostMap().predict(view({40, 20}));
  EXPECT_FLOAT_EQ(work.at(0, 0), 256e-6f);
  EXPECT_FLOAT_EQ(work.at(2, 1), 32e-6f);  // 8 x 4 pixels.
}

TEST(CostMap, predicts_what_was_measured) {
  CostMap map(kSharp);
  const auto density = [](double x, double y) { return 1e-6 * (1.0 + x + y); };
  learn(&map, measured(kSize, density));
  const WorkGrid work = map.predict(view());
  EXPECT_NEAR(work.at(3, 5), 256e-6 * (1.0 + 56.0 + 88.0), 1e-9);
}

TEST(CostMap, shifts_with_the_turn_of_an_eye_that_stands_still) {
  CostMap map(kSharp);
  learn(&map, measured(kSize, relic_at(400.0)));
  const double before = middle_of_work(map.predict(view()));
  // The picture spans 2 rad in 40 cells: a turn of 0.3 rad to the right moves content 6 cells to the left.
  EXPECT_NEAR(middle_of_work(map.predict(view(kSize, 0.3))), before - 6.0, 0.1);
  EXPECT_NEAR(middle_of_work(map.predict(view(kSize, -0.3))), before + 6.0, 0.1);
}

TEST(CostMap, stays_in_a_picture_that_turning_does_not_shift) {
  CostMap map(kSharp);
  learn(&map, measured(kSize, relic_at(400.0)));
  SplitRequest flat = view();
  flat.azimuth_span_rad = 0.0;
  const double before = middle_of_work(map.predict(flat));
  flat.heading_rad = 0.3;
  EXPECT_NEAR(middle_of_work(map.predict(flat)), before, 0.1);
}

TEST(CostMap, stays_where_an_orbit_keeps_its_object) {
  CostMap map(kSharp);
  // The eye orbits and turns; the relic stays in the middle.
  for (int i = 0; i < 12; ++i) {
    (void)map.predict(view(kSize, 0.1 * i, 0.2 * i));
    learn(&map, measured(kSize, relic_at(320.0)), 0.1 * i, 0.2 * i);
  }
  EXPECT_NEAR(middle_of_work(map.predict(view(kSize, 1.2, 2.4))), 20.0, 0.2);
}

TEST(CostMap, can_be_used_for_a_picture_of_another_size) {
  CostMap map(kSharp);
  learn(&map, measured(kSize, relic_at(200.0)));
  const WorkGrid small = map.predict(view(kSize));
  const WorkGrid large = map.predict(view({1280, 640}));
  EXPECT_NEAR(large.total(), 4.0 * small.total(), 0.05 * large.total());
  EXPECT_NEAR(middle_of_work(large), 2.0 * middle_of_work(small), 0.2);
  EXPECT_NEAR(map.predict(view({333, 177})).total() / small.total(), 333.0 * 177.0 / (640.0 * 320.0), 0.05);
}

TEST(CostMap, scales_with_the_number_of_samples) {
  CostMap map(kSharp);
  learn(&map, measured(kSize, relic_at(200.0)), 0.0, 0.0, 4.0);
  const double four = map.predict(view(kSize, 0.0, 0.0, 4.0)).total();
  EXPECT_NEAR(map.predict(view(kSize, 0.0, 0.0, 1.0)).total(), 0.25 * four, 1e-6 * four);
}

TEST(CostMap, keeps_the_contrast_within_a_block_that_reports_only_its_total) {
  CostMap map(kSharp);
  learn(&map, measured(kSize, relic_at(200.0)));
  const WorkGrid before = map.predict(view());
  MeasuredBlock twice = measured(kSize, relic_at(200.0), false);
  twice.cpu_seconds *= 2.0;
  learn(&map, twice);
  const WorkGrid after = map.predict(view());
  for (std::size_t i = 0; i < after.cells().size(); ++i) {
    ASSERT_NEAR(after.cells()[i], 2.0f * before.cells()[i], 0.05f * before.cells()[i] + 1e-7f);
  }
}

TEST(CostMap, has_no_contrast_within_a_block_by_the_papers_rule) {
  CostMap map({.times = CellTimes::kUniform, .turns = false, .spreads = 0.0});
  learn(&map, measured(kSize, relic_at(200.0)));
  const WorkGrid work = map.predict(view(kSize, 0.5));
  EXPECT_FLOAT_EQ(work.at(0, 0), work.at(12, 10));
}

TEST(CostMap, keeps_the_costs_of_parts_that_were_not_measured) {
  CostMap map(kSharp);
  learn(&map, measured(kSize, relic_at(200.0)));
  const WorkGrid before = map.predict(view());
  const MeasuredBlock corner{{0, 0, 16, 16}, 0.5, {0.5f}};
  map.learn({kSize, {&corner, 1}});
  const WorkGrid after = map.predict(view());
  EXPECT_FLOAT_EQ(after.at(0, 0), 0.5f);
  EXPECT_FLOAT_EQ(after.at(12, 10), before.at(12, 10));
}

TEST(CostMap, has_no_cell_without_cost) {
  CostMap map(kSharp);
  learn(&map, measured(kSize, [](double x, double) { return x < 320.0 ? 0.0 : 1e-3; }));
  EXPECT_GT(map.predict(view()).at(0, 0), 0.0f);
}

TEST(CostMap, spreads_costs_when_the_view_has_moved_and_keeps_their_sum) {
  CostMap map({.spreads = 0.5});
  const MeasuredBlock block = measured(kSize, relic_at(320.0));
  learn(&map, block);
  const WorkGrid work = map.predict(view(kSize, 0.0, 0.5));
  EXPECT_LT(work.at(20, 10), map.predict(view()).at(20, 10));
  EXPECT_NEAR(work.total(), block.cpu_seconds, 0.02 * block.cpu_seconds);
}

TEST(CostMap, keeps_the_two_eyes_pictures_apart) {
  // The left eye's picture costs almost nothing, the right eye's, below it, a thousand times as much.
  const auto density = [](double, double y) { return y < 160.0 ? 1e-6 : 1e-3; };
  CostMap map;  // With spreading when the view moves.
  const MeasuredBlock block = measured(kSize, density);
  MeasuredFrame frame{kSize, {&block, 1}};
  frame.stacked = 2;
  map.learn(frame);
  for (const PictureSize& size : {kSize, PictureSize{640, 160}, PictureSize{480, 224}, PictureSize{960, 640}}) {
    SplitRequest request = view(size, 0.3, 0.1);
    request.stacked = 2;
    const WorkGrid work = map.predict(request);
    const int seam = work.rows() / 2;
    const auto per_px = [&](int y) { return work.at(7, y) / static_cast<float>(16 * work.height_px(y)); };
    for (int y = 0; y < work.rows(); ++y) {
      if (y < seam) {
        EXPECT_LT(per_px(y), 1e-5f) << size.height << ", row " << y << ": it is lifted to a hundredth of the mean";
      } else {
        EXPECT_NEAR(per_px(y), 1e-3f, 1e-6f) << size.height << ", row " << y;
      }
    }
  }
  CostMap of_one;
  learn(&of_one, block);
  EXPECT_GT(of_one.predict(view(kSize, 0.3, 0.1)).at(7, 9), 3e-5f * 256.0f) << "in one picture costs spread";
}

TEST(CostMap, initialises_the_second_eye_with_the_firsts_costs) {
  CostMap map(kSharp);
  learn(&map, measured({640, 160}, [](double, double y) { return 1e-6 * (1.0 + y); }));
  SplitRequest request = view(kSize);
  request.stacked = 2;
  const WorkGrid work = map.predict(request);
  for (int y = 0; y < 10; ++y) EXPECT_EQ(work.at(3, y), work.at(3, y + 10)) << y;
  request.stacked = 3;  // The cells cannot be divided in this way, so it counts as one picture.
  EXPECT_GT(map.predict(request).at(3, 19), map.predict(request).at(3, 10));
}

}  // namespace
}  // namespace cyclorama::balance
