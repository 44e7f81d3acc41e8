// SPDX-License-Identifier: Apache-2.0
#include "renderfarm/generator/interior.h"

#include <gtest/gtest.h>

#include "tests/doubles/recording_sink.h"

namespace cyclorama::generator {
namespace {

TEST(Interior, has_nearly_as_many_triangles_as_requested_and_never_more) {
  for (const std::uint64_t asked : {30'000u, 1'440'000u, 6'000'000u}) {
    const auto hall = plan_interior(asked, 1, 4);
    ASSERT_TRUE(hall.has_value()) << hall.error().message();
    EXPECT_LE(hall->counts().triangles, asked);
    EXPECT_GE(hall->counts().triangles, asked / 100 * 98);
  }
}

TEST(Interior, is_finite_and_inside_its_walls) {
  const auto hall = plan_interior(60'000, 3, 4);
  ASSERT_TRUE(hall.has_value());
  RecordingSink sink;
  ASSERT_TRUE(generate(*hall, sink, 2, [](double) { return true; }).has_value());
  for (const auto& [name, file] : sink.files()) {
    EXPECT_TRUE(file.finished) << name;
    EXPECT_EQ(file.bad_numbers, 0u) << name;
    EXPECT_EQ(file.bad_indices, 0u) << name;
    EXPECT_EQ(file.arrived.triangles, file.promised.triangles) << name;
    EXPECT_GT(file.low[1], -0.5f) << name;
    EXPECT_LT(file.high[1], 6.5f) << name;
    EXPECT_LT(std::max(file.high[0], -file.low[0]), 7.5f) << name;
  }
}

TEST(Interior, has_the_same_total_light_for_any_number_of_lamps) {
  const auto light = [](int lamps) {
    const auto hall = plan_interior(1'000'000, 1, lamps);
    EXPECT_TRUE(hall.has_value());
    Vec3 sum = Vec3::Zero();
    if (!hall) return sum;
    EXPECT_EQ(hall->lamps.size(), static_cast<std::size_t>(lamps));
    for (const Lamp& lamp : hall->lamps) sum += lamp.side_m * lamp.side_m * lamp.luminance;
    return sum;
  };
  const Vec3 four = light(4);
  for (const int lamps : {1, 2, 7, 300, kMaxInteriorLamps}) EXPECT_TRUE(light(lamps).isApprox(four, 1e-3f)) << lamps;
}

TEST(Interior, its_four_lamps_are_one_and_a_half_metres_wide_and_do_not_touch) {
  const auto hall = plan_interior(60'000, 1, 4);
  ASSERT_TRUE(hall.has_value());
  for (const Lamp& lamp : hall->lamps) {
    EXPECT_FLOAT_EQ(lamp.side_m, 1.5f);
    for (const Lamp& other : hall->lamps) {
      if (&lamp == &other) continue;
      EXPECT_GT((lamp.position - other.position).cwiseAbs().maxCoeff(), 1.5f);
    }
  }
}

TEST(Interior, refuses_impossible_requests) {
  EXPECT_EQ(plan_interior(1'000, 1, 4).error().code(), ErrorCode::kInvalidArgument);
  EXPECT_EQ(plan_interior(60'000, 1, 0).error().code(), ErrorCode::kInvalidArgument);
  EXPECT_EQ(plan_interior(60'000, 1, kMaxInteriorLamps + 1).error().code(), ErrorCode::kInvalidArgument);
  // The ten thousand trays alone have more triangles.
  EXPECT_EQ(plan_interior(60'000, 1, kMaxInteriorLamps).error().code(), ErrorCode::kInvalidArgument);
}

}  // namespace
}  // namespace cyclorama::generator
